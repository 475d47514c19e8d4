"""Bitwise reproducibility: stopped and resumed, 1 and 2 threads, with and without output in between. Compares every dataset of the last frame."""
import pathlib
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np  # noqa: E402
from results import Results  # noqa: E402

STOPPED = 75  # exit code of a run that was stopped and left a checkpoint


def same_bits(one, other):
    a, b = one.frames[-1], other.frames[-1]
    return a.time == b.time and a.step == b.step and all(np.array_equal(a.field(name), b.field(name)) for name in a.fields())


def frames_on_disk(target):
    return len(list((target / "frames").glob("*.h5")))


def interrupted(check, deck, name, assignments):
    """Runs with a SIGTERM after every few frames, resuming each time until done. Returns the results and how often it was stopped."""
    target = check.out / name
    shutil.rmtree(target, ignore_errors=True)
    for stops in range(50):
        process = subprocess.Popen(check.command(deck, name, assignments, "--resume", "auto"), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        enough = frames_on_disk(target) + 3
        while process.poll() is None and frames_on_disk(target) < enough:
            time.sleep(0.001)
        process.send_signal(signal.SIGTERM)
        output, _ = process.communicate()
        if process.returncode == 0:
            return Results(target), stops
        if process.returncode != STOPPED:
            sys.exit(f"  {name}: exit {process.returncode}\n{output}")
    sys.exit(f"  {name}: not done after {stops} stops")


def main():
    check = Check(__doc__, __file__)
    coarse = {"/domain/cell_size": 0.0028575} if check.quick else {}
    scenes = {
        "water_column.json": {**coarse, "/time/end": 0.1},
        "aluminium_bars.json": {"/output/interval": 0.02, "/time/end": 0.2, **({"/domain/cell_size": 0.005, "/time/step": 2.5e-5} if check.quick else {})},
    }
    for deck, assignments in scenes.items():
        stem = deck.removesuffix(".json")
        whole = check.run(deck, f"{stem}_whole", assignments, "--threads", "2")
        one = check.run(deck, f"{stem}_one_thread", assignments, "--threads", "1")
        check.holds("threads", same_bits(whole, one), stem)
        quiet = check.run(deck, f"{stem}_quiet", {**assignments, "/output/interval": assignments["/time/end"], "/output/gauge_interval": assignments["/time/end"]})
        check.holds("output", same_bits(whole, quiet), stem)
        resumed, stops = interrupted(check, deck, f"{stem}_resumed", assignments)
        check.holds("resumed", stops > 0 and same_bits(whole, resumed), f"{stem}, stopped {stops} times")
    check.finish()


if __name__ == "__main__":
    main()
