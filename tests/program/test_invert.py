"""jaxmpm invert and jaxmpm gradient: twin experiments, stopping and going on, refusals."""
import json
import os
import random
import re
import resource
import signal
import time
import unittest

import h5py
import numpy as np

from harness import DECK, DONE, INPUTS, IO, ProgramTest, STOPPED, coarse_decks, small_deck, stop

TRUTH = {"u0": 0.8, "friction": 0.3}


def scene(u0, friction, **changes):
    """A small dam break over a rough floor, of 144 particles and 250 steps, with a velocity that grows with the height."""
    return small_deck(**{
        "title": "twin",
        "domain": {"min": [0, 0], "max": [1.0, 0.5], "cell_size": 0.05},
        "time": {"end": 0.1, "step": 4e-4},
        "parameters": {"u0": u0},
        "materials": {"water": {"model": "newtonian", "density": 1000, "sound_speed": 20, "viscosity": 1.0}},
        "bodies": [{"name": "water", "material": "water", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.3]}}, "velocity": ["u0*y/0.3", 0]}],
        "walls": {"y_min": {"kind": "friction", "coefficient": friction}},
        "obstacles": [],
        "gauges": {"front": {"kind": "front", "body": "water", "axis": "x", "quantile": 0.9}},
        "output": {"interval": 0.004, "formats": ["hdf5"]},
        **changes,
    })


UNKNOWNS = [{"path": "/parameters/u0", "bounds": [-2, 2]}, {"path": "/walls/y_min/coefficient", "bounds": [0, 1]}]


def inverse(unknowns=None, observations=None, **optimizer):
    return {
        "unknowns": unknowns or UNKNOWNS,
        "observations": observations or [{"kind": "particles", "body": "water", "field": "position", "file": "truth/results.h5", "from_time": 0.01}],
        "optimizer": optimizer or {"method": "lbfgs", "iterations": 30},
    }


class InverseTest(ProgramTest):
    """The truth is there; decks that look for it, and what they found."""

    def setUp(self):
        super().setUp()
        self.run_deck(self.write(scene(**TRUTH), "truth.json"), "truth")

    def deck(self, name="invert.json", u0=0.1, friction=0.05, **more):
        changes = {key: more.pop(key) for key in ("time", "bodies", "parameters") if key in more}
        return self.write(scene(u0, friction, inverse=inverse(**more), **changes), name)

    def invert(self, deck, out, *arguments, code=DONE, **more):
        return self.expect(code, "invert", deck, "-o", out, "--threads", "1", *arguments, **more)

    def result(self, out):
        return json.loads((self.scratch / out / "inversion.json").read_text())

    def positions(self, run, frame):
        with h5py.File(self.scratch / run / "frames" / f"{frame:06d}.h5") as file:
            return file["water/position"][...]

    def findings(self, out):
        """What an inversion found, without what it took."""
        found = self.result(out)
        found.pop("gradient_peak_bytes")
        for one in found["iterations"]:
            one.pop("forward_seconds"), one.pop("gradient_seconds")
        return found

    def assertFound(self, out, tolerance):
        unknowns = self.result(out)["unknowns"]
        self.assertLess(abs(unknowns["/parameters/u0"]["value"] - TRUTH["u0"]), tolerance)
        self.assertLess(abs(unknowns["/walls/y_min/coefficient"]["value"] - TRUTH["friction"]), tolerance)


class Invert(InverseTest):
    def test_every_optimiser_finds_the_truth(self):
        for method, tolerance in (({"method": "lbfgs", "iterations": 40}, 1e-4), ({"method": "gauss_newton", "iterations": 12}, 1e-5),
                                  ({"method": "adam", "iterations": 120, "decay": 0.96}, 0.02)):
            out = method["method"]
            said = self.invert(self.deck(**method), out)
            self.assertFound(out, tolerance)
            self.assertIn("loss", said)
            found = self.result(out)
            self.assertIn(found["stopped"], ("converged", "iterations", "stalled"))
            self.assertAlmostEqual(found["iterations"][0]["unknowns"]["/parameters/u0"], 0.1)
            self.assertLess(found["loss"], 1e-4 * found["iterations"][0]["loss"])
            with h5py.File(self.scratch / out / "inversion.h5") as file:
                velocity = file["bodies/water/velocity"][...]
                y = file["bodies/water/position"][...][:, 1]
                self.assertLess(np.abs(velocity[:, 0] - TRUTH["u0"] * y / 0.3).max(), max(10 * tolerance, 1e-3))
                self.assertEqual(len(file["history/loss"]), len(found["iterations"]))

    def test_automatic_steps(self):
        self.run_deck(self.write(scene(**TRUTH, time={"end": 0.1}), "truth_auto.json"), "truth_auto")
        observations = [{"kind": "particles", "body": "water", "field": "position", "file": "truth_auto/results.h5", "from_time": 0.01}]
        for method in ({"method": "lbfgs", "iterations": 60}, {"method": "adam", "iterations": 100, "decay": 0.96}):
            out = "auto_" + method["method"]
            self.invert(self.deck(time={"end": 0.1}, observations=observations, **method), out)
            self.assertFound(out, 0.05)

    def test_standard_errors_cover_the_truth_of_noisy_data(self):
        observations = [{"kind": "particles", "body": "water", "field": "position", "file": "truth/results.h5", "from_time": 0.01,
                         "noise": {"deviation": 2e-3, "seed": 4}}]
        self.invert(self.deck(observations=observations, method="gauss_newton"), "noisy")
        for pointer, truth in (("/parameters/u0", TRUTH["u0"]), ("/walls/y_min/coefficient", TRUTH["friction"])):
            found = self.result("noisy")["unknowns"][pointer]
            self.assertGreater(found["standard_error"], 1e-6)
            self.assertLess(abs(found["value"] - truth), 3 * found["standard_error"])

    def test_data_of_another_model_are_told_from_noise(self):
        """Truth with another transfer: no values of the unknowns follow it, and standard errors do not cover that."""
        observation = {"kind": "particles", "body": "water", "field": "position", "file": "truth/results.h5", "from_time": 0.01}
        noisy = self.invert(self.deck(observations=[{**observation, "noise": {"deviation": 0.001, "seed": 3}}]), "noisy")
        self.assertNotIn("is no noise", noisy)
        self.assertIs(self.result("noisy")["observations"][0]["noise"], True)
        self.run_deck(self.write(scene(**TRUTH, method={"transfer": "flip", "flip_fraction": 0.9}), "other.json"), "other")
        other = self.invert(self.deck(observations=[{**observation, "file": "other/results.h5"}]), "found")
        self.assertIn("is no noise", other)
        left = self.result("found")["observations"][0]
        self.assertIs(left["noise"], False)
        self.assertGreater(left["correlation"], 0.5)

    def test_data_after_the_end_are_left_out_and_told(self):
        deck = self.deck(time={"end": 0.05, "step": 4e-4})
        self.assertRegex(self.invert(deck, "short"), r"/inverse/observations/0: \d+ of \d+ rows of '.*truth/results.h5' are of times after the run's end at 0.05 s")

    def test_a_network_of_the_velocity(self):
        bodies = [{"name": "water", "material": "water", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.3]}},
                 "velocity": [{"mlp": {"inputs": ["y"], "hidden": [6, 6], "activation": "tanh", "input_scale": [4]}}, 0]}]
        self.invert(self.deck(unknowns=[{"path": "/bodies/0/velocity/0/mlp"}], bodies=bodies, parameters={}, friction=TRUTH["friction"], method="lbfgs", iterations=80), "net")
        with h5py.File(self.scratch / "net" / "inversion.h5") as file:
            velocity, y = file["bodies/water/velocity"][...][:, 0], file["bodies/water/position"][...][:, 1]
        truth = TRUTH["u0"] * y / 0.3
        self.assertLess(np.linalg.norm(velocity - truth) / np.linalg.norm(truth), 0.1)
        found = self.result("net")
        self.assertEqual(len(found["unknowns"]["/bodies/0/velocity/0/mlp"]["value"]), 61)
        # The result goes into a run by --set.
        weights = json.dumps(found["unknowns"]["/bodies/0/velocity/0/mlp"]["value"])
        self.run_deck(self.scratch / "invert.json", "again", "--set", f"/bodies/0/velocity/0/mlp/weights={weights}")

    def test_velocities_of_particles(self):
        at_rest = "id,vx,vy\n" + "".join(f"{k},0,0\n" for k in range(144))
        (self.scratch / "rest.csv").write_text(at_rest, encoding="utf-8")
        bodies = [{"name": "water", "material": "water", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.3]}}, "velocity": {"particles": {"file": "rest.csv"}}}]
        unknowns = [{"path": "/bodies/0/velocity/particles", "prior": {"deviation": 1}}]
        observations = [{"kind": "particles", "body": "water", "field": "position", "file": "truth/results.h5", "to_time": 0.02, "weight": 1e8}]
        self.invert(self.deck(unknowns=unknowns, observations=observations, bodies=bodies, parameters={}, friction=TRUTH["friction"], method="lbfgs", iterations=80), "each")
        with h5py.File(self.scratch / "each" / "inversion.h5") as file:
            velocity = file["bodies/water/velocity"][...]
        self.assertEqual(self.result("each")["unknowns"]["/bodies/0/velocity/particles"]["value"], {"file": "velocity_water.csv"})
        # What was found is a file that the deck reads, to the bit.
        table = np.loadtxt(self.scratch / "each" / "velocity_water.csv", delimiter=",", skiprows=2)
        self.assertTrue(np.array_equal(table[:, 1:], velocity))
        self.run_deck(self.scratch / "invert.json", "again", "--set", "/bodies/0/velocity/particles/file=each/velocity_water.csv")
        # Four particles of a cell are more than its nodes can tell apart, so velocities come out right as the grid sees them: the paths are.
        start, found, truth = (self.positions(run, frame) for run, frame in (("truth", 0), ("again", 5), ("truth", 5)))
        self.assertLess(np.linalg.norm(found - truth) / np.linalg.norm(truth - start), 0.02)

    def test_the_deposit_that_the_truth_leaves_can_be_observed(self):
        forms = coarse_decks()
        self.run_deck(INPUTS / "truth_granular_deposit.json", "deposit", *forms["truth_granular_deposit.json"])
        data = json.dumps(str(self.scratch / "deposit" / "results.h5"))
        done = self.call("gradient", INPUTS / "invert_granular_deposit.json", "--json", "--threads", "1", *forms["invert_granular_deposit.json"],
                         "--set", f"/inverse/observations/0/file={data}")
        self.assertEqual(done.returncode, DONE, done.stderr)
        self.assertGreater(json.loads(done.stdout)["loss"], 0)

    def test_signals_and_wall_time(self):
        deck = self.deck(method="adam", iterations=20)
        begun = time.monotonic()
        self.invert(deck, "whole")
        seconds = time.monotonic() - begun
        for number in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            out = f"out{number}"
            process = self.start("invert", deck, "-o", out, "--threads", "1")
            end = time.monotonic() + 60
            while not (self.scratch / out / "inversion.json").exists() and process.poll() is None and time.monotonic() < end:
                time.sleep(0.005)
            code, said = stop(process, number)
            self.assertEqual(code, STOPPED, said)
            self.assertIn("--resume auto", said)
            self.assertEqual(self.result(out)["stopped"], "stopped")
            self.assertIn("gone through again", self.invert(deck, out, "--resume", "auto"))
            self.assertEqual(self.findings(out), self.findings("whole"))
        self.invert(deck, "timed", "--max-walltime", f"{seconds / 60 / 4:.7f}", code=STOPPED)
        self.invert(deck, "timed", "--resume", "auto")
        self.assertEqual(self.findings("timed"), self.findings("whole"))

    def test_kill_at_any_moment(self):
        for method in ({"method": "lbfgs", "iterations": 25}, {"method": "gauss_newton", "iterations": 8}):
            deck = self.deck(**method)
            begun = time.monotonic()
            whole, out = "whole_" + method["method"], "out_" + method["method"]
            self.invert(deck, whole)
            seconds = time.monotonic() - begun
            rng, kills = random.Random(1), 0
            for _ in range(60):
                process = self.start("invert", deck, "-o", out, "--threads", "1", "--resume", "auto")
                try:
                    process.communicate(timeout=rng.uniform(0.1, 0.4) * seconds)
                except Exception:
                    process.kill()
                    process.communicate()
                    kills += 1
                if (self.scratch / out).exists():
                    self.assertNoHalfFiles(out)
                if process.returncode == DONE:
                    break
            self.invert(deck, out, "--resume", "auto")
            self.assertGreater(kills, 1)
            self.assertEqual(self.findings(out), self.findings(whole))

    def test_the_same_bits_with_any_number_of_threads_and_any_memory(self):
        deck = self.deck(time={"end": 0.1, "step": 2e-4})
        passive = {**os.environ, "OMP_WAIT_POLICY": "passive"}  # threads that wait by spinning take for ever where others want the cores
        found = [self.call("gradient", deck, "--json", "--threads", threads, "--set", f"/inverse/memory={memory}", env=passive)
                 for threads, memory in ((1, "4 GiB"), (2, "43 MiB"))]
        self.assertEqual([done.returncode for done in found], [DONE, DONE], found[1].stderr)
        self.assertIn("steps computed again", found[1].stderr)
        self.assertNotIn(" 0 steps computed again", found[1].stderr)
        self.assertEqual(found[0].stdout, found[1].stdout)

    def least_memory(self, deck):
        """What a gradient of the deck needs in any case, as the refusal of less says."""
        said = self.expect(DECK, "gradient", deck, "--threads", "1", "--set", "/inverse/memory=0.001 MiB")
        return int(re.search(r"give it (\d+) MiB", said).group(1))

    def test_snapshots_on_disk(self):
        deck = self.deck(time={"end": 0.1, "step": 2e-4})
        plenty = self.call("gradient", deck, "--json", "--threads", "1")
        little = f"/inverse/memory={self.least_memory(deck)} MiB"
        found = self.call("gradient", deck, "--json", "--threads", "1", "--set", little, "--set", "/inverse/disk=100 MiB")
        self.assertEqual(found.returncode, DONE, found.stderr)
        self.assertEqual(found.stdout, plenty.stdout)
        self.assertIn("of them on disk", found.stderr)
        self.assertIn("MiB written", found.stderr)
        again = [float(re.search(r"([\d.e+]+) steps computed again", said).group(1))
                 for said in (found.stderr, self.call("gradient", deck, "--json", "--threads", "1", "--set", little).stderr)]
        self.assertLess(again[0], again[1])

    def test_a_disk_that_is_full_loses_nothing(self):
        deck, full = self.deck(method="lbfgs", iterations=4), 1 << 20
        self.invert(deck, "whole")
        self.invert(self.deck("two.json", method="lbfgs", iterations=2), "out")
        disk = ("--resume", "auto", "--set", f"/inverse/memory={self.least_memory(deck) + 2} MiB", "--set", "/inverse/disk=100 MiB")
        said = self.invert(deck, "out", *disk, code=IO, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (full, full)))
        self.assertIn("/inverse/disk", said)
        self.invert(deck, "out", *disk)
        self.assertEqual(self.findings("out"), self.findings("whole"))
        self.assertEqual([path.name for path in (self.scratch / "out").glob("snapshots*")], [])

    def test_refusals(self):
        deck = self.deck(method="lbfgs", iterations=3)
        self.invert(deck, "out")
        self.assertIn("--resume auto", self.invert(deck, "out", code=IO))
        self.invert(deck, "out", "--overwrite")
        self.assertIn("/walls/y_min/coefficient", self.invert(self.deck(friction=0.2, method="lbfgs", iterations=3), "out", "--resume", "auto", code=DECK))
        said = self.invert(self.deck(method="lbfgs", iterations=30), "out", "--resume", "auto")  # more iterations of the same
        self.assertIn("gone through again", said)
        self.assertIn("/inverse", self.expect(DECK, "invert", self.write(small_deck(), "plain.json")))
        for unknown, words in (({"path": "/domain/cell_size"}, "cannot be an unknown"), ({"path": "/parameters/u0", "start": 3, "bounds": [0, 1]}, "outside of bounds")):
            self.assertIn(words, self.invert(self.deck(unknowns=[unknown]), "none", code=DECK))
        observation = {"kind": "particles", "body": "water", "field": "position", "file": "truth/results.h5", "select": {"ids": [9999]}}
        self.assertIn("9999", self.invert(self.deck(observations=[observation]), "none", code=DECK))
        late = {**observation, "select": "all", "from_time": 5}
        self.assertIn("from_time", self.invert(self.deck(observations=[late]), "none", code=DECK))
        self.assertIn("memory", self.invert(self.deck(), "none", "--set", "/inverse/memory=0.001 MiB", code=DECK))
        self.assertFalse((self.scratch / "none" / "inversion.json").exists())


class Gradient(InverseTest):
    def test_json(self):
        done = self.call("gradient", self.deck(), "--json", "--threads", "1")
        self.assertEqual(done.returncode, DONE, done.stderr)
        found = json.loads(done.stdout)
        self.assertEqual(sorted(found["gradient"]), ["/parameters/u0", "/walls/y_min/coefficient"])
        h = 1e-5
        losses = [json.loads(self.call("gradient", self.deck(), "--json", "--threads", "1", "--set", f"/parameters/u0={0.1 + s}").stdout)["loss"] for s in (-h, h)]
        self.assertAlmostEqual((losses[1] - losses[0]) / (2 * h) / found["gradient"]["/parameters/u0"], 1, delta=1e-5)
        self.assertIn("/walls/y_min/coefficient", self.expect(DONE, "gradient", self.deck(), "--threads", "1"))

    def test_check(self):
        done = self.call("gradient", self.deck(), "--check", "--json", "--threads", "1")
        self.assertEqual(done.returncode, DONE, done.stdout + done.stderr)
        check = json.loads(done.stdout)["check"]
        self.assertEqual(check["verdict"], "good")
        self.assertEqual(len(check["directions"]), 5)
        self.assertLess(check["unknowns"]["/parameters/u0"]["relative_error"], 1e-5)
        said = self.expect(DONE, "gradient", self.deck(), "--check", "--directions", "2", "--threads", "1")
        for words in ("Taylor", "slope", "dot prod", "particles at kinks", "VERDICT: good"):
            self.assertIn(words, said)

    def test_single_precision(self):
        exact, single = (json.loads(self.call("gradient", self.deck(), "--json", "--threads", "1", "--set", f'/method/precision="{name}"').stdout) for name in ("f64", "f32"))
        self.assertNotEqual(single["gradient"], exact["gradient"])
        for pointer, by in exact["gradient"].items():
            self.assertAlmostEqual(single["gradient"][pointer] / by, 1, delta=1e-3)
        said = self.expect(DONE, "gradient", self.deck(), "--check", "--directions", "2", "--threads", "1", "--set", '/method/precision="f32"')
        self.assertRegex(said, r"VERDICT: good.*\n.*Single precision: the gradient is off by .*: good")

    def test_velocity_of_a_wall(self):
        walls = {"y_min": {"kind": "no_slip", "velocity": [0.2, 0]}}
        deck = self.write(scene(0.1, 0, walls=walls, inverse=inverse([{"path": "/walls/y_min/velocity/0"}])))
        self.assertIn("VERDICT: good", self.expect(DONE, "gradient", deck, "--check", "--directions", "1", "--threads", "1"))
        across = self.write(scene(0.1, 0, walls=walls, inverse=inverse([{"path": "/walls/y_min/velocity/1"}])))
        self.assertIn("cannot be an unknown", self.expect(DECK, "gradient", across))

    def test_bench(self):
        done = self.call("bench", self.deck(), "--steps", "50", "--gradient", "--json", "--threads", "1")
        self.assertEqual(done.returncode, DONE, done.stderr)
        gradient = json.loads(done.stdout)["gradient"]
        self.assertAlmostEqual(gradient["seconds_per_1000_steps"], 20 * (gradient["forward_seconds"] + gradient["reverse_seconds"]))
        self.assertLessEqual(gradient["measured_peak_bytes"], 4 << 30)

    def test_memory_of_an_inversion_stays_below_the_budget(self):
        """Gradient after gradient, as much as the first or a little less than all states take, also where time steps vary."""
        domain = {"min": [0, 0], "max": [1.0, 0.5], "cell_size": 0.0125}
        self.run_deck(self.write(scene(**TRUTH, domain=domain), "fine.json"), "fine")
        seen = [{"kind": "particles", "body": "water", "field": "position", "file": "fine/results.h5", "from_time": 0.01}]
        for step in ({"step": 4e-4}, {"cfl": 0.2}):
            deck = self.write(scene(0.1, 0.05, domain=domain, time={"end": 0.1, **step}, inverse=inverse(observations=seen, method="adam", learning_rate=0.02, iterations=6)), "invert.json")
            self.invert(deck, "plenty", "--overwrite")
            most = self.result("plenty")["gradient_peak_bytes"]
            for budget in (most / 2**20 + 3, most / 2**20 - 4):
                said = self.invert(deck, "tight", "--overwrite", "--set", f"/inverse/memory={budget:.2f} MiB")
                predicted = float(re.search(r"predicted peak ([0-9.]+) MiB", said).group(1))
                found = self.result("tight")
                self.assertEqual(len(found["iterations"]), 6)
                self.assertLessEqual(found["gradient_peak_bytes"] / 2**20, budget, f"predicted {predicted}")

    def test_memory_stays_below_the_budget_with_snapshots_on_disk(self):
        deck, budget = self.write(scene(0.1, 0.05, domain={"min": [0, 0], "max": [1.0, 0.5], "cell_size": 0.01}, inverse=inverse())), 64 << 20
        done = self.call("bench", deck, "--steps", "200", "--gradient", "--json", "--threads", "1", "--set", "/inverse/memory=64 MiB", "--set", "/inverse/disk=1 GiB")
        self.assertEqual(done.returncode, DONE, done.stderr)
        gradient = json.loads(done.stdout)["gradient"]
        self.assertEqual((gradient["snapshots"], gradient["recomputed_steps"]), (200, 0))
        self.assertGreater(gradient["snapshots_on_disk"], 0)
        self.assertEqual(gradient["written_bytes"], gradient["disk_bytes"])  # each is written once
        self.assertLessEqual(gradient["read_bytes"], gradient["disk_bytes"])
        self.assertLessEqual(gradient["predicted_peak_bytes"], budget)
        self.assertLessEqual(gradient["measured_peak_bytes"], gradient["predicted_peak_bytes"])


if __name__ == "__main__":
    unittest.main()
