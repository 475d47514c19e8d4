"""Dam break against a box (SPHERIC 2, Kleefsman et al. 2005): water heights at two probes over 2 s, by cell size and transfer; pressures on the box are drawn."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, first_crossing, np, plt, reference  # noqa: E402

ARRIVAL = 0.05           # m: the water has come when it stands 5 cm deep
RETURN = 1.4             # s: before the wave that comes back from the wall behind the box is at x = 0.992 m
END, FACE = 3.22, 0.8245  # right end of the tank and face of the box that looks at the water, m
DECK = 50                # cells a metre of the deck as it is


def settings(count):
    """`count` cells a metre. The tank is a whole number of cells long: less than a cell is put on or taken off behind the box, far from the
    water, whose place and depth (0.55 m is 1.1 times `count` layers of particles) stay. The pressures are read half a cell in front of the box."""
    cell = 1 / count
    places = {f"/gauges/P{i + 1}/at": f"[{FACE + 0.5 * cell},0.471,{z}]" for i, z in enumerate((0.021, 0.061, 0.101, 0.141))}
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


def judge(check, results, measured):
    """The bands, on the finest run."""
    end = results.frames[-1].time
    for probe in ("0.992", "2.638"):
        check.figure(f"height_{probe}", 100 * mean_error(results, measured, probe, 0, end), f"0 … {end:.2f} s")
    came, truth = first_crossing(*height(results, "0.992"), ARRIVAL), first_crossing(measured["t_s"], measured["h_x0.992_m"], ARRIVAL)
    check.figure("arrival", 100 * abs(came / truth - 1), "", f"{came:.3f} s", f"{truth:.3f} s")


def tell(check, name, results, measured):
    """How the error divides at the return of the wave, for one run of the study."""
    parts = [100 * mean_error(results, measured, "0.992", *span) for span in ((0, RETURN), (RETURN, 2))]
    far = 100 * mean_error(results, measured, "2.638", 0, 2)
    peaks = ", ".join(f"{np.ravel(results.gauge(f'P{i}')[1]).max() / 1e3:.1f}" for i in range(1, 5))
    came = first_crossing(*height(results, "0.992"), ARRIVAL)
    check.note(f"{name}: x = 0.992 m {parts[0]:.2f} cm to {RETURN} s, {parts[1]:.2f} cm after; x = 2.638 m {far:.2f} cm; arrival {came:.3f} s; peaks of P1 … P4 {peaks} kPa")


def draw(check, runs, measured):
    pressures = reference("spheric2_kleefsman2005_pressures.csv")
    end = max(results.frames[-1].time for results in runs.values())
    figure, axes = plt.subplots(3, 2, figsize=(11, 8), sharex=True, layout="constrained")
    for at, probe in zip(axes.flat, ("0.992", "2.638")):
        at.plot(measured["t_s"], measured[f"h_x{probe}_m"], "k", lw=1, label="experiment")
        for name, results in runs.items():
            at.plot(*height(results, probe), lw=1, label=name)
        at.set(title=f"water height, x = {probe} m", ylabel="m")
    for at, gauge in zip(axes.flat[2:], ("P1", "P2", "P3", "P4")):
        at.plot(pressures["t_s"], pressures[f"{gauge}_Pa"], "k", lw=0.8)
        time, value = next(iter(runs.values())).gauge(gauge)
        at.plot(time, np.ravel(value), "C0", lw=0.8)
        at.set(title=f"pressure {gauge}", ylabel="Pa", xlim=(0, end))
    axes[0, 0].legend(fontsize=7)
    check.save(figure)


def main():
    check = Check(__doc__, __file__)
    measured = reference("spheric2_kleefsman2005_heights.csv")
    if check.quick:
        runs = {"1/20 m": check.run("dam_break_obstacle.json", "box", {**settings(20), "/time/end": 0.6})}
    else:
        runs = {f"1/{DECK} m": check.run("dam_break_obstacle.json", "box")}
        for count in (40, 30, 20):
            runs[f"1/{count} m"] = check.run("dam_break_obstacle.json", f"cells_{count}", settings(count))
        for transfer in ("flip", "tpic"):
            runs[f"1/30 m, {transfer}"] = check.run("dam_break_obstacle.json", f"cells_30_{transfer}", {**settings(30), "/method/transfer": transfer})
        for name, results in runs.items():
            tell(check, name, results, measured)
    judge(check, next(iter(runs.values())), measured)
    draw(check, runs, measured)
    check.finish()


if __name__ == "__main__":
    main()
