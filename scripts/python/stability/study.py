"""What the studies share: small decks, runs that may fail, and what is kept of a study."""
import datetime
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "scripts" / "python"))

import matplotlib  # noqa: E402
import numpy as np  # noqa: E402, F401
from pictures import save_small  # noqa: E402
from results import Results  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402, F401

KEPT = ROOT / "docs" / "stability"
GRAVITY = 9.81  # m/s²
DONE, DECK, NUMERICS = 0, 2, 3  # exit codes
BASES = ("linear", "quadratic", "cubic")
SCHEMES = {
    "pic": {"transfer": "pic"},
    "flip 1": {"transfer": "flip", "flip_fraction": 1},
    "flip 0.99": {"transfer": "flip", "flip_fraction": 0.99},
    "flip 0.9": {"transfer": "flip", "flip_fraction": 0.9},
    "apic": {"transfer": "apic"},
    "tpic": {"transfer": "tpic"},
}


def water(sound_speed, **more):
    return {"model": "newtonian", "density": 1000, "sound_speed": sound_speed, **more}


def solid(model, wave_speed, density=1000, poisson=0.3):
    """An elastic solid by the speed of its pressure waves, √((λ + 2G)/ρ)."""
    young = density * wave_speed**2 * (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)
    return {"model": model, "density": density, "youngs_modulus": young, "poisson_ratio": poisson}


def sand(wave_speed, friction_angle=30, density=1500, poisson=0.3, **more):
    return {**solid("drucker_prager", wave_speed, density, poisson), "friction_angle": friction_angle, **more}


def box(low, high):
    return {"box": {"min": list(low), "max": list(high)}}


def body(material, shape, name="body", **more):
    return {"name": name, "material": material, "shape": shape, **more}


def deck(size, cell, materials, bodies, end, *, gravity=None, time=None, method=None, gauges=("energy",), frames=1, samples=50, fields=None, **more):
    """A deck of a domain from the origin. `frames` and `samples`: how many of the frames and gauges' values after those of the start."""
    output = {"interval": end / frames, "formats": ["hdf5"], **({"fields": fields} if fields else {})}
    measures = gauges if isinstance(gauges, dict) else {kind: {"kind": kind} for kind in gauges}
    if measures:
        output["gauge_interval"] = end / samples
    return {
        "jaxmpm": 1, "domain": {"min": [0] * len(size), "max": list(size), "cell_size": cell}, "gravity": gravity or [0] * len(size),
        "time": {"end": end, **(time or {})}, "method": method or {}, "materials": materials, "bodies": bodies, "gauges": measures, "output": output, **more,
    }  # fmt: skip


class Run:
    """One run of the program: its exit code, what it said, and its results where it left some."""

    def __init__(self, code, said, results):
        self.code, self.said, self.results = code, said, results

    @property
    def done(self):
        return self.code == DONE

    @property
    def summary(self):
        return self.results.run()

    def energy(self):
        """Time, and by component the values of the energy gauge."""
        time, value = self.results.gauge("energy")
        return time, dict(zip(self.results.gauge_components("energy"), value.T))

    def last(self, name, of=None):
        return self.results.frames[-1].field(name, of)

    def first(self, name, of=None):
        return self.results.frames[0].field(name, of)


class Study:
    """One study: its runs, its tables, its picture, and what is said about it."""

    def __init__(self, module, title, expected):
        self.name = pathlib.Path(module).stem
        self.title, self.expected = title, expected
        self.program = os.environ.get("JAXMPM", str(ROOT / "build" / "jaxmpm"))
        self.scratch = pathlib.Path(tempfile.mkdtemp(prefix="jaxmpm-stability-"))
        self.tables, self.data, self.picture = [], {}, None
        self.runs, self.particle_steps, self.commits = 0, 0, set()

    def run(self, scene, may_fail=False):
        """Runs a deck, given as a dict, on one thread. A failure ends the study unless it `may_fail`."""
        place = self.scratch / "deck.json"
        place.write_text(json.dumps(scene), encoding="utf-8")
        out = self.scratch / str(self.runs)
        command = [self.program, "run", str(place), "-o", str(out), "-q", "--threads", "1"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if done.returncode and not may_fail:
            sys.exit(f"{self.name}: exit {done.returncode}\n{done.stdout}")
        self.runs += 1
        run = Run(done.returncode, done.stdout, Results(out) if (out / "results.h5").is_file() else None)
        if run.done:
            self.particle_steps += run.summary["particles"] * run.summary["steps"]
            self.commits.add(run.summary["git_commit"][:7])
        return run

    def table(self, caption, columns, rows):
        """A table of the page; cells are texts or numbers, shown with three digits."""
        self.tables.append({"caption": caption, "columns": columns, "rows": [[text(cell) for cell in row] for row in rows]})

    def draw(self, figure):
        KEPT.mkdir(parents=True, exist_ok=True)
        self.picture = f"{self.name}.png"
        save_small(figure, KEPT / self.picture)

    def finish(self, threshold, verdict, *said):
        """Keeps the study: the measured threshold in a few words, what the program does about it, and paragraphs for the page."""
        shutil.rmtree(self.scratch, ignore_errors=True)
        report = {
            "study": self.name, "title": self.title, "expected": self.expected, "threshold": threshold, "verdict": verdict, "said": list(said), "tables": self.tables,
            "picture": self.picture, "data": plain(self.data), "runs": self.runs, "particle_steps": self.particle_steps, "commits": sorted(self.commits),
            "date": datetime.date.today().isoformat(),
        }  # fmt: skip
        KEPT.mkdir(parents=True, exist_ok=True)
        (KEPT / f"{self.name}.json").write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def text(cell):
    """A cell of a table: numbers with three digits, whole ones as they are."""
    if isinstance(cell, str):
        return cell
    if isinstance(cell, (bool, np.bool_)):
        return "yes" if cell else "no"
    if isinstance(cell, (int, np.integer)):
        return f"{cell:,}"
    if not np.isfinite(cell):
        return "–"
    return f"{cell:.3g}" if not abs(cell) >= 1e3 or abs(cell) >= 1e5 else f"{cell:.0f}"


def plain(data):
    """Arrays and NumPy's numbers as what JSON knows, with five digits; what is not finite is null."""
    if isinstance(data, dict):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple, np.ndarray)):
        return [plain(value) for value in data]
    if isinstance(data, (float, np.floating)):
        return float(f"{data:.5g}") if np.isfinite(data) else None
    return data.item() if isinstance(data, np.generic) else data


def first_sentence(said):
    """The error line of what the program said, without the time and level of the log."""
    line = next((line for line in said.splitlines() if line.strip()), "")
    return re.sub(r"^\[[^\]]*\]\s*(\[[^\]]*\]\s*)*", "", line).strip()
