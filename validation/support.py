"""What the checks of this folder share: running a deck, comparing a figure with its band, drawing."""
import argparse
import csv
import datetime
import json
import os
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "scripts" / "python"))

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402

import bands  # noqa: E402
from pictures import save_small  # noqa: E402
from results import Results  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

GRAVITY = 9.81  # m/s², as in the decks


class Check:
    """One case: its options, its runs, its figures. Use: check = Check(__doc__, __file__) … check.finish().

    Every figure is judged by the band of its key in validation/bands.json; a figure without a band, or a band that no figure met, is an error.
    finish() leaves out/validation/CASE/figures.json, from which the page docs/validation.md is made.
    """

    def __init__(self, description, file):
        parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
        parser.add_argument("--quick", action="store_true", help="a coarse form that takes seconds, with bands of its own")
        parser.add_argument("--reuse", action="store_true", help="take runs that are there and complete instead of running them again")
        options = parser.parse_args()
        self.quick, self.reuse = options.quick, options.reuse
        self.form = "quick" if self.quick else "full"
        self.folder = pathlib.Path(file).resolve().parent
        self.name = self.folder.name
        self.out = ROOT / "out" / "validation" / (self.name + ("_quick" if self.quick else ""))
        self.out.mkdir(parents=True, exist_ok=True)
        self.report = self.out / "figures.json"
        self.report.unlink(missing_ok=True)
        self.program = pathlib.Path(os.environ.get("JAXMPM", ROOT / "build" / "jaxmpm"))
        # Threads that wait for one another spin: on a machine that does other things too, a small scene is faster by far with one.
        self.environment = {**os.environ, **({"OMP_NUM_THREADS": "1"} if self.quick else {})}
        self.bands = bands.cases().get(self.name, {})
        self.figures, self.runs, self.failures = [], {}, 0
        print(f"{self.name}{' (quick)' if self.quick else ''}")

    def command(self, deck, name, assignments=None, *more):
        """The command line that runs a deck of the case's folder, or else of inputs/, into out/validation/CASE/NAME."""
        place = self.folder / deck if (self.folder / deck).is_file() else ROOT / "inputs" / deck
        return command_line(self.program, place, self.out / name, assignments, *more)

    def run(self, deck, name, assignments=None, *more):
        """Runs a deck into out/validation/CASE/NAME and reads the results."""
        target = self.out / name
        if not (self.reuse and complete(target)):
            shutil.rmtree(target, ignore_errors=True)
            command = self.command(deck, name, assignments, *more)
            done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, env=self.environment)
            if done.returncode:
                sys.exit(f"  {name}: exit {done.returncode}\n{done.stdout}")
        results = Results(target)
        summary = results.run()
        kept = {key: summary[key] for key in ("particles", "steps", "seconds", "threads", "backend", "git_commit")}
        self.runs[name] = {**kept, "cell_size": results.deck["domain"]["cell_size"]}
        print(f"  {name}: {summary['particles']} particles, {summary['steps']} steps, {summary['seconds']:.1f} s, {summary['particle_steps_per_second']:.3g} particle-steps/s")
        return results

    def figure(self, key, value, label="", found=None, reference=None):
        """Judges a figure by its band. `label` tells several figures of one band apart; `found` and `reference` are what the figure compares, as
        numbers in its own unit or as texts, for the page."""
        if key not in self.bands:
            sys.exit(f"  {self.name}: the figure '{key}' has no band in validation/{bands.FILE.name}")
        band = self.bands[key]
        value = value if isinstance(value, bool) else float(value)
        good = band.holds(value, self.form)
        verdict = "      " if band.limit(self.form) is None else "ok    " if good else "FAILED"
        said = ("yes" if value else "no") if isinstance(value, bool) else f"{value:.4g} {band.unit}".rstrip()
        beside = "" if reference is None else f"; {_text(found)} against {_text(reference)}"
        print(f"  {verdict} {', '.join(filter(None, (band.what, label)))}: {said} ({band.text(self.form)}{beside})")
        self.failures += not good
        self.figures.append({"band": key, "label": label, "value": value, "found": _text(found), "reference": _text(reference)})

    def holds(self, key, good, label=""):
        """A figure that is true or false."""
        self.figure(key, bool(good), label)

    def note(self, text):
        print(f"         {text}")

    def save(self, figure, name="comparison.png"):
        """Leaves a picture of less than 60 kB; the page shows the one called comparison.png."""
        path = self.out / name
        save_small(figure, path)
        print(f"         picture: {path}")

    def finish(self):
        met = {figure["band"] for figure in self.figures}
        for key, band in self.bands.items():
            if key not in met and band.limit(self.form) is not None:
                print(f"  FAILED the band '{key}' of validation/{bands.FILE.name} has met no figure")
                self.failures += 1
        report = {"case": self.name, "form": self.form, "date": datetime.date.today().isoformat(), "runs": self.runs, "figures": self.figures}
        self.report.write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        sys.exit(1 if self.failures else 0)


def _text(value):
    return value if value is None or isinstance(value, str) else f"{value:.4g}"


def command_line(program, deck, target, assignments=None, *more):
    """The words that run a deck into a folder, with its values at some pointers changed."""
    words = [str(program), "run", str(deck), "-o", str(target), "-q", *more]
    for pointer, value in (assignments or {}).items():
        words += ["--set", f"{pointer}={value}"]
    return words


def complete(target):
    """Whether a run is there and was not stopped on its way."""
    summary = target / "run.json"
    return summary.is_file() and json.loads(summary.read_text(encoding="utf-8"))["outcome"] == "done"


def reference(name):
    """Columns of a file of validation/data by their header, as arrays; text columns stay lists."""
    with open(ROOT / "validation" / "data" / name, encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    columns = {}
    for key in rows[0]:
        texts = [row[key] for row in rows]
        try:
            columns[key] = np.array([float(t) if t else np.nan for t in texts])
        except ValueError:
            columns[key] = texts
    return columns


def law_value(laws, law, quantity, aspect):
    """Value of a law of granular_collapse_scaling_laws.csv at an aspect ratio; NaN outside its range."""
    for i, name in enumerate(laws["law"]):
        low, high = np.nan_to_num(laws["a_min"][i]), laws["a_max"][i]
        if name == law and laws["quantity"][i] == quantity and np.isfinite(laws["coef"][i]) and low <= aspect and not aspect > high:
            return laws["coef"][i] * aspect ** laws["exponent"][i]
    return np.nan


def depth_profile(frame, deck, axis=0, width=None):
    """Depth of the material, m, at the middle of columns `width` wide (a cell unless given): volume in the column over its footprint, each
    particle spread linearly over the two nearest columns. 2D. Volumes are those at the start, so that the profile holds all the mass."""
    low, high = deck["domain"]["min"][axis], deck["domain"]["max"][axis]
    width = width or deck["domain"]["cell_size"]
    count = int(round((high - low) / width))
    spacing2 = deck["domain"]["cell_size"] ** 2 / (deck["bodies"][0].get("particles_per_cell") or 4)
    at = (frame.field("position")[:, axis] - low) / width - 0.5
    left = np.floor(at).astype(int)
    depth = np.zeros(count)
    for column, share in ((left, 1 - (at - left)), (left + 1, at - left)):
        np.add.at(depth, np.clip(column, 0, count - 1), share * spacing2 / width)
    return low + (np.arange(count) + 0.5) * width, depth


def front(frame):
    """Where 99.5 % of the mass lies behind, along x, m: single grains that run ahead do not move it."""
    return np.quantile(frame.field("position")[:, 0], 0.995)


def distance_to_line(points, line):
    """Distance of each point to a polyline, m."""
    a, b = line[:-1], line[1:]
    along = b - a
    share = np.einsum("pij,ij->pi", points[:, None, :] - a, along) / np.maximum(np.einsum("ij,ij->i", along, along), 1e-300)
    nearest = a + np.clip(share, 0, 1)[..., None] * along
    return np.linalg.norm(points[:, None, :] - nearest, axis=2).min(axis=1)


def first_crossing(x, y, level):
    """x at which y first reaches `level` from below, interpolated; NaN where it never does."""
    above = np.flatnonzero(np.asarray(y) >= level)
    if len(above) == 0:
        return np.nan
    i = above[0]
    if i == 0:
        return x[0]
    return x[i - 1] + (level - y[i - 1]) / (y[i] - y[i - 1]) * (x[i] - x[i - 1])
