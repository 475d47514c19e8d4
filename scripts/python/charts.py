"""Speed–accuracy charts: runs each scene's grid of variants, and makes data, pictures and docs/charts.md. Called by scripts/charts."""
import argparse
import dataclasses
import datetime
import pathlib
import shutil

import charts_data
import charts_page
import charts_picture
from bench_page import machine
from charts_runs import Runs, program
from charts_scene import ROOT, scenes


def measured(runs, variant, reference):
    """A point: the variant, its cost and its errors; or why it failed."""
    cost, results = runs.get(variant)
    point = {**dataclasses.asdict(variant), **cost}
    if results is None:
        return point
    errors = {key: float(measure.of(results, reference)) for key, measure in runs.scene.measures.items()}
    return {**point, "errors": errors}


def chart(name, scene, out, form):
    """Runs what is not there yet of a scene, and returns its data."""
    runs = Runs(program(), out / name, scene)
    cost, reference = runs.get(scene.reference) if scene.reference else (None, None)
    points = [measured(runs, variant, reference) for variant in scene.variants()]
    paper = measured(runs, scene.paper, reference)
    return charts_data.Kept(
        scene=name, form=form, date=datetime.date.today().isoformat(), machine=machine(),
        points=[p for p in points if "failed" not in p], paper=paper, failed=[p for p in points if "failed" in p],
        reference={**dataclasses.asdict(scene.reference), **cost} if scene.reference else None, cost=scene.cost)


def main():
    known = scenes()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a grid of seconds, in out/charts_quick/")
    parser.add_argument("--again", action="store_true", help="run also what is there")
    parser.add_argument("-o", "--out", type=pathlib.Path, help="where the runs are kept; out/charts or out/charts_quick otherwise")
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    options = parser.parse_intermixed_args()
    unknown = sorted(set(options.scenes) - set(known))
    if unknown:
        parser.error(f"no scene {', '.join(unknown)}; there are {' '.join(known)}")
    out = options.out or ROOT / "out" / ("charts_quick" if options.quick else "charts")
    folder = out if options.quick else charts_data.KEPT
    for name in options.scenes or known:
        print(name, flush=True)
        if options.again:
            shutil.rmtree(out / name, ignore_errors=True)
        scene = known[name].reduced() if options.quick else known[name]
        kept = chart(name, scene, out, "quick" if options.quick else "full")
        kept.write(folder)
        charts_picture.draw(scene, kept, folder / f"{name}.png")
    if not options.quick:
        charts_page.write()


if __name__ == "__main__":
    main()
