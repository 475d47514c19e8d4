"""The list of mutations that scripts/mutations makes follows the sources: what it would delete is there."""
import pathlib
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts" / "python"))
from mutations import read_list  # noqa: E402


class Mutations(unittest.TestCase):
    def test_every_term_is_in_its_file(self):
        listed = read_list()
        self.assertGreater(len(listed), 80)
        for file, text, replacement in listed:
            with self.subTest(file=file, text=text):
                self.assertTrue(text in (ROOT / file).read_text(encoding="utf-8"), "there is no such term")
                self.assertNotEqual(text, replacement)
