"""The program beside peers on equal scenes, in one run; called by scripts/bench-peers. Writes docs/peers.json and docs/peers.md.

    bench_peers.py PROGRAM PEERS_PYTHON ROUNDS
"""
import datetime
import json
import pathlib
import statistics
import sys
import tempfile

import numpy as np
from bench_runs import ROOT, bench, output_of, rate
from results import Results

PEERS = ROOT / "scripts" / "peers"
NAMES = {"taichi": "Taichi", "warp": "Warp", "jax": "JAX"}
STEPS = {2: {"jaxmpm": 2000, "taichi": 800, "warp": 800, "jax": 60}, 3: {"jaxmpm": 30, "taichi": 8, "warp": 8, "jax": 2}}
CHECK_STEPS = {2: 200, 3: 20}
GRADIENT_STEPS = {"jaxmpm": 500, "jax": 50}
PAGE, DATA = ROOT / "docs" / "peers.md", ROOT / "docs" / "peers.json"


def our_state(program, dim):
    """Means and spreads of our run of the scene, as scene.py's figures() are of a peer's."""
    with tempfile.TemporaryDirectory() as out:
        output_of([program, "run", PEERS / f"block{dim}d.json", "-q", "-o", f"{out}/run", "--threads", "1", "--backend", "cpu"], 1)
        results = Results(pathlib.Path(out, "run"))
        frame = results.frames[-1]
        if frame.step != CHECK_STEPS[dim]:
            sys.exit(f"block{dim}d.json ends after {frame.step} steps, not {CHECK_STEPS[dim]}")
        sys.path.insert(0, str(PEERS))
        from scene import figures  # noqa: PLC0415

        return figures(*(frame.field(name).astype(float) for name in ("position", "velocity", "density")))


def call_peer(python, name, dim, threads, *more):
    words = [python, PEERS / f"{name}_mpm.py", "--dim", dim, "--threads", threads, "--steps", STEPS[dim][name], "--check-steps", CHECK_STEPS[dim], *more]
    return json.loads(output_of(words, threads).splitlines()[-1])


def disagreement(ours, theirs):
    """Largest difference of two states' figures, in parts of the spread of what they are figures of."""
    scale = {"mean_position": ours["spread"], "spread": ours["spread"], "mean_velocity": ours["velocity_spread"], "velocity_spread": ours["velocity_spread"],
             "mean_density": ours["density_spread"], "density_spread": ours["density_spread"]}
    return max(float(np.max(np.abs(np.subtract(ours[key], theirs[key])) / scale[key])) for key in scale)


def compare_scene(program, python, dim, threads, rounds):
    """Rates of the peers over ours: each peer right after a run of ours, medians over rounds."""
    state, rows = our_state(program, dim), {name: [] for name in NAMES}
    ours = []
    for _ in range(rounds):
        for name in NAMES:
            own = rate(bench(program, (PEERS / f"block{dim}d.json", STEPS[dim]["jaxmpm"], {}), threads))
            theirs = call_peer(python, name, dim, threads)
            ours.append(own)
            rows[name].append((own / rate(theirs), rate(theirs), theirs))
    found = []
    for name, pairs in rows.items():
        last = pairs[-1][2]
        apart = disagreement(state, last["state"])
        if apart > (1e-9 if dim == 2 else 2e-3):
            sys.exit(f"{NAMES[name]}, {dim}D: its state after {CHECK_STEPS[dim]} steps differs from ours by {apart:.1e} of its spread: not the same step")
        found.append({"peer": NAMES[name], "version": last["version"], "dimension": dim, "threads": threads, "particles": last["particles"],
                      "rate": max(p[1] for p in pairs), "jaxmpm": max(ours), "times": statistics.median(p[0] for p in pairs), "apart": apart})
        print(f"{dim}D, {threads} thread(s): {NAMES[name]} {found[-1]['rate'] / 1e6:.2f} M/s, jaxmpm {max(ours) / 1e6:.2f} M/s: {found[-1]['times']:.1f} times", flush=True)
    return found


def compare_gradient(program, python, rounds):
    """A gradient of the 2D scene by the initial velocities: seconds for 1000 steps, one thread."""
    ours, theirs, version = [], [], ""
    for _ in range(rounds):
        more = ["--gradient"]
        ours.append(bench(program, (PEERS / "block2d.json", GRADIENT_STEPS["jaxmpm"], {}), 1, more=more)["gradient"]["seconds_per_1000_steps"])
        words = [python, PEERS / "jax_mpm.py", "--dim", 2, "--threads", 1, "--steps", GRADIENT_STEPS["jax"], "--check-steps", 1, "--gradient"]
        peer = json.loads(output_of(words, 1).splitlines()[-1])
        theirs.append(1000 * peer["gradient_seconds"] / GRADIENT_STEPS["jax"])
        version = peer["version"]
    found = {"peer": "JAX", "version": version, "seconds": statistics.median(theirs), "jaxmpm": statistics.median(ours),
             "times": statistics.median(t / o for t, o in zip(theirs, ours))}
    print(f"gradient of 1000 steps: JAX {found['seconds']:.1f} s, jaxmpm {found['jaxmpm']:.2f} s: {found['times']:.1f} times", flush=True)
    return found


def page(data):
    """docs/peers.md."""
    lines = ["# Beside other programs", "",
             "Made by `scripts/bench-peers`, which measures all of them in one run, each peer right after a run of ours; the ratios are medians over rounds. The peers are small programs of our own "
             "([scripts/peers](../scripts/peers)): the same step (APIC, quadratic splines, gradient mls, weakly compressible fluid), scene, type and Δt, with no walls, sorting, output or checks, written for speed as a user of the library would. "
             "Their state after some steps is compared with ours: it agrees to the digits that the precision leaves. Particles lie in the order of cells from the start, which spares the peers the sorting that a long run would need. "
             "With one thread processor time counts, with more the clock.", "",
             f"Measured on {data['date']}, {data['machine']}; program of commit {data['commit'][:7]}.", "",
             "| scene | threads | peer | M particle-steps/s | jaxmpm | times as fast |", "|---|---|---|---|---|---|"]
    for row in data["rows"]:
        scene = f"{row['dimension']}D, {row['particles']:,} particles, {'single' if row['dimension'] == 3 else 'double'} precision"
        lines.append(f"| {scene} | {row['threads']} | {row['peer']} {row['version']} | {row['rate'] / 1e6:.2f} | {row['jaxmpm'] / 1e6:.1f} | {row['times']:.1f} |")
    g = data["gradient"]
    lines += ["", f"A gradient over 1000 steps of the 2D scene by the initial velocities, one thread: {g['peer']} {g['version']} (`jax.grad` through a scan, each step computed again on the way back) takes {g['seconds']:.1f} s, "
              f"jaxmpm {g['jaxmpm']:.2f} s: {g['times']:.0f} times as fast.", "",
              "Warp runs a kernel on one thread of a CPU. Taichi's particles to grid runs on one thread too: with atomic additions two threads took four to five times as long. Both are at home on GPUs, which this page says nothing about."
              " Research codes beside ours are in [research-codes.md](research-codes.md)."]
    return "\n".join(lines) + "\n"


def machine():
    names = [line.split(":")[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return f"{len(names)} processors of {names[0]}" if names else "an unknown processor"


def main():
    program, python, rounds = pathlib.Path(sys.argv[1]), sys.argv[2], int(sys.argv[3])
    rows = [row for dim in (3, 2) for threads in (1, 2) for row in compare_scene(program, python, dim, threads, rounds)]
    info = bench(program, (PEERS / "block2d.json", 10, {}), 1)
    data = {"date": datetime.date.today().isoformat(), "machine": machine(), "commit": info["git_commit"], "rows": rows, "gradient": compare_gradient(program, python, rounds)}
    DATA.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(page(data), encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
