"""What scripts/bench measures, part by part. Every function takes the settings and returns plain data; bench_page.py makes the page of it."""
import json
import os
import statistics
import tempfile
import time

import numpy as np

import bench_scenes as scenes
from bench_runs import bench, compare, output_of, rate
from bench_yardstick import measure as measure_yardstick
from results import Results


class Settings:
    """The program; the folder of the compiled yardsticks, which are only run where the processor has AVX-512; a portable build or None; and
    whether to measure less."""

    def __init__(self, program, yardsticks, avx512, portable, quick):
        self.program, self.yardsticks, self.avx512, self.portable, self.quick = program, yardsticks, avx512, portable, quick
        self.rounds = 3 if quick else 5
        self.threads = sorted({1, 2, 4, 8, 16, 32, 64, processors()} & set(range(1, processors() + 1)))
        self.disturbance = []  # wall time over processor time of every run with one thread

    def bench(self, scene, threads=1, **more):
        result = bench(self.program, scene, threads, **more)
        if threads == 1 and result["cpu_seconds"] > 0:
            self.disturbance.append(result["seconds"] / result["cpu_seconds"])
        return result

    def rate_of(self, scene):
        """A callable that measures the scene once, with one thread."""
        return lambda: rate(self.bench(scene))


def processors():
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0))


def yardstick(s):
    """Ratio to the bare step."""
    if not s.avx512:
        return {"skipped": "this processor lacks AVX-512 (F and DQ), for which the yardsticks are written"}
    return {"rows": measure_yardstick(s.program, s.yardsticks, s.rounds, s.threads[:2])}


def particles(s):
    """Rate against the number of particles, with one thread and with all."""
    rows = []
    for dim in (3, 2):
        sides = scenes.SIDES[dim][:4] if s.quick else scenes.SIDES[dim]
        for side in sides:
            scene = scenes.cube(dim, side, scenes.SPLINE, 3e6 if s.quick else 1.2e7)
            for threads in sorted({1, s.threads[-1]}):
                results = [s.bench(scene, threads, warm_up=2) for _ in range(1 if side == scenes.SIDES[dim][-1] else 2)]
                best = max(results, key=rate)
                rows.append({"dimension": dim, "precision": best["precision"], "threads": threads, "particles": best["particles"], "steps": best["steps"],
                             "rate": rate(best), "peak_memory_bytes": best["peak_memory_bytes"], "active_blocks": best["active_blocks"]})
                progress(f"{dim}D, {best['particles']:,} particles, {threads} thread(s): {rate(best) / 1e6:.1f} M/s")
    return {"rows": rows}


def threads(s):
    """Rate and phases against the number of threads, by the clock, rounds interleaved."""
    rows = []
    for dim in (3, 2):
        scene = scenes.block(dim, {3: 20, 2: 2000}[dim], **scenes.SPLINE)
        found = {n: [] for n in s.threads}
        for _ in range(s.rounds):
            for n in s.threads:
                found[n].append(s.bench(scene, n))
        for n in s.threads:
            best = min(found[n], key=lambda r: r["seconds"])
            rows.append({"dimension": dim, "precision": best["precision"], "threads": n, "particles": best["particles"],
                         "rate": best["particles"] * best["steps"] / best["seconds"], "seconds_by_phase": best["seconds_by_phase"], "seconds": best["seconds"]})
            progress(f"{dim}D, {n} thread(s): {rows[-1]['rate'] / 1e6:.1f} M/s")
    return {"rows": rows}


def configurations(s):
    """Ratios of precision, transfer, basis, gradient and material, one thread."""
    groups = []
    for dim in (3, 2):
        for name, (base, variants) in scenes.configurations(dim).items():
            calls = {v: s.rate_of(scenes.variant_block(dim, assignments)) for v, assignments in variants.items()}
            base_rate, found = compare(s.rate_of(scenes.variant_block(dim, base)), calls, s.rounds)
            for v, assignments in variants.items():
                found[v]["bytes_per_particle"] = s.bench((*scenes.variant_block(dim, assignments)[:1], 1, assignments), warm_up=0)["bytes_per_particle"]
                progress(f"{dim}D, {name}: {v} {found[v]['ratio']:.2f}")
            groups.append({"dimension": dim, "precision": scenes.BASE_PRECISION[dim], "base": name, "rate": base_rate, "variants": found})
    return {"groups": groups}


def phases(s):
    """Share of the phases of a step, one thread."""
    rows = []
    for dim in (3, 2):
        for gradient in ("mls", "spline"):
            result = s.bench(scenes.block(dim, {3: 20, 2: 2000}[dim], **{"/method/gradient": gradient}))
            rows.append({"dimension": dim, "precision": result["precision"], "gradient": gradient, "seconds_by_phase": result["seconds_by_phase"]})
    return {"rows": rows}


def roofline(s):
    """Bytes and flops per particle-step beside what the machine allows, one thread."""
    limits = json.loads(output_of([s.yardsticks / "limits"], 1))
    rows = []
    for dim in (3, 2):
        for precision in ("f32", "f64"):
            scene = (scenes.BLOCKS[dim], {3: 10, 2: 1000}[dim], {"/method/precision": precision})
            results = [s.bench(scene) for _ in range(3)]
            best = max(results, key=rate)
            rows.append({"dimension": dim, "precision": precision, "rate": rate(best), "bytes": bytes_moved(best), "flops": row_flops(dim)})
    return {"limits": limits, "rows": rows}


def bytes_moved(result):
    """Bytes to and from memory for a particle and step of APIC with a fluid, if every array is moved once a phase. Particles to grid reads the
    state but for the id; grid to particles reads it (but for the mass), and writes it. The arenas of the blocks are written, summed, and
    loaded again from a grid that was written: four times their nodes of four values, shared by a block's particles."""
    size = {"f32": 4, "f64": 8}[result["precision"]]
    state = result["bytes_per_particle"] - 4
    nodes, in_block = {3: (8**3, 4**3 * 8), 2: (12**2, 8**2 * 4)}[result["dimension"]]
    return 3 * state - 2 * size + 4 * nodes * 4 * size / in_block


def row_flops(dim):
    """Floating-point operations of the loops over stencil rows for a particle and step (lib/kernels/p2g.hpp and g2p.hpp; quadratic splines,
    APIC, gradient mls), on the values that are used: a row is three nodes of four values, a multiply-add is two operations. Weights, stress
    and updates are done for many particles at once, are fewer, and are left out."""
    values, rows = 3 * 4, 3
    if dim == 2:
        scatter = 3 + 1 + rows * 4           # the line with w and d of the last axis; its moment with d of the first; per row both added
        gather = rows * 4 + 3                # per row the sums with w and d; then the factors of the last axis
    else:
        scatter = 3 + 2 + rows + rows * (3 + rows * 4)
        gather = rows * (rows * 4 + 6) + 4
    along_the_row = (1 + dim) * 2 * 4        # value and gradient, three nodes added up
    return values * (scatter + gather) + along_the_row


def domain(s):
    """The same block in a domain ten times as long, wide and high."""
    rows = []
    for dim in (3, 2):
        base = scenes.variant_block(dim, scenes.SPLINE)
        size = {3: [10, 5, 4], 2: [12.8, 12.8]}[dim]
        larger = (*base[:2], {**base[2], "/domain/max": size})
        _, found = compare(s.rate_of(base), {"ten times as long, wide and high": s.rate_of(larger)}, 2 * s.rounds)
        small, large = s.bench(base), s.bench(larger)
        rows.append({"dimension": dim, **next(iter(found.values())),
                     "active_blocks": [small["active_blocks"], large["active_blocks"]], "peak_memory_bytes": [small["peak_memory_bytes"], large["peak_memory_bytes"]]})
    return {"rows": rows}


def runs(s):
    """What sorting, gauges, frames and checkpoints take of typical runs, all threads."""
    rows = []
    for name, (deck, assignments) in scenes.RUNS.items():
        if s.quick:
            assignments = {**assignments, "/time/end": assignments["/time/end"] / 5}
        with tempfile.TemporaryDirectory() as out:
            began = time.monotonic()
            summary = run_deck(s, deck, assignments, f"{out}/run", s.threads[-1]).run()
            wall = time.monotonic() - began
        rows.append({"name": name, "deck": deck, "assignments": assignments, "wall_seconds": wall,
                     **{key: summary[key] for key in ("particles", "steps", "seconds", "frames", "threads", "seconds_by_phase", "seconds_by_output")}})
        progress(f"{name}: {wall:.0f} s")
    return {"rows": rows}


def run_deck(s, deck, assignments, out, threads):
    """The results of a whole run."""
    sets = [word for pointer, value in assignments.items() for word in ("--set", f"{pointer}={json.dumps(value)}")]
    output_of([s.program, "run", scenes.INPUTS / deck, "-q", "-o", out, "--threads", threads, "--backend", "cpu", *sets], threads)
    return Results(out)


def automatic_step(s):
    """Steps and errors of the automatic and of the paper's fixed step, against a run with half the cell and a quarter of the automatic step."""
    deck, end = "dam_break_2d.json", {"/time/end": 0.05 if s.quick else 0.1}
    auto = {**end, "/time/step": "auto"}
    with tempfile.TemporaryDirectory() as out:
        fine = run_deck(s, deck, {**auto, "/time/cfl": 0.1, "/domain/cell_size": 0.002}, f"{out}/fine", 1)
        rows = []
        for name, assignments in (("fixed, 1e-5 s", end), ("automatic", auto)):
            results = run_deck(s, deck, assignments, f"{out}/{name[:5]}", 1)
            summary = results.run()
            rows.append({"name": name, "steps": summary["steps"], "cpu_seconds": summary["cpu_seconds"], "front": gauge_distance(results, fine, "front"),
                         "kinetic_energy": gauge_distance(results, fine, "energy", True)})
            progress(f"{name} step: {summary['steps']} steps")
    return {"rows": rows}


def gauge_distance(results, other, name, relative=False):
    """Root mean square difference of the first component of a gauge from another run's, over the latter's last value where `relative`."""
    series = [(time, value.reshape(len(time), -1)[:, 0]) for time, value in (run.gauge(name) for run in (results, other))]
    (time, own), (other_time, theirs) = series
    distance = np.sqrt(np.mean((np.interp(other_time, time, own) - theirs) ** 2))
    return float(distance / theirs[-1] if relative else distance)


def gradient(s):
    """Cost of a gradient over that of a plain run of the same steps, one thread and all."""
    rows = []
    for name, (deck, steps, assignments) in scenes.GRADIENTS.items():
        for threads in sorted({1, s.threads[-1]}):
            scene = (scenes.INPUTS / deck, round(steps * (0.4 if s.quick else 1)), assignments)
            results = [s.bench(scene, threads, more=["--gradient"]) for _ in range(3)]
            found = [r["gradient"] for r in results]
            rows.append({"name": name, "particles": results[0]["particles"], "steps": results[0]["steps"], "threads": threads,
                         "times_plain_run": statistics.median(r["times_plain_run"] for r in found),
                         **{key: min(r[key] for r in found) for key in ("forward_seconds", "reverse_seconds")}})
            progress(f"gradient, {name}, {threads} thread(s): {rows[-1]['times_plain_run']:.2f} plain runs")
    return {"rows": rows}


def portable(s):
    """A build for x86-64-v3 (AVX2, no AVX-512) over the usual one."""
    if not s.portable.is_file():
        return {"skipped": "no build in build-portable: JAXMPM_BUILD=build-portable JAXMPM_CMAKE=-DJAXMPM_ARCH=x86-64-v3 scripts/build jaxmpm"}
    rows = []
    for dim in (3, 2):
        for gradient_form in ("spline", "mls"):
            scene = scenes.variant_block(dim, {"/method/gradient": gradient_form})
            _, found = compare(s.rate_of(scene), {"x86-64-v3": lambda scene=scene: rate(bench(s.portable, scene))}, s.rounds)
            rows.append({"dimension": dim, "precision": scenes.BASE_PRECISION[dim], "gradient": gradient_form, **found["x86-64-v3"]})
            progress(f"x86-64-v3, {dim}D {gradient_form}: {rows[-1]['ratio']:.2f}")
    return {"rows": rows}


def progress(line):
    print(f"     {line}", flush=True)
