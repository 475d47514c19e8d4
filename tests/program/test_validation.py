"""The validation's bands, and the page made of the figures that were kept."""
import contextlib
import io
import json
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

from harness import ROOT

sys.path.insert(0, str(ROOT / "validation"))

import bands  # noqa: E402
import support  # noqa: E402
import validation_page  # noqa: E402
from pictures import SMALL_BYTES  # noqa: E402

ENTRY = {"what": "error", "unit": "%", "reason": "a test", "date": "2026-01-01"}


class Bands(unittest.TestCase):
    def test_every_case_has_bands_with_a_reason_and_a_date(self):
        folders = {path.parent.name for path in (ROOT / "validation").glob("*/check.py")}
        self.assertEqual(folders, set(bands.cases()))
        for own in bands.cases().values():
            self.assertTrue(own)
            for band in own.values():
                self.assertGreater(len(band.reason), 15, band.key)
                self.assertRegex(band.date, r"^\d{4}-\d\d-\d\d$", band.key)

    def test_limits(self):
        self.assertTrue(bands.within(4.0, 4))
        self.assertFalse(bands.within(4.1, 4))
        self.assertFalse(bands.within(float("nan"), 4))
        self.assertTrue(bands.within(1.0, [0.5, 2]))
        self.assertFalse(bands.within(0.4, [0.5, 2]))
        self.assertFalse(bands.within(False, True))
        self.assertTrue(bands.within(9e9, None))

    def test_an_entry_with_a_wrong_key_is_refused(self):
        with self.assertRaisesRegex(SystemExit, "unknown ful"):
            bands.Band("case/error", {**ENTRY, "ful": 3})


class Checks(unittest.TestCase):
    """A check's verdicts, without any run."""

    def check(self, entries, figures, *options):
        """Exit code of a check with these bands and figures, and what it printed."""
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "validation", "case", "check.py")
            own = {key: bands.Band(key, entry) for key, entry in entries.items()}
            said = io.StringIO()
            with mock.patch.object(support, "ROOT", pathlib.Path(folder)), mock.patch.object(support.bands, "cases", lambda: {"case": own}), mock.patch.object(sys, "argv", ["check.py", *options]):
                with contextlib.redirect_stdout(said), self.assertRaises(SystemExit) as left:
                    check = support.Check("", file)
                    for key, value in figures:
                        check.figure(key, value)
                    check.finish()
            return left.exception.code, said.getvalue()

    def test_inside_and_outside(self):
        entries = {"error": {**ENTRY, "full": 4, "quick": 8}}
        self.assertEqual(self.check(entries, [("error", 3.9)])[0], 0)
        self.assertEqual(self.check(entries, [("error", 4.1)])[0], 1)
        self.assertEqual(self.check(entries, [("error", 4.1)], "--quick")[0], 0)

    def test_a_figure_without_a_band_is_an_error(self):
        self.assertIn("no band", self.check({}, [("error", 1)])[0])

    def test_a_band_without_a_figure_is_an_error(self):
        code, said = self.check({"error": {**ENTRY, "full": 4}, "speed": {**ENTRY, "full": 1}}, [("error", 1)])
        self.assertEqual(code, 1)
        self.assertIn("'speed'", said)

    def test_a_figure_that_the_quick_form_does_not_judge(self):
        self.assertEqual(self.check({"error": {**ENTRY, "full": 4}}, [("error", 9)], "--quick")[0], 0)
        self.assertEqual(self.check({"error": {**ENTRY, "full": 4}}, [], "--quick")[0], 0)


class Page(unittest.TestCase):
    def test_it_is_what_the_kept_figures_give(self):
        self.assertEqual(validation_page.PAGE.read_text(encoding="utf-8"), validation_page.page(), "run scripts/python/validation_page.py")

    def test_what_is_kept_belongs_to_a_case_and_its_pictures_are_small(self):
        for path in validation_page.KEPT.iterdir():
            self.assertIn(path.stem, bands.cases(), path)
            self.assertLess(path.stat().st_size, SMALL_BYTES, path)

    def test_the_kept_figures_are_those_of_the_full_size(self):
        for path in validation_page.KEPT.glob("*.json"):
            self.assertEqual(json.loads(path.read_text(encoding="utf-8"))["form"], "full", path)


if __name__ == "__main__":
    unittest.main()
