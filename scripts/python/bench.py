"""Measures part by part and keeps the figures in docs/performance/figures.json; called by scripts/bench."""
import argparse
import datetime
import json
import pathlib
import statistics

import bench_page
import bench_parts
from bench_runs import bench

PARTS = ("yardstick", "particles", "threads", "configurations", "phases", "roofline", "domain", "runs", "automatic_step", "gradient", "portable")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    for name in ("program", "yardsticks"):
        parser.add_argument(name, type=pathlib.Path)
    parser.add_argument("avx512", type=int)
    parser.add_argument("portable", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("parts", nargs="*", metavar="PART")
    options = parser.parse_intermixed_args()
    unknown = sorted(set(options.parts) - set(PARTS))
    if unknown:
        parser.error(f"no part {', '.join(unknown)}; there are {' '.join(PARTS)}")
    settings = bench_parts.Settings(options.program, options.yardsticks, bool(options.avx512), options.portable, options.quick)
    commit = bench(options.program, (bench_parts.scenes.BLOCKS[2], 10, {}))["git_commit"]
    figures = bench_page.read()
    for name in options.parts or PARTS:
        print(f"-- {name}", flush=True)
        settings.disturbance.clear()
        found = getattr(bench_parts, name)(settings)
        # Wall over processor time of single-threaded runs: how much of the processor other programs had.
        busy = statistics.median(settings.disturbance) if settings.disturbance else None
        figures[name] = {**found, "date": datetime.date.today().isoformat(), "commit": commit, "machine": bench_page.machine(), "busy": busy, "quick": options.quick}
        bench_page.write(figures)  # part by part: nothing is lost when it is stopped
    bench_page.make(figures)


if __name__ == "__main__":
    main()
