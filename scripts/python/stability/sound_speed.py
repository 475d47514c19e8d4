"""What a fluid's sound speed costs and buys: a dam break with c from 2 to 80 times the speed √(2gH)."""
from study import GRAVITY, Study, body, box, deck, np, plt, water

HEIGHT, CELLS = 0.2, 20
FALL = np.sqrt(2 * GRAVITY * HEIGHT)
RATIOS = (2, 3, 5, 7, 10, 15, 20, 40, 80)


def dam(ratio):
    """A column as high as wide spreads; its front by depth of one cell."""
    cell = HEIGHT / CELLS
    gauges = {"front": {"kind": "front", "body": "body", "axis": "x", "quantile": 0.9}, "energy": {"kind": "energy"}}
    pool = body("m", box([0, 0], [HEIGHT, HEIGHT]), initial_stress="hydrostatic")
    end = 1.5 * np.sqrt(HEIGHT / GRAVITY)
    return deck([5 * HEIGHT, 1.5 * HEIGHT], cell, {"m": water(ratio * FALL, tension_limit=0)}, [pool], end, gravity=[0, -GRAVITY], gauges=gauges, samples=30, frames=10, fields=["density"])


def main():
    study = Study(
        __file__, "Sound speed against the speed of the flow",
        "a weakly compressible fluid is compressed by (v/c)²; below about ten times the speed of the flow that is seen, above it only the number of steps grows.",
    )  # fmt: skip
    fronts, rows = {}, []
    for ratio in RATIOS:
        run = study.run(dam(ratio))
        time, front = run.results.gauge("front")
        squeeze = max(np.quantile(frame.field("density"), 0.99) / 1000 - 1 for frame in run.results.frames)
        fronts[ratio] = front
        rows.append([ratio, run.summary["steps"], squeeze])
    off = {ratio: np.sqrt(np.mean((front - fronts[RATIOS[-1]]) ** 2)) / HEIGHT for ratio, front in fronts.items()}
    for row in rows:
        row.append(100 * off[row[0]])
    study.data = {"ratio": RATIOS, "steps": [r[1] for r in rows], "compression": [r[2] for r in rows], "front_error_percent": [r[3] for r in rows]}
    study.table("Dam break of a square column, 20 cells high, to 1.5 √(H/g)", ["c/√(2gH)", "steps", "largest compression", f"front against c = {RATIOS[-1]} √(2gH), rms, % of H"], [[r[0], r[1], r[2], r[3] if r[0] != RATIOS[-1] else "–"] for r in rows])
    figure, axes = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
    axes[0].loglog(RATIOS[:-1], [off[r] for r in RATIOS[:-1]], "o-", label="front, rms / H"), axes[0].loglog(RATIOS, study.data["compression"], "s-", label="largest compression")
    axes[0].loglog(RATIOS, [0.5 / r**2 for r in RATIOS], "k--", lw=0.8, label="gH/c²"), axes[0].legend(fontsize=8), axes[0].set(xlabel="c / √(2gH)")
    axes[1].loglog(RATIOS, study.data["steps"], "o-"), axes[1].set(xlabel="c / √(2gH)", ylabel="steps")
    study.draw(figure)
    ten, steps = RATIOS.index(10), study.data["steps"]
    study.finish(
        f"c = 10 √(2gH): front off by {100 * off[10]:.2g} % of H, compression {study.data['compression'][ten]:.2g}", "advised",
        f"At ten times the speed of free fall the front is off by {100 * off[10]:.2g} % of the column's height and the water compressed by {100 * study.data['compression'][ten]:.2g} % at most; at three times by "
        f"{100 * off[3]:.2g} % and {100 * study.data['compression'][RATIOS.index(3)]:.2g} %. Forty times costs {steps[RATIOS.index(40)] / steps[ten]:.1f} times as many steps as ten and moves the front by {100 * abs(off[40] - off[10]):.1g} % of H more.",
    )  # fmt: skip
