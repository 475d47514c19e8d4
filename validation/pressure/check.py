"""Noise of the pressure and locking, with and without method/volume_averaging: dam breaks in 2D and 3D, water at rest, and a cantilever at three Poisson's ratios."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from roughness import roughness  # noqa: E402
from support import Check, np, plt  # noqa: E402

PARTS = (0, 0.5, 0.9, 1)                                        # of method/volume_averaging
LENGTH, DEPTH, DENSITY, WEIGHT, E = 4.0, 1.0, 1050.0, 10.0, 4e7  # of the beam: m, m, kg/m³, m/s², Pa


def sag(nu):
    """Drop of the end of a cantilever in plane strain under its own weight, bending and shear (Timoshenko), m."""
    load, stiff, shear = DENSITY * WEIGHT, E / (1 - nu**2), E / (2 * (1 + nu))
    return load * (12 * LENGTH**4 / (8 * stiff * DEPTH**2) + 1.2 * LENGTH**2 / (2 * shear))


def tip(results):
    """Drop of the middle of the free end, m."""
    start, last = results.frames[0].field("position"), results.frames[-1].field("position")
    near = np.argsort(np.linalg.norm(start - np.array([LENGTH, DEPTH / 2]), axis=1))[:4]
    return -np.mean((last - start)[near, 1])


def dam_break(check, axes):
    for transfer in ("apic", "flip"):
        noise, seconds = {}, {}
        for part in PARTS:
            results = check.run("dam_break_2d.json", f"dam_{transfer}_{part}", {
                "/method/volume_averaging": part, "/method/transfer": transfer, "/domain/cell_size": 0.02 if check.quick else 0.01, "/time/step": "auto", "/time/end": 0.4,
                "/output/interval": 0.1, "/output/fields": '["velocity", "pressure", "density"]', "/gauges": "{}"})
            height = np.ptp(results.frames[0].field("position")[:, 1])
            noise[part] = roughness(results.frames[1:], results.deck, 1000 * 9.81 * height)
            seconds[part] = results.run()["seconds"]
            if transfer == "apic" and part in (0, 0.9):
                place, frame = axes[0 if part == 0 else 1], results.frames[2]
                drawn = place.scatter(*frame.field("position").T, c=frame.field("pressure") / (1000 * 9.81 * height), s=1, cmap="viridis", vmin=-0.1, vmax=1.0, rasterized=True)
                place.set(title=f"volume_averaging {part}", aspect="equal", xlabel="x  m")
                place.figure.colorbar(drawn, ax=place, label="pressure / ρgH", shrink=0.6)
        for part in PARTS[1:]:
            check.figure("noise", noise[part] / noise[0], f"{transfer}, {part}", f"{noise[part]:.3f} ρgH", f"{noise[0]:.3f} ρgH")
        check.note(f"{transfer}: seconds {', '.join(f'{seconds[part] / seconds[0]:.2f}' for part in PARTS)} of those without, for {', '.join(str(part) for part in PARTS)}")


def dam_break_3d(check):
    for transfer in ("apic", "flip"):
        noise, seconds = {}, {}
        for part in (0, 0.9):
            results = check.run("dam_break_3d.json", f"dam_3d_{transfer}_{part}", {
                "/method/volume_averaging": part, "/method/transfer": transfer, "/domain/cell_size": 0.02 if check.quick else 0.01, "/time/end": 0.2,
                "/output/interval": 0.05, "/gauges": "{}"})
            height = np.ptp(results.frames[0].field("position")[:, 2])
            noise[part] = roughness(results.frames[1:], results.deck, 1000 * 9.81 * height)
            seconds[part] = results.run()["seconds"]
        check.figure("noise", noise[0.9] / noise[0], f"3D, {transfer}, 0.9", f"{noise[0.9]:.3f} ρgH", f"{noise[0]:.3f} ρgH")
        check.note(f"3D, {transfer}: {seconds[0.9] / seconds[0]:.2f} of the seconds without")


def at_rest(check):
    for part in (0, 0.9, 1):
        results = check.run("hydrostatic.json", f"rest_{part}", {"/method/volume_averaging": part})
        first, last = results.frames[0].field("position"), results.frames[-1].field("position")
        check.figure("rest", np.max(np.linalg.norm(last - first, axis=1)) / results.deck["domain"]["cell_size"], str(part))


def cantilever(check, axis):
    cells = (0.25,) if check.quick else (0.25, 0.125)
    ratios = (0.3, 0.499) if check.quick else (0.3, 0.49, 0.499)
    for cell in cells:
        curves = {}
        for nu in ratios:
            found = {}
            for part in PARTS:
                results = check.run("beam.json", f"beam_{cell}_{nu}_{part}", {"/method/volume_averaging": part, "/materials/rubber/poisson_ratio": nu, "/domain/cell_size": cell})
                found[part] = tip(results) / sag(nu), roughness(results.frames[-1:], results.deck, DENSITY * WEIGHT * DEPTH)
                curves.setdefault(part, []).append(found[part][0])
            text = ", ".join(f"{part}: {sunk:.3f} ({rough:.2f})" for part, (sunk, rough) in found.items())
            check.note(f"ν = {nu}, cell {cell} m: drop over the closed form (roughness of the pressure over ρgh) for {text}")
            if nu == 0.499:
                check.figure("locking", found[1][0], f"1, cell {cell} m", f"{found[1][0]:.3f}", f"without {found[0][0]:.3f}")
                check.figure("checkerboard", found[1][1] / found[0][1], f"1, cell {cell} m")
            if nu == 0.3:
                check.figure("soft", found[0.9][0], f"0.9, cell {cell} m", f"{found[0.9][0]:.3f}", f"without {found[0][0]:.3f}")
        if cell == cells[-1]:
            for part, drops in curves.items():
                axis.plot(range(len(ratios)), drops, "o-", ms=3, lw=1, label=f"volume_averaging {part}")
            axis.set(xticks=range(len(ratios)), xticklabels=[f"ν = {nu}" for nu in ratios], ylabel="drop over the closed form", title=f"cantilever, cell {cell} m")
            axis.axhline(1, color="0.5", lw=0.8), axis.legend(fontsize=7)


def main():
    check = Check(__doc__, __file__)
    figure, axes = plt.subplots(1, 3, figsize=(13, 3.4), layout="constrained")
    dam_break(check, axes)
    dam_break_3d(check)
    at_rest(check)
    cantilever(check, axes[2])
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
