"""Two elastic discs that collide and part (Sulsky, Chen & Schreyer 1994): momentum, energy, and the speed with which they part."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

DIAGONAL = np.array([1, 1]) / np.sqrt(2)
SPEED, RADIUS, GAP = 0.1 * np.sqrt(2), 0.2, 0.6 * np.sqrt(2) - 0.4  # of each disc; between their rims at the start
TOUCH = GAP / (2 * SPEED)


def early(time, kinetic, cell):
    """Cells between the rims when the discs begin to slow down (1 % of their energy gone)."""
    return (TOUCH - time[np.flatnonzero(kinetic < 0.99 * kinetic[0])[0]]) * 2 * SPEED / cell


def main():
    check = Check(__doc__, __file__)
    cells = (0.05,) if check.quick else (0.1, 0.05, 0.025, 0.0125)
    runs = [("apic", cell) for cell in cells] + ([] if check.quick else [("tpic", 0.025), ("flip", 0.025)])
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for number, (transfer, cell) in enumerate(runs):
        results = check.run("discs.json", f"{transfer}_{cell}", {"/method/transfer": transfer, "/domain/cell_size": cell})
        label = f"{transfer}, cell {1000 * cell:g} mm"
        names, (time, energy) = results.gauge_components("energy"), results.gauge("energy")
        kinetic, strain = energy[:, names.index("kinetic")], energy[:, names.index("strain")]
        speeds = np.array([frame.field("velocity", "right").mean(axis=0) @ DIAGONAL for frame in results.frames])
        momentum = np.abs(results.gauge("momentum")[1]).max() / (1000 * np.pi * RADIUS**2 * SPEED)
        kept = (kinetic[-1] + strain[-1]) / kinetic[0]
        check.figure("momentum", momentum, label)
        check.figure("contact", early(time, kinetic, cell), label)
        check.note(f"{label}: kinetic energy at least {kinetic.min():.3f} J, {kinetic[-1]:.3f} J at the end of {kinetic[0]:.3f} J; they part at {speeds[-1] / SPEED:.3f} of their speed")
        if cell == (0.05 if check.quick else 0.0125):
            check.figure("energy", kept, label, kept, "1")
            check.figure("rebound", speeds[-1] / SPEED, label)
        colour = f"C{number}"
        axes[0].plot(time, kinetic, colour, lw=1.2, label=label), axes[0].plot(time, strain, colour, lw=1, ls=":")
        axes[1].plot([frame.time for frame in results.frames], speeds, colour, lw=1.2)
    for at in axes:
        at.axvline(TOUCH, color="0.6", lw=0.8, ls="--"), at.set_xlabel("time  s")
    axes[0].set_ylabel("kinetic (line) and strain (dots) energy  J"), axes[1].set_ylabel("speed of the right disc  m/s")
    axes[0].legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
