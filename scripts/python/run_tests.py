"""Runs the tests of a build folder and closes with a line `N passed, N failed`: what scripts/test does after set-up and build.

unit      every Catch2 test through ctest, two at a time; with --all also those tagged [.long]
program   tests/program/*.py against the built program
decks     every deck of inputs/ in a coarse form for a few steps (inputs/coarse.txt)
validate  validation/*/check.py --quick; with --all at full size
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

from coarse_decks import INPUTS, coarse_decks

ROOT = pathlib.Path(__file__).resolve().parents[2]
SUITES = ("unit", "program", "decks", "validate")
# Two tests at a time, each with threads that wait by spinning, would be slower by far than with one thread each.
ONE_THREAD = {**os.environ, "OMP_NUM_THREADS": "1"}


class Tally:
    """Numbers of tests by outcome, and the names of those that failed."""

    def __init__(self):
        self.passed, self.skipped, self.failed = 0, 0, []

    def add(self, name, good):
        if good:
            self.passed += 1
        else:
            self.failed.append(name)


def unit(build, tally, options):
    report = pathlib.Path(build).resolve() / "ctest.xml"
    report.unlink(missing_ok=True)
    command = ["ctest", "--test-dir", str(build), "-j2", "--output-on-failure", "--timeout", "1200", "--output-junit", str(report)]
    subprocess.run(command, check=False, env=ONE_THREAD)
    if not report.is_file():
        tally.add("ctest (it left no report)", False)
        return
    for case in xml.etree.ElementTree.parse(report).getroot().iter("testcase"):
        status = case.get("status")
        if status in ("notrun", "disabled"):
            tally.skipped += 1
        else:
            tally.add(case.get("name"), status == "run")
    if options.all:
        long_unit(build, tally)


def long_unit(build, tally):
    for program in sorted(pathlib.Path(build, "tests").glob("test_*")):
        if not os.access(program, os.X_OK) or program.is_dir():
            continue
        listing = subprocess.run([program, "--list-test-names-only", "[long]"], capture_output=True, text=True, check=False)
        for name in filter(None, map(str.strip, listing.stdout.splitlines())):
            escaped = name.replace(",", "\\,").replace("[", "\\[")
            tally.add(f"{program.name}: {name}", run_quietly([program, escaped], f"{program.name}: {name}"))


def run_quietly(command, name, **more):
    """Runs a command; one line about it, and its output where it failed."""
    began = time.monotonic()
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, **more)
    print(f"   {'ok    ' if done.returncode == 0 else 'FAILED'} {time.monotonic() - began:6.1f} s  {name}", flush=True)
    if done.returncode:
        print(done.stdout[-6000:], flush=True)
    return done.returncode == 0


def program(build, tally, _options):
    folder = ROOT / "tests" / "program"
    if not folder.is_dir():
        tally.add("tests/program is missing", False)
        return
    suite = unittest.defaultTestLoader.discover(str(folder), pattern="*.py")
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(suite)
    bad = [str(test) for test, _ in result.failures + result.errors] + [str(test) for test in result.unexpectedSuccesses]
    tally.failed += bad
    tally.skipped += len(result.skipped)
    tally.passed += result.testsRun - len(bad) - len(result.skipped)


def decks(build, tally, _options):
    forms = coarse_decks()
    with tempfile.TemporaryDirectory() as out:
        for name in sorted(path.name for path in INPUTS.glob("*.json")):
            if name not in forms:
                tally.add(f"inputs/{name} has no line in inputs/coarse.txt", False)
                continue
            command = [build / "jaxmpm", "run", INPUTS / name, "-q", "-o", pathlib.Path(out) / name, *forms[name]]
            tally.add(f"inputs/{name}", run_quietly(command, f"inputs/{name}", env=ONE_THREAD))


def validate(_build, tally, options):
    for check in sorted((ROOT / "validation").glob("*/check.py")):
        command = [sys.executable, check] + ([] if options.all else ["--quick"])
        tally.add(f"validation/{check.parent.name}", run_quietly(command, f"validation/{check.parent.name}"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help="build folder")
    parser.add_argument("--suites", nargs="+", choices=SUITES, default=list(SUITES))
    parser.add_argument("--all", action="store_true", help="the long ones too")
    options = parser.parse_args()
    build = options.build.resolve()
    os.environ["JAXMPM"] = str(build / "jaxmpm")
    os.environ["JAXMPM_PYTHON"] = sys.executable
    if options.all:
        os.environ["JAXMPM_ALL"] = "1"
    tally = Tally()
    for suite in options.suites:
        began = time.monotonic()
        print(f"== {suite}", flush=True)
        globals()[suite](build, tally, options)
        print(f"== {suite}: {time.monotonic() - began:.0f} s", flush=True)
    for name in tally.failed:
        print(f"FAILED {name}")
    skipped = f", {tally.skipped} skipped" if tally.skipped else ""
    print(f"{tally.passed} passed, {len(tally.failed)} failed{skipped}")
    sys.exit(1 if tally.failed or not tally.passed else 0)


if __name__ == "__main__":
    main()
