"""Deletes one term of an adjoint after another, in a copy of the sources, and shows which test notices.

The list is tests/mutations.txt; a mutation that no test notices fails the whole. Each takes about a minute on one core; `scripts/mutations --from N`
goes on at number N, `--every K` takes each K-th only, `--containing TEXT` those with TEXT in their line.
"""
import argparse
import filecmp
import os
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
TESTS = {
    "test_kernels": ["adjoints by hand*"],
    "test_solvers": ["the adjoint*"],
    "test_inverse": ["gradients*,a gradient*"],
}


def read_list():
    """(file, text, replacement) of each mutation: `@ file`, then lines `text => replacement`."""
    mutations, file = [], None
    for line in (ROOT / "tests" / "mutations.txt").read_text().splitlines():
        if line.startswith("#") or not line.strip():
            continue
        if line.startswith("@ "):
            file = line[2:].strip()
        else:
            text, replacement = line.split(" => ") if " => " in line else (line.removesuffix(" =>"), "")
            mutations.append((file, text.strip(), replacement.strip()))
    return mutations


def run(command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=False, **more)


def copy_changed(source, target):
    """A file that differs is as new as the copy: with its own time an object of an older copy would count as up to date."""
    if not os.path.exists(target) or not filecmp.cmp(source, target, shallow=False):
        shutil.copyfile(source, target)


# What is left unused where a term is deleted is no error.
FLAGS = "-O1 " + " ".join(f"-Wno-unused-{what}" for what in ("variable", "parameter", "but-set-variable", "but-set-parameter", "function"))


class Copy:
    """The tree beside its build folder, configured for quick compiles."""

    def __init__(self, folder):
        self.source, self.build = folder / "source", folder / "build"
        self.source.mkdir(parents=True, exist_ok=True)
        for part in ("lib", "apps", "tests", "cmake", "inputs", "CMakeLists.txt"):
            source = ROOT / part
            if source.is_dir():
                shutil.copytree(source, self.source / part, dirs_exist_ok=True, copy_function=copy_changed)
            else:
                copy_changed(source, self.source / part)
        done = run(["cmake", "-S", self.source, "-B", self.build, "-G", "Ninja", f"-DCMAKE_CXX_FLAGS_RELEASE={FLAGS}", *os.environ.get("JAXMPM_CMAKE", "").split()])
        if done.returncode:
            sys.exit(done.stdout + done.stderr)

    def noticed_by(self):
        """The first test program that fails, `build` where it does not compile, None where all pass."""
        done = run(["ninja", "-C", self.build, *TESTS])
        if done.returncode:
            return "build"
        for program, tests in TESTS.items():
            if run([self.build / "tests" / program, *tests]).returncode:
                return program
        return None

    def mutate(self, file, text, replacement):
        path = self.source / file
        original = path.read_text()
        if original.count(text) != 1:
            sys.exit(f"{file}: {text!r} is there {original.count(text)} times; a mutation has to name one place")
        path.write_text(original.replace(text, replacement))
        noticed = self.noticed_by()
        path.write_text(original)
        return noticed


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--from", dest="first", type=int, default=1)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--containing", default="")
    options = parser.parse_args()
    mutations = read_list()
    copy = Copy(options.folder)
    clean = copy.noticed_by()
    if clean:
        sys.exit(f"the unchanged sources fail already: {clean}")
    missed = 0
    for number, mutation in enumerate(mutations, 1):
        if number < options.first or (number - options.first) % options.every or options.containing not in mutation[1]:
            continue
        begun = time.monotonic()
        noticed = copy.mutate(*mutation)
        missed += noticed in (None, "build")
        verdict = {None: "NOT NOTICED", "build": "DOES NOT COMPILE"}.get(noticed, f"noticed by {noticed}")
        print(f"{number:3d} {verdict:24} {time.monotonic() - begun:4.0f} s  {mutation[0]}: {mutation[1]}  =>  {mutation[2] or '(nothing)'}", flush=True)
    print(f"{missed} not noticed")
    sys.exit(missed > 0)


if __name__ == "__main__":
    main()
