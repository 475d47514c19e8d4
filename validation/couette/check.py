"""Couette and Poiseuille flow between two plates, from rest: profiles of velocity and forces on the plates against the closed forms, by transfer and cell size."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

HEIGHT, LENGTH, VISCOSITY, DENSITY = 0.2, 0.16, 10.0, 1000.0  # m, m, Pa s, kg/m³
SPEED, DRIVE = 0.5, 1.0                                      # of the plate, m/s; of the force, m/s²
NU = VISCOSITY / DENSITY
PEAK = DRIVE * HEIGHT**2 / (8 * NU)                          # m/s
N = np.arange(1, 400)


def couette(y, t):
    """Velocity (m/s) at heights y after a plate has begun to move (Batchelor 1967, section 4.3)."""
    k = np.pi * N / HEIGHT
    return SPEED * y / HEIGHT + np.sum(2 * SPEED / (np.pi * N) * (-1.0) ** N * np.exp(-NU * k**2 * t) * np.sin(np.outer(y, k)), axis=1)


def poiseuille(y, t):
    """Velocity (m/s) at heights y after a uniform force has begun to act."""
    odd = N[N % 2 == 1]
    k = np.pi * odd / HEIGHT
    return DRIVE * y * (HEIGHT - y) / (2 * NU) - np.sum(4 * DRIVE * HEIGHT**2 / (NU * (np.pi * odd) ** 3) * np.exp(-NU * k**2 * t) * np.sin(np.outer(y, k)), axis=1)


FLOWS = {  # velocity, its largest value
    "couette": (couette, SPEED),
    "poiseuille": (poiseuille, PEAK),
}
TIMES = (0.2, 0.5, 2.0)  # s: the early boundary layer, half way, nearly steady (e^−4.9)


def profile_error(frame, velocity, scale):
    """Root mean square over the particles, over the largest velocity."""
    y, v = frame.field("position")[:, 1], frame.field("velocity")
    return 100 * np.sqrt(np.mean((v[:, 0] - velocity(y, frame.time)) ** 2 + v[:, 1] ** 2)) / scale


def forces(results):
    """Mean force along x on both plates over the last quarter, N per metre of thickness."""
    found = []
    for plate in ("lower", "upper"):
        time, force = results.gauge(plate)
        found.append(np.mean(force[time > 0.75 * time[-1], 0]))
    return np.array(found)


def late_forces(name):
    """The closed form's, over the same time: μ dv/dy at the plates."""
    velocity, dy = FLOWS[name][0], 1e-5
    t = np.linspace(1.5, 2.0, 101)
    ends = [np.mean([velocity(np.array([dy]), s)[0] - velocity(np.array([0.0]), s)[0] for s in t]) / dy,
            np.mean([velocity(np.array([HEIGHT]), s)[0] - velocity(np.array([HEIGHT - dy]), s)[0] for s in t]) / dy]
    return VISCOSITY * LENGTH * np.array([ends[0], -ends[1]])


def main():
    check = Check(__doc__, __file__)
    cell = 0.01 if check.quick else 0.005
    variants = {"apic": {}, "tpic": {"/method/transfer": "tpic"}, "flip 0.99": {"/method/transfer": "flip"}, "apic, cubic": {"/method/basis": "cubic"}}
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained", sharey=True)
    for name, axis in zip(FLOWS, axes):
        velocity, scale = FLOWS[name]
        runs = [(variant, cell) for variant in variants] + ([] if check.quick else [("apic", 0.02), ("apic", 0.01)])
        for variant, size in runs:
            label = f"{name}, {variant}, cell {1000 * size:g} mm"
            results = check.run(f"{name}.json", label.replace(", ", "_").replace(" ", "_"), {**variants[variant], "/domain/cell_size": size})
            errors = [profile_error(results.frame_at(t), velocity, scale) for t in TIMES]
            if size <= cell:
                other = "_flip" if "flip" in variant else ""
                check.figure("profile" + other, max(errors), label)
                exact, found = late_forces(name), forces(results)
                check.figure("force" + other, 100 * np.max(np.abs(found / exact - 1)), label, f"{found[0]:.3f}, {found[1]:.3f} N", f"{exact[0]:.3f}, {exact[1]:.3f} N")
            else:
                check.note(f"{label}: {max(errors):.2f} %")
            if variant == "apic" and size == cell:
                for t in TIMES:
                    frame = results.frame_at(t)
                    y = np.linspace(0, HEIGHT, 100)
                    axis.plot(frame.field("velocity")[:, 0], 100 * frame.field("position")[:, 1], ".", ms=2, label=f"{frame.time:.1f} s")
                    axis.plot(velocity(y, frame.time), 100 * y, "k-", lw=0.8)
                axis.set(title=f"{name}, cell {1000 * size:g} mm (lines: closed form)", xlabel="velocity  m/s"), axis.legend(fontsize=8)
    axes[0].set_ylabel("y  cm")
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
