"""Decay of one cell of the Taylor–Green vortices: rate of decay and velocity field against the closed form, by transfer and arrangement of particles."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

DENSITY, VISCOSITY, K = 1000.0, 20.0, np.pi  # kg/m³, Pa s, wave number π/L; U = L = 1
RATE = 2 * VISCOSITY / DENSITY * K**2        # of the velocity, 1/s


def kinetic(results):
    time, energy = results.gauge("energy")
    return time, energy[:, results.gauge_components("energy").index("kinetic")]


def decay(results):
    """Rate of decay of the velocity, from the kinetic energy once the sound of the start has gone twice through the box."""
    time, energy = kinetic(results)
    late = time >= 0.1
    return -0.5 * np.polyfit(time[late], np.log(energy[late]), 1)[0]


def velocity_error(frame):
    """‖v − v_exact‖ / ‖v_exact‖ over the particles."""
    x, y = frame.field("position").T
    exact = np.exp(-RATE * frame.time) * np.c_[np.sin(K * x) * np.cos(K * y), -np.cos(K * x) * np.sin(K * y)]
    return np.linalg.norm(frame.field("velocity") - exact) / np.linalg.norm(exact)


def main():
    check = Check(__doc__, __file__)
    cell = 0.04 if check.quick else 0.02
    variants = {
        "apic": {}, "tpic": {"/method/transfer": "tpic"},
        "apic, 16 particles a cell": {"/bodies/0/particles_per_cell": 16},
        "flip 0.99": {"/method/transfer": "flip"},
        "apic, tension limit 0": {"/materials/oil/tension_limit": 0},
    }
    runs = [(name, cell) for name in variants] + ([] if check.quick else [("apic", 0.04), ("apic", 0.01)])
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained", width_ratios=(1.2, 1))
    for name, size in runs:
        results = check.run("vortex.json", f"{name.replace(' ', '_').replace(',', '')}_{size}", {**variants[name], "/domain/cell_size": size})
        rate, label = decay(results), f"{name}, cell {1000 * size:g} mm"
        other = name in ("flip 0.99", "apic, tension limit 0")
        if size <= cell:
            check.figure("rate_other" if other else "rate", 100 * abs(rate / RATE - 1), label, f"{rate:.4f} 1/s", f"{RATE:.4f} 1/s")
            check.figure("velocity_other" if other else "velocity", 100 * velocity_error(results.frames[-1]), label)
        else:
            check.note(f"{label}: rate {100 * abs(rate / RATE - 1):.2f} %, velocity {100 * velocity_error(results.frames[-1]):.2f} % off")
        time, energy = kinetic(results)
        if size == cell:
            axes[0].semilogy(time, energy, lw=1.2, label=label)
        if name == "apic" and size == cell:
            position, pressure = results.frames[-1].field("position"), results.frames[-1].field("pressure")
            drawn = axes[1].scatter(*position.T, c=pressure, s=1.5, cmap="coolwarm", vmin=-400, vmax=400, rasterized=True)
            figure.colorbar(drawn, label=f"pressure at {results.frames[-1].time:.1f} s  Pa"), axes[1].set(aspect="equal", xlabel="x  m", ylabel="y  m", title=label)
    axes[0].semilogy(time, energy[0] * np.exp(-2 * RATE * time), "k--", lw=1, label="closed form")
    axes[0].set(xlabel="time  s", ylabel="kinetic energy  J"), axes[0].legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
