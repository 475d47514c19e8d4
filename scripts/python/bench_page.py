"""Tables and plots of docs/performance/figures.json: the generated part of docs/performance.md. `python bench_page.py` makes them anew."""
import json
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER, PAGE = ROOT / "docs" / "performance", ROOT / "docs" / "performance.md"
BEGIN, END = "<!-- made by scripts/bench: begin -->", "<!-- made by scripts/bench: end -->"
WHY = {
    "precision f64": "twice the bytes, half the lanes",
    "precision f32": "half the bytes, twice the lanes; in 2D rows of either take one pack, and walls and sums of small blocks do not get cheaper",
    "transfer pic": "no affine field to read, write and transfer",
    "transfer flip": "a second plane of nodes (Δv), but no affine field",
    "transfer tpic": "the affine field comes from the sums that the spline gradient needs anyway",
    "basis linear": "8 nodes instead of 27, 4 instead of 9 in 2D",
    "basis cubic": "64 nodes, 16 in 2D, whose rows fill the vectors better",
    "newtonian, viscous": "carries a stress",
    "linear_elastic": "stress history, rotation",
    "neo_hookean": "a deformation gradient and its determinant",
    "drucker_prager": "return mapping",
    "gradient spline": "another set of moments",
}
TYPE = {"f32": "single", "f64": "double"}


def read():
    data = FOLDER / "figures.json"
    return json.loads(data.read_text(encoding="utf-8")) if data.is_file() else {}


def write(figures):
    FOLDER.mkdir(exist_ok=True)
    (FOLDER / "figures.json").write_text(json.dumps(figures, indent=1) + "\n", encoding="utf-8")


def machine():
    names = [line.split(":")[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    return f"{len(names)} processors of {names[0]}" if names else "an unknown processor"


def table(head, rows):
    return ["| " + " | ".join(head) + " |", "|" + "---|" * len(head), *("| " + " | ".join(map(str, row)) + " |" for row in rows), ""]


def million(rate):
    return f"{rate / 1e6:.1f} M"


def yardstick(part):
    rows = [(r["scene"], r["threads"], million(r["yardstick"]), million(r["jaxmpm"]), f"{r['ratio']:.2f}") for r in part["rows"]]
    return ["**Against the yardstick**, the bare cost of a step with no features (scripts/yardstick), in pairs; the ratio is the median's.", "",
            *table(("scene", "threads", "yardstick", "jaxmpm, particle-steps/s", "ratio"), rows)]


def particles(part):
    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    for dim, style in ((3, "-"), (2, "--")):
        for threads in sorted({r["threads"] for r in part["rows"]}):
            own = [r for r in part["rows"] if r["dimension"] == dim and r["threads"] == threads]
            axes.semilogx([r["particles"] for r in own], [r["rate"] / 1e6 for r in own], "o" + style, ms=4, label=f"{dim}D {own[0]['precision']}, {threads} thread{'s' * (threads > 1)}")
    axes.set(xlabel="particles", ylabel="million particle-steps/s", ylim=(0, None)), axes.legend(fontsize=8), axes.grid(alpha=0.3)
    save(figure, "particles.png")
    rows = [(f"{r['dimension']}D, {r['precision']}", r["threads"], f"{r['particles']:,}", r["steps"], million(r["rate"]), f"{r['peak_memory_bytes'] / 2**20:.0f} MiB") for r in part["rows"]]
    return ["**Number of particles** (a cube or square of fluid; gradient spline):", "", "![Rate against the number of particles](performance/particles.png)", "",
            *table(("scene", "threads", "particles", "steps", "particle-steps/s", "peak memory"), rows)]


def threads(part):
    rows = []
    for r in part["rows"]:
        one = next(o for o in part["rows"] if o["dimension"] == r["dimension"] and o["threads"] == 1)
        rows.append((f"{r['dimension']}D, {r['precision']}, {r['particles']:,}", r["threads"], million(r["rate"]), f"{r['rate'] / one['rate']:.2f}"))
    return ["**Threads** (by the clock):", "", *table(("scene", "threads", "particle-steps/s", "times one thread"), rows)]


def configurations(part):
    lines = ["**Choices**, as ratios to the base beside them in the same run, one thread (low … high over the rounds):", ""]
    for group in part["groups"]:
        rows = [(name, f"{v['ratio']:.2f}", f"{v['low']:.2f} … {v['high']:.2f}", f"{v['bytes_per_particle']:.0f}", WHY.get(name, "")) for name, v in group["variants"].items()]
        lines += [f"{group['dimension']}D, {TYPE[group['precision']]} precision, APIC, quadratic splines, inviscid fluid, {group['base']}: {million(group['rate'])} particle-steps/s.", "",
                  *table(("with", "rate over base", "", "bytes a particle", "why"), rows)]
    return lines


def phases(part):
    rows = []
    for r in part["rows"]:
        whole = sum(r["seconds_by_phase"].values())
        rows.append((f"{r['dimension']}D, {r['precision']}, {r['gradient']}", *(f"{100 * r['seconds_by_phase'][k] / whole:.0f} %" for k in ("p2g", "grid", "g2p", "sort"))))
    return ["**Time by phase**, one thread:", "", *table(("scene", "particles to grid", "grid", "grid to particles", "sort"), rows)]


def roofline(part):
    limits, rows = part["limits"], []
    figure, axes = plt.subplots(figsize=(6, 3.6), layout="constrained")
    intensity = [2**k for k in range(-3, 8)]
    for name, style in (("f32", "-"), ("f64", "--")):
        axes.loglog(intensity, [min(limits[f"flops_{name}"], i * limits["bytes_per_second"]) / 1e9 for i in intensity], "k" + style, lw=1, label=f"this machine, {name}")
    for r in part["rows"]:
        x, y = r["flops"] / r["bytes"], r["flops"] * r["rate"] / 1e9
        axes.loglog(x, y, "o", label=f"{r['dimension']}D, {r['precision']}")
        rows.append((f"{r['dimension']}D, {r['precision']}", million(r["rate"]), f"{r['bytes']:.0f}", f"{r['flops']:.0f}", f"{100 * r['bytes'] * r['rate'] / limits['bytes_per_second']:.0f} %",
                     f"{100 * r['flops'] * r['rate'] / limits['flops_' + r['precision']]:.0f} %"))
    axes.set(xlabel="operations per byte", ylabel="10⁹ operations/s"), axes.legend(fontsize=8), axes.grid(alpha=0.3, which="both")
    save(figure, "roofline.png")
    return [f"**Roofline**, one thread: this machine moves {limits['bytes_per_second'] / 1e9:.1f} GB/s and does {limits['flops_f32'] / 1e9:.0f} (single) and {limits['flops_f64'] / 1e9:.0f} (double) 10⁹ operations/s, measured in the same run (scripts/yardstick/limits.cpp). "
            "Bytes are those of the particles' state and the arenas, each moved once a phase; operations are those of the loops over stencil rows (scripts/python/bench_parts.py).", "",
            "![Roofline](performance/roofline.png)", "",
            *table(("scene", "particle-steps/s", "bytes a particle-step", "operations", "of the bandwidth", "of the operations"), rows)]


def domain(part):
    rows = [(f"{r['dimension']}D", f"{1 / r['ratio']:.3f}", f"{r['active_blocks'][0]} and {r['active_blocks'][1]}", " and ".join(f"{b / 2**20:.0f} MiB" for b in r["peak_memory_bytes"])) for r in part["rows"]]
    return ["**Empty domain**: the same fluid in a domain ten times as long, wide and high.", "", *table(("scene", "time over that of the small domain", "active blocks", "peak memory"), rows)]


def runs(part):
    rows = []
    for r in part["rows"]:
        share = {name: seconds / r["wall_seconds"] for name, seconds in {"sort": r["seconds_by_phase"]["sort"], **r["seconds_by_output"]}.items()}
        share["beside"] = share.get("beside", 0) / r["threads"]  # figures from before it was counted lack it
        rows.append((r["name"], f"{r['particles']:,}", r["steps"], r["frames"], f"{r['wall_seconds']:.1f}",
                     *(f"{100 * share[k]:.1f} %" for k in ("sort", "gauges", "frames", "checkpoints", "beside")), f"{100 * sum(share.values()):.1f} %"))
    return ["**Sorting and output** of typical runs, of the whole call's wall time, all threads. Frames and checkpoints are what the steps wait for; "
            "what is written beside the steps takes one of the threads' processors, and counts as that part of them all:", "",
            *table(("run", "particles", "steps", "frames", "seconds", "sort", "gauges", "frames", "checkpoints", "written beside", "together"), rows)]


def automatic_step(part):
    rows = [(r["name"], r["steps"], f"{r['cpu_seconds']:.2f}", f"{1000 * r['front']:.2g} mm", f"{100 * r['kinetic_energy']:.2g} %") for r in part["rows"]]
    fixed, auto = part["rows"]
    return [f"**The automatic step** in the first part of `inputs/dam_break_2d.json`, where Du & He 2025 take 1e-5 s: {fixed['steps'] / auto['steps']:.1f} times fewer steps. Errors are root mean squares over time against a run with half the cell and a quarter of the automatic step.", "",
            *table(("step", "steps", "seconds, one thread", "front", "kinetic energy"), rows)]


def gradient(part):
    rows = [(r["name"], f"{r['particles']:,}", r["steps"], r["threads"], f"{r['forward_seconds']:.2f}", f"{r['reverse_seconds']:.2f}", f"{r['times_plain_run']:.2f}") for r in part["rows"]]
    return ["**Gradients** (decks of inputs/, all snapshots kept; the second gradient of two):", "",
            *table(("scene", "particles", "steps", "threads", "forward, s", "reverse, s", "together over a plain run"), rows)]


def portable(part):
    rows = [(f"{r['dimension']}D, {r['precision']}, {r['gradient']}", million(r["rate"]), f"{r['ratio']:.2f}") for r in part["rows"]]
    return ["**x86-64-v3** (AVX2, no AVX-512) over the usual build on this machine, one thread:", "", *table(("scene", "particle-steps/s", "ratio"), rows)]


def save(figure, name):
    figure.savefig(FOLDER / name, dpi=90)
    plt.close(figure)


def section(figures):
    lines = [BEGIN, "## Measured by scripts/bench", ""]
    for name, make_lines in ((f.__name__, f) for f in (yardstick, particles, threads, configurations, phases, roofline, domain, runs, automatic_step, gradient, portable)):
        part = figures.get(name)
        if part is None:
            continue
        if "skipped" in part:
            lines += [f"**{name}**: skipped, {part['skipped']}.", ""]
            continue
        lines += make_lines(part)
        busy = f"; other programs had {100 * (1 - 1 / part['busy']):.0f} % of its processor (ratios and processor times hold all the same)" if part["busy"] and part["busy"] > 1.05 else ""
        lines += [f"*{part['machine']}, {part['date']}, commit {part['commit'][:7]}{busy}.*", ""]
    return lines + [END]


def make(figures):
    page = PAGE.read_text(encoding="utf-8")
    before, after = (page.split(BEGIN)[0], page.split(END)[1]) if BEGIN in page else (page.rstrip("\n") + "\n\n", "\n")
    PAGE.write_text(before + "\n".join(section(figures)) + after, encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    make(read())
