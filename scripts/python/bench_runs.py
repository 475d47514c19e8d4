"""Calls of `jaxmpm bench` and how two of them are compared; shared by scripts/bench, scripts/bench-yardstick and scripts/bench-peers.

One thread is timed by its processor time, which leaves out what other programs had of the processor; several threads by wall time, because threads
that wait also spin. A ratio is taken between runs side by side in time, and its median over rounds is the result: what changes slowly on a
machine (clock, neighbours) cancels, and a disturbed pair does not count.
"""
import json
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def environment(threads):
    """OpenMP's settings for a measurement: threads stay on their processors where there are several."""
    bind = "true" if threads > 1 else "false"
    return {**os.environ, "OMP_NUM_THREADS": str(threads), "OMP_PROC_BIND": bind}


def output_of(command, threads, **more):
    """Standard output of a command; ends the program with the command's own words when it fails."""
    done = subprocess.run([str(c) for c in command], env=environment(threads), capture_output=True, text=True, check=False, **more)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr or done.stdout}")
    return done.stdout


def bench(program, scene, threads=1, warm_up=5, more=()):
    """The fields of one `jaxmpm bench`; `scene`: (deck, steps, assignments)."""
    deck, steps, assignments = scene
    sets = [word for pointer, value in assignments.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]
    command = [program, "bench", deck, "--steps", steps, "--warm-up", warm_up, "--threads", threads, "--backend", "cpu", "--json", *sets, *more]
    return json.loads(output_of(command, threads))


def rate(result):
    """Particle-steps per second of one result, timed as the head of this file says."""
    seconds = result["cpu_seconds"] if result["threads"] == 1 else result["seconds"]
    return result["particles"] * result["steps"] / seconds


def compare(base, variants, rounds):
    """Rates of variants over that of a base, all callables that measure once and return a rate: medians over rounds, and the spread of the
    ratios. Within a round the base is measured before and after every variant, and the two are averaged."""
    ratios, rates, base_rates = {name: [] for name in variants}, {name: [] for name in variants}, []
    before = base()
    for _ in range(rounds):
        for name, variant in variants.items():
            own, after = variant(), base()
            ratios[name].append(2 * own / (before + after))
            rates[name].append(own)
            base_rates.append(after)
            before = after
    found = {name: {"rate": max(rates[name]), "ratio": statistics.median(r), "low": min(r), "high": max(r)} for name, r in ratios.items()}
    return max(base_rates), found
