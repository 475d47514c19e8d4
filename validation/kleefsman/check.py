"""Dam break against a box (SPHERIC 2, Kleefsman et al. 2005): water heights at two probes and pressures on the box over 2 s."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, first_crossing, np, plt, reference  # noqa: E402

ARRIVAL = 0.05           # m: the water has come when it stands 5 cm deep
RETURN = 1.4             # s: before the wave that comes back from the wall behind the box is at x = 0.992 m
END, FACE, TOP = 3.22, 0.8245, 0.161  # right end of the tank, face of the box that looks at the water, its top, m
FRONT, ABOVE = ("P1", "P2", "P3", "P4"), ("P5", "P6", "P7", "P8")  # gauges on that face, upwards, and on the top, away from it
IMPACT, STREAM = (0.38, 0.6), (0.6, 1.3)  # s: the blow, and the flow around the box until the wave comes back


def settings(count):
    """`count` cells a metre. The tank is a whole number of cells long: less than a cell is put on or taken off behind the box, far from the
    water, whose place and depth (0.55 m is 1.1 times `count` layers of particles) stay. The pressures are read half a cell in front of the box."""
    cell = 1 / count
    places = {f"/gauges/P{i + 1}/at": f"[{FACE + 0.5 * cell},0.471,{z}]" for i, z in enumerate((0.021, 0.061, 0.101, 0.141))}
    places |= {f"/gauges/P{i + 5}/at": f"[{x},0.471,{TOP + 0.5 * cell}]" for i, x in enumerate((0.8035, 0.7635, 0.7235, 0.6835))}
    return {"/domain/cell_size": cell, "/domain/min": f"[{END - round(END * count) * cell},0,0]", "/domain/max": f"[{END},1,1]", **places}


def height(results, probe):
    """(time, height) of a probe, 0 where it stands dry."""
    time, value = results.gauge(f"height_{probe}", masked=False)
    return time, np.nan_to_num(np.ravel(value))


def mean_error(results, measured, probe, start, end):
    """Mean |height − measured| of a probe over start … end, m."""
    time = measured["t_s"]
    exposed = (time >= start) & (time <= end)
    return np.abs(np.interp(time[exposed], *height(results, probe)) - measured[f"h_x{probe}_m"][exposed]).mean()


def pressure(results, gauge):
    """(time, pressure) of a gauge, 0 where it stands dry."""
    time, value = results.gauge(gauge, masked=False)
    return time, np.nan_to_num(np.ravel(value))


def mean_over(time, values, span):
    fine = np.linspace(*span, 1000)
    return np.interp(fine, time, values).mean()


def judge_pressures(check, results, truth):
    """Peaks and means of the blow on the face, and the means of what follows on face and top."""
    end = results.frames[-1].time
    clock = truth["t_s"]
    blow = (clock >= IMPACT[0]) & (clock <= IMPACT[1])
    for gauge in FRONT:
        time, found = pressure(results, gauge)
        peak, peak_truth = found[(time >= IMPACT[0]) & (time <= IMPACT[1])].max(), truth[f"{gauge}_Pa"][blow].max()
        check.figure("peak", peak / peak_truth, gauge, f"{peak / 1e3:.1f} kPa", f"{peak_truth / 1e3:.1f} kPa")
    face = [np.mean([mean_over(*series(gauge), IMPACT) for gauge in FRONT]) for series in (lambda g: pressure(results, g), lambda g: (clock, truth[f"{g}_Pa"]))]
    check.figure("blow", face[0] / face[1], f"{IMPACT[0]} … {IMPACT[1]} s", f"{face[0] / 1e3:.2f} kPa", f"{face[1] / 1e3:.2f} kPa")
    if end >= STREAM[1]:
        for gauge in FRONT + ABOVE:
            mean, mean_truth = mean_over(*pressure(results, gauge), STREAM), mean_over(clock, truth[f"{gauge}_Pa"], STREAM)
            check.figure("stream_face" if gauge in FRONT else "stream_top", (mean - mean_truth) / 1e3, f"{gauge}, {STREAM[0]} … {STREAM[1]} s", f"{mean / 1e3:.2f} kPa", f"{mean_truth / 1e3:.2f} kPa")


def judge(check, results, measured):
    """The bands, on the finest run."""
    end = results.frames[-1].time
    for probe in ("0.992", "2.638"):
        check.figure(f"height_{probe}", 100 * mean_error(results, measured, probe, 0, end), f"0 … {end:.2f} s")
    came, truth = first_crossing(*height(results, "0.992"), ARRIVAL), first_crossing(measured["t_s"], measured["h_x0.992_m"], ARRIVAL)
    check.figure("arrival", 100 * abs(came / truth - 1), "", f"{came:.3f} s", f"{truth:.3f} s")


def tell(check, results, measured):
    """How the error divides at the return of the wave."""
    parts = [100 * mean_error(results, measured, "0.992", *span) for span in ((0, RETURN), (RETURN, 2))]
    far = 100 * mean_error(results, measured, "2.638", 0, 2)
    check.note(f"mean error at x = 0.992 m: {parts[0]:.2f} cm to {RETURN} s, {parts[1]:.2f} cm after; at x = 2.638 m {far:.2f} cm")


def draw(check, results, measured, truth):
    end = results.frames[-1].time
    figure, axes = plt.subplots(3, 2, figsize=(9, 7), sharex=True, layout="constrained")
    for at, probe in zip(axes.flat, ("0.992", "2.638")):
        at.plot(measured["t_s"], measured[f"h_x{probe}_m"], "k", lw=1, label="experiment")
        at.plot(*height(results, probe), "C0", lw=1, label="jaxmpm")
        at.set(title=f"water height, x = {probe} m", ylabel="m")
    for at, gauge in zip(axes.flat[2:], ("P1", "P2", "P4", "P6")):
        at.plot(truth["t_s"], truth[f"{gauge}_Pa"] / 1e3, "k", lw=0.8)
        time, value = pressure(results, gauge)
        at.plot(time, value / 1e3, "C0", lw=0.6)
        at.set(title=f"pressure {gauge}", ylabel="kPa", xlim=(0, end))
    axes[0, 0].legend(fontsize=7), axes[-1, 0].set_xlabel("time  s"), axes[-1, 1].set_xlabel("time  s")
    check.save(figure)


def main():
    check = Check(__doc__, __file__)
    measured, truth = (reference(f"spheric2_kleefsman2005_{what}.csv") for what in ("heights", "pressures"))
    results = check.run("dam_break_obstacle.json", "box", {**settings(20), "/time/end": 0.6} if check.quick else {})
    if not check.quick:
        tell(check, results, measured)
    judge(check, results, measured)
    judge_pressures(check, results, truth)
    draw(check, results, measured, truth)
    check.finish()


if __name__ == "__main__":
    main()
