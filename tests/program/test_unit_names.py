"""The names under which ctest knows the unit tests: what a test program prints besides must not become one."""
import json
import pathlib
import subprocess
import unittest

from harness import PROGRAM

BUILD = pathlib.Path(PROGRAM).parent


class UnitNames(unittest.TestCase):
    def test_every_name_is_a_test_of_a_room(self):
        if not (BUILD / "CTestTestfile.cmake").is_file():
            self.skipTest("the program was built without its unit tests")
        listing = subprocess.run(["ctest", "--test-dir", BUILD, "--show-only=json-v1"], capture_output=True, text=True, check=True)
        names = [test["name"] for test in json.loads(listing.stdout)["tests"]]
        self.assertGreater(len(names), 100)
        for name in names:
            self.assertRegex(name, r"^[a-z]+: ?(?!Kokkos::)[^ ]", "not a name of a test")
            self.assertNotIn("OMP_PROC_BIND", name)


if __name__ == "__main__":
    unittest.main()
