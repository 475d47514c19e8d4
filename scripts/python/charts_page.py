"""Writes docs/charts.md from the data kept in docs/charts/."""
import charts_data
from bench_page import table
from charts_scene import ROOT, scenes

PAGE = ROOT / "docs" / "charts.md"

HEAD = """# Speed and accuracy

Made by `scripts/charts` from the data kept in [charts/](charts/); not to be edited by hand. What does each choice of scheme, basis, precision, cell size and number
of particles cost, and what does it buy?

- **Variants**: transfer (pic, flip, apic, tpic) × basis (linear, quadratic, cubic) × precision (f32, f64) with the spline gradient, and flip, apic and tpic × quadratic and cubic × precision with moving least squares (`mls`), over cell
  sizes and particles per cell, all with the automatic step (`cfl` 0.4, with linear splines 0.25). Where pressures are measured, flip, apic and tpic also with `volume_averaging`, the cure of their noise and of locking. The finest cells are spent on the more promising ones.
- **Time** is processor time of the steps (`cpu_seconds` of `run.json`), with one thread. It leaves out what other programs took of the
  processor, but not that they slow its memory and its neighbouring core down: up to a third more or less between two points means little. Short runs are timed up to three times, the smallest counts. Particle-steps are exact.
- **Pictures**: colour is the transfer, marker the basis, dashes the precision, a white marker the gradient `mls`, one with a black edge `method/volume_averaging`. A curve goes over cell sizes with 4 particles a cell; small hollow marks have 1, 9 or 16. Rings mark the Pareto front: what no
  other point beats in time and error (errors closer than 1 % count as the same). The star is the configuration of Du & He 2025: their cell size, step and scheme where they computed the scene, run by this program on the same machine.
- **The paper's configuration is dominated** where a point of ours has no larger error in less than a third of its time. For the manufactured solution, particle-steps stand for time here and in the Pareto front.
- **Reference runs** are of this program, APIC with quadratic splines in finer cells and with the automatic step: points that resemble them share some of their error and look better by it.

    scripts/charts                 # all scenes: runs what is not there yet in out/charts/, then makes data, pictures and this page
    scripts/charts --again ritter  # runs it all anew
    scripts/charts --quick         # a grid of seconds, in out/charts_quick/, without this page

A scene is a file of some forty lines in `scripts/python/chart_scenes/`.

"""


def configuration(point):
    step = "" if point["step"] == "auto" else f", step {point['step']:g} s"
    gradient = "" if point["gradient"] == "spline" else f", {point['gradient']}"
    averaging = f", averaging {point['averaging']:g}" if point["averaging"] else ""
    return f"{point['transfer']}, {point['basis']}, {point['precision']}{gradient}{averaging}, cell {1000 * point['cell']:.4g} mm, {point['per_cell']} a cell{step}"


def error_text(value, measure):
    return f"{value:.3g} {measure.unit}"


def front_table(scene, kept):
    first = next(iter(scene.measures))
    rows = []
    for p in kept.front(first):
        errors = (error_text(p["errors"][key], measure) for key, measure in scene.measures.items())
        rows.append((configuration(p), *errors, f"{p['cpu_seconds']:.3g}", f"{p['particle_steps']:.3g}"))
    return table(("Pareto front", *(m.label for m in scene.measures.values()), "seconds", "particle-steps"), rows)


def rival_table(scene, kept):
    rows = []
    for key, measure in scene.measures.items():
        paper, rival = kept.paper, kept.rival(key)
        row = (measure.label, error_text(paper["errors"][key], measure), f"{paper['cpu_seconds']:.3g}")
        if rival is None:
            rows.append((*row, "none", "", "", "", "", "**no**"))
            continue
        shares = (rival[cost] / paper[cost] for cost in ("cpu_seconds", "particle_steps"))
        rows.append((*row, configuration(rival), error_text(rival["errors"][key], measure), f"{rival['cpu_seconds']:.3g}", *(f"1/{1 / share:.3g}" for share in shares), "yes" if kept.dominates(key) else "**no**"))
    return table(("error", "paper's", "seconds", "cheapest of ours with no larger error", "its error", "its seconds", "of the paper's time", "of its particle-steps", "dominated"), rows)


def choice_table(scene, kept):
    rows = [(f"averaging {value:g}" if key == "averaging" else value, count, f"{time:.2f}", *(f"{error:.2f}" for error in errors)) for key, value, count, time, errors in kept.choices(scene.measures)]
    return table(("instead of apic, quadratic, f64", "pairs", "time ×", *(f"{m.label} ×" for m in scene.measures.values())), rows)


def failures(kept):
    """A table of the runs that failed: those that differ in transfer, precision or averaging alone share a row, with what the first of them said."""
    if not kept.failed:
        return []
    alike = {}
    for f in kept.failed:
        alike.setdefault((f["basis"], f["gradient"], f["cell"], f["per_cell"]), []).append(f)
    rows = []
    for (basis, gradient, cell, per_cell), runs in alike.items():
        each = (", ".join(dict.fromkeys(str(f[key]) for f in runs)) for key in ("transfer", "precision", "averaging"))
        form = "" if gradient == "spline" else f", {gradient}"
        rows.append((basis + form, f"{1000 * cell:.4g} mm", per_cell, *each, len(runs), runs[0]["failed"].removeprefix("jaxmpm: ")))
    return ["Runs that failed:", "", *table(("basis", "cell", "a cell", "transfer", "precision", "averaging", "runs", "the first of them"), rows)]


def commits(kept):
    return ", ".join(sorted({p["git_commit"][:7] for p in (*kept.points, kept.paper)}))


def section(name, scene, kept):
    lines = [f"## {scene.title}", "", scene.says, ""]
    if kept is None:
        return lines + ["Not run yet.", ""]
    lines += [f"**Advice.** {scene.advice(kept)}", "", f"![{scene.title}: error over time and over particle-steps](charts/{name}.png)", "", *front_table(scene, kept)]
    lines += [f"Paper's configuration: {configuration(kept.paper)}. {scene.paper_says}", "", *rival_table(scene, kept)]
    lines += ["Single choices, medians over pairs of points that differ in nothing else:", "", *choice_table(scene, kept), *failures(kept)]
    reference = f" Reference run: {configuration(kept.reference)}, {kept.reference['cpu_seconds']:.0f} s." if kept.reference else ""
    return lines + [f"*{len(kept.points)} points, {sum(p['cpu_seconds'] for p in kept.points):.0f} s in all; {kept.machine}, {kept.date}, commit {commits(kept)}.{reference}*", ""]


def page():
    """The text of docs/charts.md."""
    sections = [section(name, scene, charts_data.read(name)) for name, scene in scenes().items()]
    return HEAD + "\n".join(line for part in sections for line in part).rstrip() + "\n"


def write():
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")
