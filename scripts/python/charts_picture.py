"""Draws a scene's chart: each error over processor seconds and over particle-steps, one curve per scheme, basis and precision over cell sizes."""
from charts_scene import BASES, PRECISIONS, TRANSFERS
from pictures import save_small
from support import plt

COLOURS = dict(zip(TRANSFERS, ("#999999", "#d55e00", "#0072b2", "#009e73")))
MARKERS = dict(zip(BASES, "^os"))
DASHES = dict(zip(PRECISIONS, ((0, (4, 2)), "-")))
FACES = {"spline": {}, "mls": {"mfc": "w", "ms": 5.5, "mew": 1.2}}
AVERAGED = {"mec": "k", "ms": 5.5, "mew": 1.0}
COSTS = {"cpu_seconds": "processor seconds, one thread", "particle_steps": "particle-steps"}
COST_NAMES = {"cpu_seconds": "seconds", "particle_steps": "particle-steps"}
PICTURE_BYTES = 150_000


def draw(scene, kept, path):
    figure, axes = plt.subplots(len(scene.measures), 2, figsize=(12, 4.6 * len(scene.measures)), squeeze=False, sharex="col", sharey="row", layout="constrained")
    for row, (key, measure) in zip(axes, scene.measures.items()):
        for at, cost in zip(row, COSTS):
            panel(at, kept, key, cost)
        row[0].set_ylabel(f"{measure.label}  {measure.unit}")
    for at, label in zip(axes[-1], COSTS.values()):
        at.set_xlabel(label)
    figure.legend(handles=legend(kept), loc="outside lower center", ncols=7, fontsize=8)
    save_small(figure, path, PICTURE_BYTES)


def panel(at, kept, measure, cost):
    for curve in sorted({curve_of(point) for point in kept.points}):
        own = [p for p in kept.points if curve_of(p) == curve]
        line = sorted((p for p in own if p["per_cell"] == 4), key=lambda p: -p["cell"])
        style = {"color": COLOURS[curve[0]], "marker": MARKERS[curve[1]], "ms": 4, "lw": 0.9, **FACES[curve[3]], **(AVERAGED if curve[4] else {})}
        at.plot([p[cost] for p in line], [p["errors"][measure] for p in line], ls=DASHES[curve[2]], **style)
        others = [p for p in own if p["per_cell"] != 4]
        at.plot([p[cost] for p in others], [p["errors"][measure] for p in others], **{**style, "ls": "", "mfc": "none", "ms": 3, "mew": 0.6})
    front = kept.front(measure)
    at.plot([p[cost] for p in front], [p["errors"][measure] for p in front], "ko", ms=8, mfc="none", mew=1.2)
    at.plot(kept.paper[cost], kept.paper["errors"][measure], "*", color="gold", mec="k", ms=15)
    at.set(xscale="log", yscale="log"), at.grid(alpha=0.3, which="both")


def curve_of(point):
    return tuple(point[key] for key in ("transfer", "basis", "precision", "gradient", "averaging"))


def legend(kept):
    def entry(label, **style):
        return plt.Line2D([], [], **{"color": "k", "ls": "", "ms": 5, **style, "label": label})
    return [*(entry(name, color=colour, ls="-", lw=2) for name, colour in COLOURS.items()),
            *(entry(name, marker=marker) for name, marker in MARKERS.items()),
            *(entry(name, ls=dash) for name, dash in DASHES.items()),
            entry("gradient mls", marker="o", **FACES["mls"]), entry("volume averaging", marker="o", **AVERAGED), entry("4 particles a cell", marker="o", ms=4), entry("1, 9 or 16 a cell", marker="o", ms=3, mfc="none"),
            entry(f"Pareto front (by {COST_NAMES[kept.cost]})", marker="o", ms=8, mfc="none"), entry("Du & He 2025", marker="*", color="gold", mec="k", ms=12)]
