"""Dam break against a box (SPHERIC 2, Kleefsman et al. 2005): water heights at two probes over 2 s; pressures on the box are drawn."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, first_crossing, np, plt, reference  # noqa: E402

ARRIVAL = 0.05  # m: the water has come when it stands 5 cm deep


def height(results, probe):
    """(time, height) of a probe, 0 where it stands dry."""
    time, value = results.gauge(f"height_{probe}", masked=False)
    return time, np.nan_to_num(np.ravel(value))


def main():
    check = Check(__doc__, __file__)
    measured = reference("spheric2_kleefsman2005_heights.csv")
    pressures = reference("spheric2_kleefsman2005_pressures.csv")
    # 3.22 m and 1 m have no common cell between 0.02 and 0.05 m but with a tank longer by 3 cm
    coarse = {"/domain/cell_size": 0.05, "/domain/max": "[3.25,1,1]", "/bodies/0/shape/box/max": "[3.25,1,0.55]", "/time/end": 0.6} if check.quick else {}
    results = check.run("dam_break_obstacle.json", "box", coarse)
    end = results.frames[-1].time
    exposed = measured["t_s"] <= end
    figure, axes = plt.subplots(3, 2, figsize=(11, 8), sharex=True, layout="constrained")
    for at, probe in zip(axes.flat, ("0.992", "2.638")):
        time, level = height(results, probe)
        truth = measured[f"h_x{probe}_m"]
        error = np.abs(np.interp(measured["t_s"][exposed], time, level) - truth[exposed]).mean()
        check.band(f"mean error of the height at x = {probe} m, 0 … {end:.2f} s", 100 * error, 5 if check.quick else 3, "cm")
        at.plot(measured["t_s"][exposed], truth[exposed], "k", lw=1, label="experiment")
        at.plot(time, level, "C0", lw=1, label="jaxmpm")
        at.set(title=f"water height, x = {probe} m", ylabel="m")
    time, level = height(results, "0.992")
    came, truth_came = first_crossing(time, level, ARRIVAL), first_crossing(measured["t_s"], measured["h_x0.992_m"], ARRIVAL)
    check.note(f"arrival at x = 0.992 m: {came:.3f} s, measured {truth_came:.3f} s")
    check.band("arrival at x = 0.992 m", 100 * abs(came / truth_came - 1), 15 if check.quick else 5, "%")
    for at, gauge in zip(axes.flat[2:], ("P1", "P2", "P3", "P4")):
        time, value = results.gauge(gauge)
        at.plot(pressures["t_s"], pressures[f"{gauge}_Pa"], "k", lw=0.8)
        at.plot(time, np.ravel(value), "C0", lw=0.8)
        at.set(title=f"pressure {gauge}", ylabel="Pa", xlim=(0, end))
    axes[0, 0].legend(fontsize=8)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
