"""Runs the scenes, keeps their figures, and writes docs/long_horizons.md."""
import argparse
import concurrent.futures
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from page import PAGE, page
from picture import draw
from remedies import SEARCHES, search
from scenes import SCENES

ROOT = pathlib.Path(__file__).resolve().parents[3]
KEPT = ROOT / "docs" / "horizons"
PROGRAM = os.environ.get("JAXMPM", str(ROOT / "build" / "jaxmpm"))
STEPS = (100, 500, 2000, 5000, 10000, 20000)
QUICK = (100, 500)


def program(*arguments):
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(arguments)}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def truth_of(scene, steps, place):
    """Runs the scene with the true value."""
    (place / "truth.json").write_text(json.dumps(scene.deck(steps)), encoding="utf-8")
    program("run", str(place / "truth.json"), "--set", f"{scene.unknown}={scene.truth}", "-o", str(place / "truth"), "-q", "--threads", "1")


def gradient_at(scene, steps, seen, value, place):
    """Loss and gradient at one value, from what is seen at the end of the run."""
    deck = scene.deck(steps)
    observation = {**scene.seen[seen], "file": str(place / "truth" / "results.h5")}
    if observation["kind"] != "profile":
        observation["from_time"] = 0.5 * steps * scene.step
    deck["inverse"] = {"unknowns": [{"path": scene.unknown, "start": value}], "observations": [observation], "memory": "3 GiB"}
    path = place / f"{seen}_{value:.6g}.json"
    path.write_text(json.dumps(deck), encoding="utf-8")
    found = json.loads(program("gradient", str(path), "--json", "--threads", "1"))
    return {"loss": found["loss"], "gradient": found["gradient"][scene.unknown]}


def measure(scene, steps):
    """By what is seen: losses and gradients at all values."""
    with tempfile.TemporaryDirectory(prefix="jaxmpm-horizons-") as scratch:
        place = pathlib.Path(scratch)
        truth_of(scene, steps, place)
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            waiting = {seen: [pool.submit(gradient_at, scene, steps, seen, value, place) for value in scene.values] for seen in scene.seen}
            return {seen: [job.result() for job in jobs] for seen, jobs in waiting.items()}


def study(name, horizons):
    scene = SCENES[name]
    report = {"scene": name, "title": scene.title, "unknown": scene.unknown, "values": scene.values, "truth": scene.truth, "step": scene.step, "steps": list(horizons), "seen": {seen: [] for seen in scene.seen}}
    for steps in horizons:
        began = time.monotonic()
        for seen, found in measure(scene, steps).items():
            report["seen"][seen].append(found)
        print(f"{name}, {steps} steps: {time.monotonic() - began:.0f} s", flush=True)
    report["commit"] = next(line.split()[-1][:7] for line in program("info").splitlines() if line.startswith("git commit"))
    report["date"] = datetime.date.today().isoformat()
    return report


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=f"of {', '.join(SCENES)}; all when none is named")
    parser.add_argument("--quick", action="store_true", help="runs of up to 500 steps; nothing is kept")
    parser.add_argument("--remedies", action="store_true", help="only the searches with several methods")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.scenes if name not in SCENES]
    if unknown:
        parser.error(f"there is no scene {', '.join(unknown)}; there are {', '.join(SCENES)}")
    KEPT.mkdir(parents=True, exist_ok=True)
    for name in [] if arguments.remedies else arguments.scenes or SCENES:
        report = study(name, QUICK if arguments.quick else STEPS)
        if arguments.quick:
            continue
        (KEPT / f"{name}.json").write_text(json.dumps(report, indent=1) + "\n", encoding="utf-8")
        draw(report, KEPT / f"{name}.png")
    if not arguments.quick:
        for name in SEARCHES if arguments.remedies or not arguments.scenes else []:
            report = search(name, SCENES[name], program)
            (KEPT / f"remedies_{name}.json").write_text(json.dumps(report, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
        reports = [json.loads((KEPT / f"{name}.json").read_text(encoding="utf-8")) for name in SCENES if (KEPT / f"{name}.json").is_file()]
        searches = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(KEPT.glob("remedies_*.json"))]
        PAGE.write_text(page(reports, searches), encoding="utf-8")
        print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
