"""Pressure on the wall that a dam break runs against (Buchner 2002): arrival, plateau and second peak."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, first_crossing, np, plt, reference  # noqa: E402

DEPTH, FAR = 0.6, 3.22      # H, place of the wall, m
WEIGHT = 1000 * GRAVITY * DEPTH
RISE = 0.3                  # P at which the water has come
IMPACT = (2.6, 2.9)         # T of the first peak
PLATEAU = (2.9, 5.4)        # T between it and the second
MEAN = 0.05                 # T over which the computed pressure is averaged for peaks: 12 ms


def smooth(clock, pressure, width):
    """Running mean over `width` in T."""
    count = max(1, int(round(width / (clock[1] - clock[0]))))
    return np.convolve(pressure, np.ones(count) / count, mode="same")


def mean_over(clock, pressure, span):
    fine = np.linspace(*span, 2000)
    return np.interp(fine, clock, pressure).mean()


def largest_after(clock, pressure):
    """(P, T) of the peak after the plateau."""
    late = clock > PLATEAU[1]
    return pressure[late].max(), clock[late][pressure[late].argmax()]


def judge(check, label, computed, truth, judged):
    """The figures of one run; one that is not judged is told in a note."""
    clock, pressure, calm = computed
    came, came_truth = first_crossing(clock, calm, RISE), first_crossing(*truth, RISE)
    impact, impact_truth = mean_over(clock, pressure, IMPACT), mean_over(*truth, IMPACT)
    level, level_truth = mean_over(clock, pressure, PLATEAU), mean_over(*truth, PLATEAU)
    (peak, when), (peak_truth, when_truth) = largest_after(clock, calm), largest_after(*truth)
    if not judged:
        check.note(f"{label}: comes at T = {came:.3f}, impact {impact:.3f}, plateau {level:.3f}, second peak {peak:.2f} at T = {when:.2f}")
        return
    check.figure("arrival", 100 * abs(came / came_truth - 1), label, f"T = {came:.3f}", f"T = {came_truth:.3f}")
    check.figure("impact", impact / impact_truth, label, impact, impact_truth)
    check.figure("plateau", 100 * abs(level / level_truth - 1), label, level, level_truth)
    check.figure("second_peak", peak / peak_truth, label, peak, peak_truth)
    check.figure("second_time", 100 * abs(when / when_truth - 1), label, f"T = {when:.2f}", f"T = {when_truth:.2f}")


def main():
    check = Check(__doc__, __file__)
    table = reference("buchner2002_pressure.csv")
    order = np.argsort(table["T"], kind="stable")  # the digits follow the drawn curve, which is not strictly ordered
    measured_clock, measured = table["T"][order], table["P"][order]
    runs = ((0.02, 4),) if check.quick else ((0.02, 4), (0.01, 4), (0.02, 16))
    figure, axes = plt.subplots(figsize=(8, 3.5), layout="constrained")
    for cell, count in runs:
        settings = {"/domain/cell_size": cell, "/bodies/0/particles_per_cell": count, "/gauges/wall/at": f"[{FAR - 0.5 * cell},{0.2 * DEPTH}]"}
        results = check.run("tank.json", f"cell_{cell}_{count}", settings)
        time, pressure = results.gauge("wall", masked=False)
        clock, pressure = time * np.sqrt(GRAVITY / DEPTH), np.ravel(pressure) / WEIGHT
        calm = smooth(clock, pressure, MEAN)
        label = f"cell {1000 * cell:g} mm, {count} particles in it"
        judge(check, label, (clock, pressure, calm), (measured_clock, measured), judged=count == 4)
        axes.plot(clock, calm, lw=0.9, label=f"jaxmpm, {label}")
    axes.plot(measured_clock, measured, "ko-", ms=3, lw=0.6, label="Buchner 2002")
    axes.set(xlabel="t √(g/H)", ylabel="p / ρgH", xlim=(2, 7.3), ylim=(-0.1, 1.3)), axes.legend(fontsize=8)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
