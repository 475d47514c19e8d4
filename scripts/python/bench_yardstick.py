"""The program's speed as a ratio to the yardsticks of scripts/yardstick, on the same scenes in turn; called by scripts/bench-yardstick.

    bench_yardstick.py PROGRAM FOLDER [ROUNDS]        prints rates and ratios
    bench_yardstick.py PROGRAM FOLDER --check         fails where a ratio has fallen far below the stated one (stated.json)
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys

from bench_runs import ROOT, bench, environment, rate

# scene: yardstick, deck, arguments of the yardstick (cells along x, steps, steps between sorts) with one to fill in, steps
SCENES = {
    "3D, single precision": ("transfer3d", "block3d.json", ("20", "{}", "10"), 60),
    "2D, double precision": ("transfer2d", "block2d.json", ("50", "{}", "20"), 4000),
}
DECKS = ROOT / "scripts" / "yardstick"
STATED = DECKS / "stated.json"


def run_yardstick(command, threads):
    """What a yardstick printed, and the processor time of the whole call, s."""
    before = os.times()
    done = subprocess.run([str(c) for c in command], env=environment(threads), capture_output=True, text=True, check=False)
    after = os.times()
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr or done.stdout}")
    return json.loads(done.stdout), after.children_user + after.children_system - before.children_user - before.children_system


def yardstick_rate(program, arguments, steps, threads):
    """Particles and particle-steps/s of the bare step. With one thread by processor time, of which the time of a run with hardly a step is
    taken off, as it seeds its particles too."""
    command = [program, *arguments]
    command[2] = str(steps)
    result, cpu = run_yardstick(command, threads)
    if threads > 1:
        return result["particles"], result["particle_steps_per_second"]
    command[2] = "1"
    _, start = run_yardstick(command, threads)
    return result["particles"], result["particles"] * (steps - 1) / (cpu - start)


def measure_pair(program, yardsticks, scene, share, threads):
    """Rates of the yardstick and of the program, one right after the other; `share` of the scene's steps are taken."""
    bare, deck, arguments, steps = SCENES[scene]
    steps = max(2, round(steps * share))
    particles, bare_rate = yardstick_rate(yardsticks / bare, arguments, steps, threads)
    ours = bench(program, (DECKS / deck, steps, {}), threads)
    if particles != ours["particles"]:
        sys.exit(f"{scene}: the yardstick has {particles} particles, the program {ours['particles']}")
    return bare_rate, rate(ours)


def measure(program, yardsticks, rounds, threads):
    """One row for each scene and number of threads: the best rates, and the median of the ratios of pairs."""
    rows = []
    for scene in SCENES:
        for n in threads:
            pairs = [measure_pair(program, yardsticks, scene, 1, n) for _ in range(rounds)]
            row = {"scene": scene, "threads": n, "yardstick": max(b for b, _ in pairs), "jaxmpm": max(o for _, o in pairs),
                   "ratio": statistics.median(o / b for b, o in pairs)}
            rows.append(row)
            print(f"{scene}, {n} thread(s): yardstick {row['yardstick']:.4g}, jaxmpm {row['jaxmpm']:.4g} particle-steps/s, ratio {row['ratio']:.3f}", flush=True)
    return rows


def check(program, yardsticks):
    """Whether the ratio of every scene, one thread, is above its floor. Other programs disturb a single pair, a slower kernel lowers all: the best
    of the pairs counts, and a scene fails only after many of them, taken over some time."""
    stated = json.loads(STATED.read_text())
    failed = 0
    for scene, expected in stated["ratio"].items():
        floor = stated["floor"] * expected
        best, tries = 0.0, 0
        while tries < 15 and (tries < 3 or best < floor):
            bare, ours = measure_pair(program, yardsticks, scene, 1 / 4, 1)
            best, tries = max(best, ours / bare), tries + 1
        verdict = "ok" if best >= floor else "FAILED"
        failed += best < floor
        print(f"{verdict}: {scene}: ratio to the yardstick {best:.2f} (best of {tries} pairs), stated {expected:.2f}, floor {floor:.2f}", flush=True)
    print(f"{len(stated['ratio']) - failed} passed, {failed} failed")
    return failed == 0


def main():
    program, yardsticks = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    if sys.argv[3:] == ["--check"]:
        sys.exit(0 if check(program, yardsticks) else 1)
    measure(program, yardsticks, int(sys.argv[3]) if len(sys.argv) > 3 else 5, (1, 2))


if __name__ == "__main__":
    main()
