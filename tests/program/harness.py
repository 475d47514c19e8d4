"""What the tests of the whole program share: running it, small decks, comparing results."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "python"))

from coarse_decks import INPUTS, coarse_decks  # noqa: E402, F401

PROGRAM = os.environ.get("JAXMPM", str(ROOT / "build" / "jaxmpm"))

DONE, BAD_VERDICT, DECK, NUMERICS, IO, STOPPED = 0, 1, 2, 3, 4, 75


def small_deck(**changes):
    """A 2D dam break of a few hundred particles with an obstacle, gauges of every cheap kind and an automatic step; top-level keys can be replaced."""
    deck = {
        "jaxmpm": 1,
        "title": "small dam break",
        "domain": {"min": [0, 0], "max": [1.0, 0.5], "cell_size": 0.025},
        "gravity": [0, -9.81],
        "time": {"end": 0.1},
        "method": {"transfer": "apic"},
        "materials": {"water": {"model": "newtonian", "density": 1000, "sound_speed": 20, "tension_limit": 0}},
        "bodies": [{"name": "water", "material": "water", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.3]}}}],
        "obstacles": [{"name": "tower", "shape": {"box": {"min": [0.6, 0], "max": [0.7, 0.2]}}, "kind": "slip"}],
        "gauges": {
            "front": {"kind": "front", "body": "water", "axis": "x"},
            "level": {"kind": "height", "at": [0.1]},
            "load": {"kind": "force", "obstacle": "tower"},
            "energy": {"kind": "energy"},
            "some": {"kind": "particles", "ids": [5, 2], "fields": ["position", "velocity"]},
        },
        "output": {"interval": 0.02, "gauge_interval": 0.004},
    }
    deck.update(changes)
    return deck


class ProgramTest(unittest.TestCase):
    """A scratch directory as the working directory, and the program to call in it."""

    def setUp(self):
        self.scratch = pathlib.Path(tempfile.mkdtemp(prefix="jaxmpm-"))
        self.addCleanup(shutil.rmtree, self.scratch, ignore_errors=True)

    def write(self, deck, name="deck.json"):
        path = self.scratch / name
        path.write_text(deck if isinstance(deck, str) else json.dumps(deck))
        return path

    def start(self, *arguments, **more):
        return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.scratch, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def call(self, *arguments, timeout=300, **more):
        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.scratch, capture_output=True, text=True, timeout=timeout, check=False, **more)

    def expect(self, code, *arguments, **more):
        """Calls the program and demands an exit code; returns what it said."""
        done = self.call(*arguments, **more)
        self.assertEqual(done.returncode, code, f"{arguments}: {done.stdout[-2000:]}{done.stderr[-2000:]}")
        return done.stdout + done.stderr

    def run_deck(self, deck, out, *arguments, code=DONE):
        return self.expect(code, "run", deck, "-o", out, "--threads", "1", *arguments)

    def assertSameResults(self, a, b):
        """Every dataset of two results directories is equal, bit for bit."""
        left, right = datasets(self.scratch / a), datasets(self.scratch / b)
        self.assertEqual(sorted(left), sorted(right))
        for name, values in left.items():
            self.assertTrue(np.array_equal(values, right[name]), f"{name} differs between {a} and {b}")

    def assertNoHalfFiles(self, directory):
        """Every HDF5 file under a final name can be read whole."""
        for path in (self.scratch / directory).rglob("*.h5"):
            with h5py.File(path, "r") as file:
                file.visititems(lambda _, item: item[()] if isinstance(item, h5py.Dataset) else None)


def datasets(directory):
    """Name → values of all datasets and attributes of the frames and gauges of a results directory, through results.h5."""
    found = {}
    with h5py.File(directory / "results.h5", "r") as index:
        for number in index["frames"]:
            frame = index["frames"][number]
            found[f"{number}@time"], found[f"{number}@step"] = frame.attrs["time"], frame.attrs["step"]
            frame.visititems(lambda name, item, n=number: found.__setitem__(f"{n}/{name}", item[()]) if isinstance(item, h5py.Dataset) else None)
        index["gauges"].visititems(lambda name, item: found.__setitem__(f"gauges/{name}", item[()]) if isinstance(item, h5py.Dataset) else None)
    return found


def stop(process, number=signal.SIGTERM, timeout=120):
    process.send_signal(number)
    out, err = process.communicate(timeout=timeout)
    return process.returncode, out + err
