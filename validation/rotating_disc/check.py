"""A freely rotating elastic disc: angular momentum and energy over three turns, by transfer, and whether it turns as fast as it should and stays round."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

RADIUS, RATE = 0.5, 2 * np.pi  # m, 1/s
BEGUN = 5                      # value of the energy gauge (0.05 s) at which the affine fields, which start at zero, have filled


def angular_momentum(results, affine):
    """By frame, over that of the start: Σ m (x v_y − y v_x), and what the particles' affine fields carry, Σ m D (C_yx − C_xy) with D = Δh²/4
    (Jiang et al. 2015, J. Comput. Phys. 293, section 5). Particles have equal masses."""
    rows = []
    for frame in results.frames:
        x, v = frame.field("position"), frame.field("velocity")
        spin = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]).sum()
        if affine and frame.step > 0:
            gradient = frame.field("velocity_gradient")
            spin += results.deck["domain"]["cell_size"] ** 2 / 4 * (gradient[:, 1, 0] - gradient[:, 0, 1]).sum()
        rows.append(spin)
    return np.array([frame.time for frame in results.frames]), np.array(rows) / rows[0]


def turned(results):
    """Mean angle through which the particles beyond half the radius have turned by each frame, radians."""
    start = results.frames[0].field("position")
    outer = np.linalg.norm(start, axis=1) > 0.5 * RADIUS
    angles = np.array([np.arctan2(*frame.field("position")[outer].T[::-1]) for frame in results.frames])
    return np.unwrap(angles, axis=0).mean(axis=1) - angles[0].mean()


def kept_energy(results):
    names, energy = results.gauge_components("energy"), results.gauge("energy")[1]
    mechanical = energy[:, names.index("kinetic")] + energy[:, names.index("strain")]
    return mechanical / mechanical[0]


def out_of_round(results):
    """Radii of the rim's particles at the end over those at the start: (largest − smallest)/2."""
    start, end = (np.linalg.norm(results.frames[i].field("position"), axis=1) for i in (0, -1))
    rim = start > 0.9 * RADIUS
    return np.ptp(end[rim] / start[rim]) / 2


def main():
    check = Check(__doc__, __file__)
    schemes = {"apic": {"/method/transfer": "apic"}, "tpic": {"/method/transfer": "tpic"}}
    schemes |= {f"flip {fraction:g}": {"/method/transfer": "flip", "/method/flip_fraction": fraction} for fraction in (1.0, 0.99)} | {"pic": {"/method/transfer": "pic"}}
    runs = [(scheme, 0.05) for scheme in schemes] + ([] if check.quick else [("apic", 0.025)])
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for scheme, cell in runs:
        settings = {**schemes[scheme], "/domain/cell_size": cell, **({"/time/end": 1.0} if check.quick else {})}
        results = check.run("disc.json", f"{scheme.replace(' ', '_')}_{cell}", settings)
        label = f"{scheme}, cell {1000 * cell:g} mm"
        time, spin = angular_momentum(results, scheme in ("apic", "tpic"))
        energy, rate = kept_energy(results), turned(results)[-1] / time[-1]
        if scheme in ("apic", "tpic"):
            check.figure("spin", abs(spin[-1] - 1), label)
            check.figure("energy", energy[-1] / energy[BEGUN], label)
            check.figure("start", energy[BEGUN], label, energy[BEGUN], "1")
            check.figure("rate", 100 * abs(rate / RATE - 1), label, f"{rate:.4f} 1/s", f"{RATE:.4f} 1/s")
            check.figure("round", 100 * out_of_round(results), label)
        else:
            check.figure("spin_other", spin[-1], label, spin[-1], "1")
            check.figure("energy_other", energy[-1], label, energy[-1], "1")
        axes[0].plot(time, spin, lw=1.2, label=label), axes[1].plot(results.gauge("energy")[0], energy, lw=1.2)
    axes[0].set(xlabel="time  s", ylabel="angular momentum / that at the start"), axes[1].set(xlabel="time  s", ylabel="kinetic and strain energy / that at the start")
    axes[0].legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
