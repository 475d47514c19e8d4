"""jaxmpm check, bench, schema, info."""
import json
import pathlib
import re
import unittest

from harness import BAD_VERDICT, DECK, DONE, INPUTS, ROOT, ProgramTest, coarse_decks, small_deck


class Commands(ProgramTest):
    def test_help_lists_what_there_is(self):
        said = self.expect(DONE, "--help")
        for command in ("run", "check", "bench", "schema", "info"):
            self.assertIn(command, said)
        self.assertIn("--max-walltime", self.expect(DONE, "run", "--help"))

    def test_help_names_documents_that_exist(self):
        for command in ("run", "invert", "check", "gradient", "bench"):
            named = re.findall(r"docs/[\w.-]+", self.expect(DONE, command, "--help"))
            self.assertTrue(named, command)
            for document in named:
                self.assertTrue((ROOT / document).is_file(), document)

    def test_check(self):
        said = self.expect(DONE, "check", self.write(small_deck()))
        for word in ("576", "time step", "memory", "estimated time"):
            self.assertIn(word, said)
        self.assertFalse((self.scratch / "out").exists())
        self.assertIn("VERDICT", self.expect(BAD_VERDICT, "check", self.write(small_deck(time={"end": 1, "step": 0.01}))))
        self.assertIn("/gravity", self.expect(DECK, "check", self.write(small_deck(gravity=[0, 0, -1]))))

    def test_check_advises_without_changing_the_verdict(self):
        self.assertNotIn("advice:", self.expect(DONE, "check", self.write(small_deck(materials={"water": {"model": "newtonian", "density": 1000, "sound_speed": 30}}))))
        said = self.expect(DONE, "check", self.write(small_deck(method={"transfer": "pic", "basis": "linear"})))
        self.assertIn("advice: linear splines", said)
        self.assertIn("advice: the part of PIC", said)

    def test_bench(self):
        done = self.call("bench", self.write(small_deck()), "--steps", "20", "--json", "--threads", "1")
        self.assertEqual(done.returncode, DONE, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual((result["particles"], result["steps"], result["threads"], result["backend"]), (576, 20, 1, "cpu"))
        self.assertEqual((result["precision"], result["gradient_form"]), ("f64", "spline"))
        self.assertAlmostEqual(result["particle_steps_per_second"], 576 * 20 / result["seconds"], delta=1e-6 * result["particle_steps_per_second"])
        self.assertAlmostEqual(result["seconds_per_1000_steps"], 50 * result["seconds"])
        self.assertGreater(result["bytes_per_particle"], 0)
        self.assertGreater(result["peak_memory_bytes"], 1e6)
        self.assertLessEqual(sum(result["seconds_by_phase"].values()), 1.01 * result["seconds"])

    def test_peak_memory_is_the_program_s_own(self):
        ballast = b"x" * (400 << 20)  # of the process that starts it
        result = json.loads(self.call("bench", self.write(small_deck()), "--steps", "5", "--json", "--threads", "1").stdout)
        self.assertLess(result["peak_memory_bytes"], len(ballast) // 2)

    def bench(self, deck, **assignments):
        words = [word for pointer, value in assignments.items() for word in ("--set", f"{pointer.replace('__', '/')}={json.dumps(value)}")]
        done = self.call("bench", deck, "--steps", "1", "--warm-up", "0", "--threads", "1", "--json", *words)
        self.assertEqual(done.returncode, DONE, done.stderr)
        return json.loads(done.stdout)

    def test_bytes_per_particle_are_those_of_the_documentation(self):
        elastic = {"density": 1000, "youngs_modulus": 1e6, "poisson_ratio": 0.3}
        materials = {
            "newtonian, inviscid": {"model": "newtonian", "density": 1000, "sound_speed": 20},
            "newtonian, viscous": {"model": "newtonian", "density": 1000, "sound_speed": 20, "viscosity": 1},
            "linear_elastic": {"model": "linear_elastic", **elastic}, "neo_hookean": {"model": "neo_hookean", **elastic},
            "drucker_prager": {"model": "drucker_prager", "density": 1000, "bulk_modulus": 1e6, "poisson_ratio": 0.3, "friction_angle": 20},
        }
        page = (ROOT / "docs" / "performance.md").read_text(encoding="utf-8")
        table = page[page.index("| material | 2D flip f32"):].split("\n\n")[0].splitlines()
        columns = [name.split() for name in table[0].strip("|").split(" | ")[1:]]
        stated = {cells[0].strip(): [float(c) for c in cells[1:]] for cells in (line.strip("|").split("|") for line in table[2:])}
        self.assertEqual(set(stated), set(materials))
        for (dim, transfer, precision), column in zip(columns, range(len(columns))):
            n = int(dim[0])
            scene = self.write(small_deck(
                domain={"min": [0] * n, "max": [0.5] * n, "cell_size": 0.05}, gravity=[0] * n, obstacles=[], gauges={}, output={"interval": 0.1, "formats": ["hdf5"]},
                bodies=[{"name": "block", "material": "water", "shape": {"box": {"min": [0.1] * n, "max": [0.2] * n}}}]))
            for name, material in materials.items():
                found = self.bench(scene, __materials__water=material, __method__transfer=transfer, __method__precision=precision)
                self.assertEqual(found["bytes_per_particle"], stated[name][column], f"{name}, {dim} {transfer} {precision}")

    def test_an_empty_domain_takes_no_memory(self):
        deck = self.write(small_deck(gauges={}, obstacles=[]))
        small, large = self.bench(deck), self.bench(deck, __domain__max=[10, 5])
        self.assertEqual(small["active_blocks"], large["active_blocks"])
        self.assertLess(large["peak_memory_bytes"], 1.02 * small["peak_memory_bytes"])

    def test_schema_and_info(self):
        schema = json.loads(self.call("schema").stdout)
        self.assertIn("2020-12", schema["$schema"])
        self.assertIn("| key", self.call("schema", "--markdown").stdout.lower().replace("|key", "| key"))
        said = self.expect(DONE, "info")
        for word in ("git commit", "Kokkos", "compiler", "vector width", "backends"):
            self.assertIn(word, said)

    def test_quiet_is_quiet_and_the_log_tells_all(self):
        deck = self.write(small_deck(time={"end": 0.02}))
        done = self.call("run", deck, "-o", "a", "-q", "--log", "log.txt", "--threads", "1")
        self.assertEqual((done.returncode, done.stdout, done.stderr), (DONE, "", ""))
        log = (self.scratch / "log.txt").read_text()
        self.assertIn("Done", log)
        self.assertIn("frame 1", log)
        self.assertIn("frame 1", self.expect(DONE, "run", deck, "-o", "b", "-v", "--threads", "1"))

    def test_every_deck_of_inputs_passes_the_check_in_its_coarse_form(self):
        for name, coarse in coarse_decks().items():
            with self.subTest(deck=name):
                self.assertTrue(pathlib.Path(INPUTS / name).exists())
                self.expect(DONE, "check", INPUTS / name, "--threads", "1", *coarse)


if __name__ == "__main__":
    unittest.main()
