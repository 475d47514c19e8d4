"""Every deck of inputs in its coarse form on the CPU and on the GPU: the results differ by round-off and its growth. Where the program has no CUDA
backend, or the machine no GPU, the tests are skipped.

    JAXMPM=build-cuda/jaxmpm .venv/bin/python -m unittest discover -v tests/program -p test_gpu.py
"""
import functools
import json
import pathlib
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

from harness import DECK, DONE, INPUTS, PROGRAM, ProgramTest, coarse_decks, small_deck

# Largest difference at the end of a coarse run, over the largest value of the field. Measured: 5e-13 and 2e-5 at most.
ROUND_OFF = {"f64": 1e-10, "f32": 1e-3}


@functools.lru_cache
def gpu_found():
    """Whether the program runs a deck on a GPU here."""
    said = subprocess.run([PROGRAM, "info"], capture_output=True, text=True, check=True).stdout
    if "cuda" not in said:
        return False
    with tempfile.TemporaryDirectory() as scratch:
        deck = INPUTS / "dam_break_2d.json"
        done = subprocess.run([PROGRAM, "bench", deck, "--steps", "1", "--backend", "cuda", "--set", "/domain/cell_size=0.02"], cwd=scratch, capture_output=True, check=False)
        return done.returncode == DONE


def last_frame(directory):
    """Fields of all bodies in the last frame, what a difference of each is measured by, and the run's time, steps and precision."""
    with h5py.File(directory / "results.h5") as index:
        frame = index["frames"][sorted(index["frames"])[-1]]
        fields = {}
        frame.visititems(lambda name, item: fields.__setitem__(name, item[()]) if isinstance(item, h5py.Dataset) else None)
        deck = json.loads(index.attrs["deck_resolved"])
        scales = {name: max(np.abs(values).max(initial=0), least_scale(name, deck)) for name, values in fields.items()}
        return fields, scales, (float(frame.attrs["time"]), int(frame.attrs["step"]), index.attrs["precision"])


def least_scale(name, deck):
    """The smallest pressure that a fluid's density resolves: what is below comes from round-off alone, as in a cloud that drifts without load."""
    body, field = name.split("/")
    material = deck["materials"][next(b["material"] for b in deck["bodies"] if b["name"] == body)]
    stiff = field == "pressure" and material["model"] == "newtonian"
    return 1e-5 * material["density"] * material["sound_speed"] ** 2 if stiff else 1e-300


def differences(one, other):
    """Largest difference of each field over its scale."""
    (a, scales, _), (b, _, _) = one, other
    return {name: np.abs(a[name].astype(float) - b[name].astype(float)).max(initial=0) / scales[name] for name in a}


class Gpu(ProgramTest):
    def setUp(self):
        super().setUp()
        if not gpu_found():
            self.skipTest("no CUDA backend, or no GPU")

    def run_on(self, backend, deck, out, *more):
        self.expect(DONE, "run", deck, "-o", out, "--backend", backend, "--threads", "2", *more)
        return last_frame(self.scratch / out)

    def test_every_deck_gives_the_results_of_the_cpu(self):
        for name, coarse in coarse_decks().items():
            with self.subTest(deck=name):
                stem = pathlib.Path(name).stem
                cpu, gpu = (self.run_on(backend, INPUTS / name, f"{backend}_{stem}", *coarse, "--set", '/output/formats=["hdf5"]') for backend in ("cpu", "cuda"))
                (time, steps, precision), (gpu_time, gpu_steps, _) = cpu[2], gpu[2]
                self.assertEqual(sorted(cpu[0]), sorted(gpu[0]))
                worst = differences(cpu, gpu)
                print(f"{name}: {precision}, {steps} and {gpu_steps} steps; " + ", ".join(f"{field} {value:.1e}" for field, value in worst.items()), flush=True)
                self.assertAlmostEqual(time, gpu_time, delta=1e-12 * max(time, 1))
                self.assertLess(max(worst.values()), ROUND_OFF[precision])

    def gradient_on(self, backend, deck, *more):
        """Numbers of the gradient of a deck by pointer, and its loss."""
        said = self.expect(DONE, "gradient", deck, "--backend", backend, "--threads", "2", "--json", *more)
        found = json.loads(said[said.index("{"):said.rindex("}") + 1])
        return found["loss"], {pointer: np.atleast_1d(value) for pointer, value in found["gradient"].items()}

    def test_gradients_are_those_of_the_cpu(self):
        for name in ("velocity_linear", "friction", "granular_deposit", "dam_break_front"):
            with self.subTest(deck=name):
                short = ["--set", "/time/end=0.03"]
                coarse = coarse_decks()[f"truth_{name}.json"] + short
                self.expect(DONE, "run", INPUTS / f"truth_{name}.json", "-o", "truth", "--overwrite", "--backend", "cpu", *coarse, "--set", "/output/interval=0.01")
                observation = {"kind": "particles", "body": "column", "field": "position", "file": str(self.scratch / "truth" / "results.h5")}
                arguments = [INPUTS / f"invert_{name}.json", *coarse_decks()[f"invert_{name}.json"], *short, "--set", f"/inverse/observations={json.dumps([observation])}"]
                (loss, cpu), (gpu_loss, gpu) = (self.gradient_on(backend, *arguments) for backend in ("cpu", "cuda"))
                worst = max(np.abs(cpu[p] - gpu[p]).max() / np.abs(cpu[p]).max() for p in cpu if np.abs(cpu[p]).max() > 0)
                print(f"{name}: loss {abs(loss - gpu_loss) / loss:.1e}, gradient {worst:.1e}", flush=True)
                self.assertLess(max(worst, abs(loss - gpu_loss) / loss), 1e-6)

    def test_resume(self):
        deck = self.write(small_deck())
        self.run_on("cuda", deck, "resumed", "--set", "/time/end=0.05")
        self.assertIn("--backend cuda", self.expect(DECK, "run", deck, "-o", "resumed", "--backend", "cpu", "--set", "/time/end=0.1", "--resume", "auto"))
        resumed = self.run_on("cuda", deck, "resumed", "--set", "/time/end=0.1", "--resume", "auto")
        self.assertLess(max(differences(self.run_on("cpu", deck, "whole", "--set", "/time/end=0.1"), resumed).values()), ROUND_OFF["f64"])

    def test_output_does_not_change_the_flow(self):
        deck = self.write(small_deck())
        seldom, often = (self.run_on("cuda", deck, f"every_{interval}", "--set", f"/output/interval={interval}") for interval in ("0.1", "0.005"))
        self.assertLess(max(differences(seldom, often).values()), ROUND_OFF["f64"])


if __name__ == "__main__":
    unittest.main()
