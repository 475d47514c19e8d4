"""Collapse of a water column against Martin & Moyce (1952): times at which the front passes the measured places, and the height at the wall."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, first_crossing, np, plt, reference  # noqa: E402

WIDTH = 0.05715  # a, m; the column is 2a high
ORIGIN = 1.44    # Z at which both clocks are set, because the membrane lets the front go gradually


def front(results, gauge="front"):
    """T = t √(2g/a) and Z = x / a of a front gauge."""
    time, place = results.gauge(gauge)
    return time * np.sqrt(2 * GRAVITY / WIDTH), np.ravel(place) / WIDTH


def passages(results, places, gauge="front"):
    """Times T of passing `places`, counted so that ORIGIN is passed when the experiment's front passes it."""
    clock, front_place = front(results, gauge)
    return np.array([first_crossing(clock, front_place, z) for z in places]) - first_crossing(clock, front_place, ORIGIN)


def main():
    check = Check(__doc__, __file__)
    table = reference("mm1952_n2eq2_front_table2_a2.25in.csv")
    heights = reference("mm1952_n2eq2_height_table6_a2.25in.csv")
    start = np.interp(ORIGIN, table["Z"], table["T"])
    later = table["Z"] > ORIGIN
    places, measured = table["Z"][later], table["T"][later]
    cells = (20,) if check.quick else (20, 40, 80)
    figure, axes = plt.subplots(1, 2, figsize=(10, 4), layout="constrained")
    for count in cells:
        results = check.run("water_column.json", f"a_{count}", {"/domain/cell_size": WIDTH / count})
        for gauge in ("front", "front_depth"):
            since = passages(results, places, gauge)
            of_elapsed = np.abs(since - (measured - start)) / (measured - start)
            of_time = np.abs(since + start - measured) / measured
            check.note(f"a/{count}, gauge {gauge}: largest deviation {100 * of_elapsed.max():.2f} % of the time since Z = {ORIGIN}, {100 * of_time.max():.2f} % of the time since release")
            if gauge == "front":
                worst = of_elapsed.argmax()
                check.figure("front", 100 * of_elapsed.max(), f"a/{count}, at Z = {places[worst]:g}", f"T = {since[worst]:.3f}", f"T = {measured[worst] - start:.3f}")
        clock, place = front(results)
        axes[0].plot(clock - first_crossing(clock, place, ORIGIN) + start, place, lw=1.2, label=f"a/{count}")
        time, height = results.gauge("height")
        axes[1].plot(time * np.sqrt(GRAVITY / WIDTH), np.ravel(height) / (2 * WIDTH), lw=1.2, label=f"a/{count}")
    axes[0].plot(table["T"], table["Z"], "ko", ms=4, label="Martin & Moyce 1952")
    axes[1].plot(heights["tau"], heights["H"], "ko", ms=4)
    axes[0].set(xlabel="t √(2g/a)", ylabel="front / a", xlim=(0, 4), ylim=(1, 5)), axes[1].set(xlabel="t √(g/a)", ylabel="height / 2a", xlim=(0, 3.5))
    axes[0].legend(fontsize=8)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
