"""The rooms of the house: what each folder of lib/ includes is what the table of lib/README.md and CMakeLists.txt permit, and points downwards."""
import pathlib
import re
import unittest

from harness import ROOT

LIB = ROOT / "lib"


def table():
    """Room → rooms that it may use, in the order of the table."""
    rows = re.findall(r"^\| `([a-z]+)` \|.*\| ([^|]*) \|$", (LIB / "README.md").read_text(encoding="utf-8"), re.MULTILINE)
    return {room: set(re.findall(r"[a-z]+", uses)) for room, uses in rows}


def included(room):
    """(file, room of the included header) of every include of another room."""
    rooms = set(table()) - {room}
    for path in (LIB / room).rglob("*.[ch]*"):
        for other in re.findall(r'#include "([a-z]+)/', path.read_text(encoding="utf-8")):
            if other in rooms:
                yield path.relative_to(ROOT), other


class Rooms(unittest.TestCase):
    def test_the_table_names_every_room_once(self):
        self.assertEqual(set(table()), {path.name for path in LIB.iterdir() if path.is_dir()})

    def test_uses_point_downwards(self):
        rooms = list(table())
        for room, uses in table().items():
            self.assertLessEqual(uses & set(rooms), set(rooms[rooms.index(room) + 1:]), room)

    def test_includes_are_permitted_and_permissions_are_used(self):
        for room, uses in table().items():
            found = set()
            for path, other in included(room):
                self.assertIn(other, uses, f"{path} includes {other}/, which lib/README.md does not permit")
                found.add(other)
            self.assertEqual(uses & set(table()) - found, set(), f"{room} never includes what it may")

    def test_cmake_says_the_same(self):
        cmake = (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
        for room, uses in table().items():
            line = re.search(rf"jaxmpm_room\({room}\b(?: USES ([a-z ]+))?", cmake)
            self.assertEqual(set((line[1] or "").split()), uses & set(table()), room)


if __name__ == "__main__":
    unittest.main()
