"""jaxmpm run: results as documented, exit codes, refusals, and runs that do not depend on threads or output."""
import json
import subprocess
import unittest

import h5py
import numpy as np

from harness import DECK, DONE, IO, NUMERICS, PROGRAM, ProgramTest, datasets, small_deck
import results


class Results(ProgramTest):
    def test_layout(self):
        deck = self.write(small_deck())
        self.run_deck(deck, "out")
        out = self.scratch / "out"
        with h5py.File(out / "results.h5") as index:
            self.assertEqual(index.attrs["deck"], deck.read_text())
            self.assertEqual(json.loads(index.attrs["deck_resolved"])["time"]["end"], 0.1)
            self.assertEqual((index.attrs["format"], index.attrs["backend"], index.attrs["precision"]), (1, "cpu", "f64"))
            self.assertEqual(sorted(index["frames"]), [f"{n:06d}" for n in range(6)])
            water = index["frames/000003/water"]
            self.assertTrue(np.all(np.diff(water["id"][...].astype(int)) == 1))
            self.assertEqual(water["velocity"].shape, water["position"].shape)
            self.assertEqual(water["velocity"].attrs["units"], "m/s")
            self.assertIn("pressure", water)
            self.assertGreaterEqual(index["frames/000003"].attrs["time"], 0.06 * (1 - 1e-12))
            energy = index["gauges/energy"]
            self.assertEqual(list(energy["value"].attrs["components"]), ["kinetic", "potential", "strain", "plastic", "viscous", "friction", "numerical"])
            self.assertLess(abs(np.diff(energy["value"][...].sum(axis=1))).max(), 1e-9 * energy["value"][0].sum())
            self.assertEqual(index["gauges/some/position"].shape[1:], (2, 2))
            self.assertEqual(index["gauges/load/valid"][0], 0)
            self.assertAlmostEqual(float(index["gauges/level/value"][0]), 0.3, places=6)
        summary = json.loads((out / "run.json").read_text())
        self.assertEqual(summary["particles"], 576)
        self.assertEqual(summary["total_steps"], summary["steps"])
        self.assertGreater(summary["cpu_seconds"], 0)
        self.assertLess(summary["cpu_seconds"], 1.05 * summary["seconds"] + 0.02, "of one thread, output left out")
        self.assertEqual((out / "vtk" / "results.pvd").read_text().count("obstacles.vtp"), 6)

    def test_fixed_step_moves_times_to_the_nearest_step_and_says_so(self):
        deck = self.write(small_deck(time={"end": 0.0304, "step": 3e-4}, output={"interval": 0.01, "gauge_interval": 0.01}))
        said = self.run_deck(deck, "out")
        self.assertIn("/time/end", said)
        self.assertIn("/output/interval", said)
        with h5py.File(self.scratch / "out" / "results.h5") as index:
            steps = [int(frame.attrs["step"]) for frame in index["frames"].values()]
            times = [float(frame.attrs["time"]) for frame in index["frames"].values()]
        self.assertEqual(steps, [0, 33, 67, 100, 101])
        np.testing.assert_allclose(times, np.array(steps) * 3e-4, rtol=1e-15)

    def test_chosen_fields_and_formats(self):
        output = {"interval": 0.05, "formats": ["hdf5"], "fields": ["density", "stress", "velocity_gradient", "body", "plastic_strain"]}
        self.run_deck(self.write(small_deck(output=output, gauges={})), "out")
        self.assertFalse((self.scratch / "out" / "vtk").exists())
        with h5py.File(self.scratch / "out" / "frames" / "000001.h5") as frame:
            self.assertEqual(sorted(frame["water"]), ["body", "density", "id", "plastic_strain", "position", "stress", "velocity_gradient"])
            self.assertEqual(frame["water/stress"].shape, (576, 6))
            self.assertEqual(frame["water/velocity_gradient"].shape, (576, 2, 2))
            self.assertGreater(np.abs(frame["water/velocity_gradient"]).max(), 0)

    def test_one_thread_and_two_give_the_same_bits(self):
        deck = self.write(small_deck())
        self.run_deck(deck, "one")
        self.expect(DONE, "run", deck, "-o", "two", "--threads", "2")
        self.assertSameResults("one", "two")

    def test_material_at_rest_is_left_out_the_same_with_any_threads_and_after_a_stop(self):
        deck = self.write(small_deck(**{
            "domain": {"min": [0, 0], "max": [2.0, 0.4], "cell_size": 0.0125}, "time": {"end": 1.2},
            "materials": {"sand": {"model": "drucker_prager", "density": 2000, "bulk_modulus": 2e5, "poisson_ratio": 0.3, "friction_angle": 30}},
            "bodies": [{"name": "sand", "material": "sand", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.3]}}, "initial_stress": {"k0": 0.5}}],
            "walls": {"y_min": {"kind": "no_slip"}}, "obstacles": [], "gauges": {}, "output": {"interval": 0.2, "formats": ["hdf5"]},
        }))
        rest = ("--set", '/method/rest={"speed": 0.02, "time": 0.02}')
        self.run_deck(deck, "plain")
        for out, threads in (("one", "1"), ("two", "2")):
            self.expect(DONE, "run", deck, "-o", out, "--threads", threads, *rest)
        self.assertSameResults("one", "two")
        self.run_deck(deck, "resumed", *rest, "--set", "/time/end=0.6")
        self.run_deck(deck, "resumed", *rest, "--resume", "auto")
        self.assertSameResults("one", "resumed")
        summary = json.loads((self.scratch / "one" / "run.json").read_text())
        self.assertGreater(summary["particles_at_rest"], 0.5 * summary["particles"])
        end = {}
        for out in ("plain", "one"):
            with h5py.File(self.scratch / out / "frames" / "000006.h5") as file:
                end[out] = file["sand/position"][...]
        self.assertLess(np.sqrt(np.mean((end["plain"] - end["one"]) ** 2)), 0.2 * 0.0125)

    def test_output_changes_nothing(self):
        self.run_deck(self.write(small_deck()), "much", "--set", "/output/interval=0.001", "--set", "/output/checkpoint_interval_minutes=0.0001")
        bare = small_deck(gauges={}, output={"interval": 10, "formats": ["hdf5"]})
        self.run_deck(self.write(bare), "little")
        ends = []
        for out in ("much", "little"):
            found = datasets(self.scratch / out)
            last = max(name for name in found if name.endswith("@time")).removesuffix("@time")
            ends.append([found[last + "@step"], found[last + "/water/position"], found[last + "/water/velocity"]])
        for a, b in zip(*ends):
            self.assertTrue(np.array_equal(a, b))

    def test_what_passes_an_open_face_leaves_the_run(self):
        walls = {"x_max": {"kind": "open"}}
        gauges = {"level": {"kind": "height", "at": [0.1]}, "front": {"kind": "front", "body": "water", "axis": "x"}, "energy": {"kind": "energy"}}
        deck = self.write(small_deck(walls=walls, gauges=gauges, obstacles=[], time={"end": 1.0}))
        self.assertIn("have left through open faces", self.run_deck(deck, "one"))
        with h5py.File(self.scratch / "one" / "results.h5") as index:
            counts = [len(index[f"frames/{k:06d}/water/id"]) for k in range(len(index["frames"]))]
        self.assertEqual(counts, sorted(counts, reverse=True))
        summary = json.loads((self.scratch / "one" / "run.json").read_text())
        self.assertEqual((summary["particles_left"], summary["particles"]), (576 - counts[-1], counts[-1]))
        self.assertTrue(0 < counts[-1] < 500, counts)
        self.run_deck(deck, "resumed", "--set", "/time/end=0.8")
        self.run_deck(deck, "resumed", "--resume", "auto")
        self.assertSameResults("one", "resumed")
        self.run_deck(deck, "empty", "--set", '/walls/y_min={"kind": "open"}', "--set", "/time/end=0.6")  # all fall out
        with h5py.File(self.scratch / "empty" / "results.h5") as index:
            self.assertEqual(len(index["frames/000030/water/position"]), 0)

    def test_points_of_a_file_run_as_the_lattice_they_were_taken_from(self):
        self.run_deck(self.write(small_deck(), "lattice.json"), "lattice")
        with h5py.File(self.scratch / "lattice" / "results.h5") as index:
            places = index["frames/000000/water/position"][...]
        (self.scratch / "points.csv").write_text("x,y,volume\n" + "".join(f"{x:.17g},{y:.17g},{0.0125**2:.17g}\n" for x, y in places))
        points = [{"name": "water", "material": "water", "shape": {"points": {"file": "points.csv"}}}]
        deck = self.write(small_deck(bodies=points), "points.json")
        self.assertIn("576", self.expect(DONE, "check", deck))
        self.run_deck(deck, "points")
        self.assertSameResults("lattice", "points")


class ExitCodes(ProgramTest):
    def test_usage_is_2(self):
        deck = self.write(small_deck())
        for arguments in ([], ["walk"], ["run"], ["run", deck, "--threads", "0"], ["run", deck, "--no-such"], ["bench", deck], ["run", deck, "--overwrite", "--resume", "auto"],
                          ["run", deck, "--backend", "abacus"], ["run", deck, "--max-walltime", "-1"], ["check", deck, "-q", "-v"]):
            self.expect(DECK, *arguments)
        self.assertFalse((self.scratch / "out").exists())

    def test_deck_errors_are_2_all_at_once_and_touch_nothing(self):
        deck = small_deck(gravity=[0, "down"])
        deck["bodies"][0]["shapes"] = 1
        self.run_deck(self.write(small_deck()), "out")
        before = sorted(self.scratch.rglob("*"))
        said = self.run_deck(self.write(deck), "out", "--overwrite", code=DECK)
        self.assertIn("/gravity/1", said)
        self.assertIn("/bodies/0/shapes", said)
        self.assertEqual(before, sorted(self.scratch.rglob("*")))

    def test_missing_cuda_is_2_and_says_what_there_is(self):
        if "cuda" in self.expect(DONE, "info").split("backends")[1].splitlines()[0]:
            self.skipTest("this build has CUDA")
        self.assertIn("cpu", self.run_deck(self.write(small_deck()), "out", "--backend", "cuda", code=DECK))

    def test_unknown_particle_id_is_2(self):
        deck = small_deck(gauges={"p": {"kind": "particles", "ids": [10**6], "fields": ["velocity"]}})
        self.assertIn("/gauges/p/ids/0", self.run_deck(self.write(deck), "out", code=DECK))

    def test_a_run_that_fails_writes_no_frame_twice(self):
        self.run_deck(self.write(small_deck(time={"end": 1.0, "step": 0.02}, output={"interval": 0.02})), "out", code=NUMERICS)
        steps = [frame.step for frame in results.Results(self.scratch / "out").frames]
        self.assertEqual(steps, sorted(set(steps)))

    def test_a_body_force_that_is_no_number_is_named(self):
        deck = small_deck(body_force=[0, "log(0.05 - t)"])
        said = self.run_deck(self.write(deck), "out", code=NUMERICS)
        self.assertIn("/body_force is not a finite number at the node", said)

    def test_a_gap_below_material_that_presses_is_noted(self):
        deck = small_deck()
        deck["bodies"] = [{"name": "pool", "material": "water", "shape": {"box": {"min": [0, 0], "max": [0.3, 0.1]}}, "initial_stress": "hydrostatic"},
                          {"name": "drop", "material": "water", "shape": {"box": {"min": [0.1, 0.3], "max": [0.2, 0.4]}}}]
        deck["gauges"] = {}
        self.assertIn("counts a gap of 0.2 m", self.expect(DONE, "check", self.write(deck)))

    def test_a_deposit_that_still_moves_is_noted(self):
        sand = {"sand": {"model": "drucker_prager", "density": 1800, "youngs_modulus": 1e6, "poisson_ratio": 0.3, "friction_angle": 30, "cohesion": 0}}
        deck = small_deck(time={"end": 0.2}, materials=sand, gauges={}, obstacles=[], walls={"y_min": {"kind": "friction", "coefficient": 0.5}})
        deck["bodies"] = [{"name": "heap", "material": "sand", "shape": {"box": {"min": [0, 0], "max": [0.2, 0.3]}}}]
        said = self.run_deck(self.write(deck), "falls")
        self.assertRegex(said, r'\d+ % of the mass of body "heap" is still faster than')
        deck["bodies"][0]["shape"]["box"]["max"] = [1.0, 0.1]  # from wall to wall: has nowhere to go
        self.assertNotIn("still faster", self.run_deck(self.write(deck), "rests"))

    def test_unstable_run_is_3_and_leaves_no_nan(self):
        deck = self.write(small_deck(time={"end": 1.0, "step": 0.02}, output={"interval": 0.02}))
        said = self.run_deck(deck, "out", code=NUMERICS)
        for word in ("particle", "step", "dt", "/time/step", "last good state"):
            self.assertIn(word, said)
        self.assertNoHalfFiles("out")
        for name, values in datasets(self.scratch / "out").items():
            self.assertTrue(np.all(np.isfinite(values)), name)
        self.assertTrue((self.scratch / "out" / "checkpoint.h5").exists())

    def test_walls_that_let_go_hold_a_splash(self):
        """Water that runs along separate walls was found 1e-6 m outside after some thousand steps."""
        deck = small_deck(
            gravity=[0, -9.81],
            time={"end": 2},
            materials={"water": {"model": "newtonian", "density": 1000, "sound_speed": 30}},
            bodies=[{"name": "water", "material": "water", "particles_per_cell": 4, "shape": {"box": {"min": [0, 0], "max": [0.4, 0.4]}}}],
            walls={face: {"kind": "separate"} for face in ("x_min", "x_max", "y_min", "y_max")},
            obstacles=[],
            gauges={},
            output={"interval": 1},
        )
        for transfer, cell in (("apic", 0.025), ("tpic", 0.02)):
            deck["domain"] = {"min": [0, 0], "max": [1, 1], "cell_size": cell}
            deck["method"] = {"transfer": transfer}
            self.run_deck(self.write(deck), transfer)
            place = results.Results(self.scratch / transfer).frames[-1].field("position")
            self.assertGreaterEqual(place.min(), 0)
            self.assertEqual(len(place), 4 * round(0.4 / cell) ** 2)

    def test_a_failure_with_linear_splines_names_what_they_do(self):
        for basis in ("linear", "quadratic"):
            deck = small_deck(time={"end": 1.0, "step": 0.02}, method={"transfer": "apic", "basis": basis})
            said = self.run_deck(self.write(deck), basis, code=NUMERICS)
            self.assertEqual("with linear splines" in said, basis == "linear")

    def test_results_are_not_overwritten_unasked(self):
        deck = self.write(small_deck())
        self.run_deck(deck, "out")
        before = {path: path.stat().st_mtime_ns for path in (self.scratch / "out").rglob("*")}
        said = self.run_deck(deck, "out", code=IO)
        self.assertIn("--overwrite", said)
        self.assertEqual(before, {path: path.stat().st_mtime_ns for path in (self.scratch / "out").rglob("*")})
        (self.scratch / "out" / "mine.txt").write_text("kept")
        self.run_deck(deck, "out", "--overwrite", "--set", "/output/interval=0.05")
        self.assertEqual(len(list((self.scratch / "out" / "frames").iterdir())), 3)
        self.assertTrue((self.scratch / "out" / "mine.txt").exists())

    def test_unwritable_places_are_4(self):
        deck = self.write(small_deck())
        (self.scratch / "file").write_text("")
        for out in ("file", "file/below", "/proc/jaxmpm", "/dev/full"):
            self.assertIn(out, self.run_deck(deck, out, code=IO))
        self.expect(IO, "run", deck, "-o", "out", "--log", self.scratch / "file" / "log.txt")
        self.expect(IO, "run", self.scratch / "missing.json")

    def test_full_disk_is_4_and_leaves_nothing_half_written(self):
        deck = self.write(small_deck())
        for threads in ("1", "2"):  # with more than one, frames are written beside the steps
            for limit in (4, 24):  # blocks of 1 KiB that a file may have
                out, command = f"out{limit}_{threads}", f'ulimit -f {limit}; exec "$0" "$@"'
                done = subprocess.run(["bash", "-c", command, PROGRAM, "run", deck, "-o", out, "--threads", threads], cwd=self.scratch, capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, IO, done.stderr)
                self.assertIn("File too large", done.stderr)
                self.assertNotIn("HDF5-DIAG", done.stderr)
                self.assertIn(out, done.stderr)
                self.assertNoHalfFiles(out)
                self.assertFalse(list((self.scratch / out).rglob("*.tmp")))


if __name__ == "__main__":
    unittest.main()
