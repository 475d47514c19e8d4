"""The speed–accuracy charts: their Pareto front, the page made of the kept data, and a small grid from end to end."""
import dataclasses
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

from harness import ROOT

import charts_data
import charts_page
import charts_picture
from charts_scene import scenes


def point(seconds, error, **more):
    return {**charts_data.BASE, "cell": 1, "per_cell": 4, "cpu_seconds": seconds, "errors": {"e": error}, **more}


def kept(points, paper=None):
    return charts_data.Kept("scene", "full", "2026-01-01", "a machine", points, paper, None, [])


class Data(unittest.TestCase):
    def test_the_front_is_what_no_other_point_beats(self):
        slow, good, bad, fast = point(9, 1), point(3, 2), point(4, 2.5), point(1, 8)
        self.assertEqual(kept([bad, slow, fast, good]).front("e"), [fast, good, slow])

    def test_of_two_points_that_took_the_same_time_the_better_is_on_the_front(self):
        self.assertEqual(kept([point(1, 3), point(1, 2)]).front("e"), [point(1, 2)])

    def test_the_rival_is_the_cheapest_that_is_as_good_as_the_paper(self):
        points = [point(1, 8), point(3, 2), point(9, 1)]
        self.assertEqual(kept(points, point(10, 2)).rival("e"), points[1])
        self.assertIsNone(kept(points, point(10, 0.5)).rival("e"))

    def test_dominated_means_as_good_in_less_than_a_third(self):
        self.assertTrue(kept([point(3, 2)], point(10, 2)).dominates("e"))
        self.assertFalse(kept([point(3, 2)], point(9, 2)).dominates("e"))
        self.assertFalse(kept([point(3, 2)], point(100, 1)).dominates("e"))

    def test_points_are_compared_by_the_cost_that_the_scene_names(self):
        points = [point(1, 2, particle_steps=90), point(3, 2, particle_steps=20), point(9, 1, particle_steps=80)]
        data = kept(points, point(1, 2, particle_steps=70))
        data.cost = "particle_steps"
        self.assertEqual(data.front("e"), [points[1], points[2]])
        self.assertEqual(data.rival("e"), points[1])
        self.assertTrue(data.dominates("e"))

    def test_a_choice_is_compared_with_points_that_differ_in_nothing_else(self):
        points = [point(2, 4), point(8, 1, cell=2), point(1, 8, precision="f32"), point(2, 1, precision="f32", cell=2), point(1, 1, precision="f32", cell=3)]
        self.assertEqual(list(kept(points).choices(["e"])), [("precision", "f32", 2, 0.375, [1.5])])

    def test_parts_of_averaging_that_a_scene_has_are_choices(self):
        points = [point(2, 4), point(3, 1, averaging=0.9), point(4, 2, averaging=1)]
        self.assertEqual(list(kept(points).choices(["e"])), [("averaging", 0.9, 1, 1.5, [0.25]), ("averaging", 1, 1, 2, [0.5])])

    def test_what_is_written_is_read_again(self):
        with tempfile.TemporaryDirectory() as folder:
            whole = kept([point(1, 8), point(3, 2)], point(9, 1))
            whole.write(pathlib.Path(folder))
            self.assertEqual(charts_data.read("scene", pathlib.Path(folder)), whole)


class Page(unittest.TestCase):
    def test_it_is_what_the_kept_data_give(self):
        self.assertEqual(charts_page.PAGE.read_text(encoding="utf-8"), charts_page.page(), "run scripts/charts")

    def test_what_is_kept_belongs_to_a_scene_and_its_pictures_are_small(self):
        for path in charts_data.KEPT.iterdir():
            self.assertIn(path.stem, scenes(), path)
            if path.suffix == ".png":
                self.assertLess(path.stat().st_size, charts_picture.PICTURE_BYTES, path)

    def test_the_kept_data_hold_the_whole_grid(self):
        for name, scene in scenes().items():
            data = charts_data.read(name)
            self.assertEqual(data.form, "full", name)
            held = [{field.name: p[field.name] for field in dataclasses.fields(scene.paper)} for p in (*data.points, *data.failed)]
            wanted = [dataclasses.asdict(variant) for variant in scene.variants()]
            self.assertEqual(sorted(map(json.dumps, held)), sorted(map(json.dumps, wanted)), name)
            for p in (*data.points, data.paper):
                self.assertEqual(set(p["errors"]), set(scene.measures), name)
                self.assertTrue(all(map(math.isfinite, p["errors"].values())), (name, p))
                self.assertEqual(p["particle_steps"], p["particles"] * p["steps"])


class Quick(unittest.TestCase):
    def charts(self, folder):
        command = [sys.executable, ROOT / "scripts" / "python" / "charts.py", "--quick", "-o", folder, "elastic_bar"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_a_grid_of_seconds(self):
        with tempfile.TemporaryDirectory() as folder:
            self.charts(folder)
            data = charts_data.read("elastic_bar", pathlib.Path(folder))
            self.assertEqual((data.form, data.failed), ("quick", []))
            self.assertGreater(pathlib.Path(folder, "elastic_bar.png").stat().st_size, 10_000)
            coarse, fine = (data.point(transfer="apic", basis="quadratic", precision="f64", cell=cell) for cell in (0.025, 0.1 / 6))
            self.assertLess(fine["errors"]["frequency"], coarse["errors"]["frequency"])
            self.assertEqual(coarse["particles"], 640)
            self.assertEqual(self.charts(folder), "elastic_bar\n", "what is there is not run again")


if __name__ == "__main__":
    unittest.main()
