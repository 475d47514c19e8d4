"""A scene that does not vary along an axis, in 3D and in 2D."""
from study import GRAVITY, Study, body, box, deck, np, plt, sand, water

HIGH = 20
SCENES = {
    "water": (water(10 * np.sqrt(2 * GRAVITY * 0.2), tension_limit=0), "hydrostatic", {"y_min": {"kind": "slip"}}),
    "sand": (sand(10 * np.sqrt(2 * GRAVITY * 0.2)), {"k0": 0.5}, {"y_min": {"kind": "no_slip"}}),
}
CELL, WIDE = 0.01, 4  # m, cells along the third axis


def column(material, dim):
    law, stress, walls = SCENES[material]
    side, across = HIGH * CELL, [WIDE * CELL] * (dim - 2)
    block = body("m", box([0] * dim, [side / 2, side, *across]), initial_stress=stress)
    gauges = {"front": {"kind": "front", "body": "body", "axis": "x"}}
    return deck([5 * side, 1.5 * side, *across], CELL, {"m": law}, [block], 2 * np.sqrt(side / GRAVITY), gravity=[0, -GRAVITY, 0][:dim], walls=walls, gauges=gauges, samples=40)


def main():
    study = Study(__file__, "Two dimensions instead of three", "a scene that is the same all along an axis, between slip walls, needs only two: the third multiplies particles and changes nothing.")
    figure, ax = plt.subplots(figsize=(5, 3.2), layout="constrained")
    rows = []
    for k, material in enumerate(SCENES):
        runs = {dim: study.run(column(material, dim)) for dim in (2, 3)}
        fronts = {dim: run.results.gauge("front") for dim, run in runs.items()}
        work = {dim: run.summary["particles"] * run.summary["steps"] for dim, run in runs.items()}
        apart = np.abs(np.interp(fronts[2][0], *fronts[3]) - fronts[2][1]).max() / CELL
        seconds = {dim: run.summary["seconds"] for dim, run in runs.items()}
        rows.append([material, apart, work[3] / work[2], seconds[3] / seconds[2]])
        for dim, style in ((2, "-"), (3, "--")):
            ax.plot(*fronts[dim], style, color=f"C{k}", lw=1, label=f"{material}, {dim}D")
    study.table(f"Column {HIGH} cells high, {WIDE} cells along the third axis", ["material", "fronts apart at most, cells", "particle-steps, 3D / 2D", "seconds, 3D / 2D"], rows)
    study.data = {row[0]: {"front_apart_cells": row[1], "work": row[2], "seconds": row[3]} for row in rows}
    ax.set(xlabel="time  s", ylabel="front  m"), ax.legend(fontsize=8)
    study.draw(figure)
    study.finish(
        f"fronts at most {max(row[1] for row in rows):.2g} cells apart; 3D costs {rows[0][3]:.0f} times the seconds with {WIDE} cells across", "advised",
        f"The fronts of water and sand lie at most {max(row[1] for row in rows):.2g} cells apart. With {WIDE} cells across 3D takes {rows[0][2]:.0f} times the particle-steps and {rows[0][3]:.0f} (water) and {rows[1][3]:.0f} times (sand) the seconds.",
    )  # fmt: skip
