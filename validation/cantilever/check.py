"""A compliant cantilever let go under gravity: its tip against the curves of Sadeghirad, Brannon & Burghardt (2011)."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt, reference  # noqa: E402

CORNER = np.array([4.0, 0.0])  # lower right corner, whose drop is followed


def tip(results):
    """(time, vertical displacement) of the corner, from the displacement and its gradient at the four particles next to it."""
    start = results.frames[0].field("position")
    near = np.argsort(np.linalg.norm(start - CORNER, axis=1))[:4]
    plane = np.linalg.lstsq(np.c_[np.ones(4), start[near] - CORNER], np.array([f.field("position")[near, 1] - start[near, 1] for f in results.frames]).T, rcond=None)[0]
    return np.array([frame.time for frame in results.frames]), plane[0]


def mean_difference(time, drop, table):
    """Mean |difference| of two curves over the time that both know, m."""
    inside = table["t_s"] <= time[-1]
    return np.abs(np.interp(table["t_s"][inside], time, drop) - table["uy_tip_m"][inside]).mean()


def main():
    check = Check(__doc__, __file__)
    fem, cpdi = reference("cantilever_gravity_tip_fem.csv"), reference("cantilever_gravity_tip_cpdi.csv")
    truth = fem["uy_tip_m"].argmin()
    check.note(f"the two references differ by {mean_difference(cpdi['t_s'], cpdi['uy_tip_m'], fem):.3f} m on average")
    runs = [("apic", 0.25)] if check.quick else [("apic", 0.25), ("apic", 0.125), ("flip", 0.125)]
    figure, axes = plt.subplots(figsize=(7, 4), layout="constrained")
    for transfer, cell in runs:
        results = check.run("beam.json", f"{transfer}_{cell}", {"/method/transfer": transfer, "/domain/cell_size": cell})
        time, drop = tip(results)
        low, label = drop.argmin(), f"{transfer}, cell {cell} m"
        first = drop[time < 1.3].argmin()
        check.figure("drop", 100 * abs(drop[first] / fem["uy_tip_m"][truth] - 1), label, f"{-drop[first]:.3f} m", f"{-fem['uy_tip_m'][truth]:.3f} m")
        check.figure("time", 100 * abs(time[first] / fem["t_s"][truth] - 1), label, f"{time[first]:.2f} s", f"{fem['t_s'][truth]:.2f} s")
        check.figure("curve", mean_difference(time, drop, fem), label)
        axes.plot(time, drop, lw=1.2, label=label)
    if not check.quick:
        torn = check.run("beam.json", "apic_0.0625", {"/domain/cell_size": 0.0625})
        axes.plot(*tip(torn), color="0.6", lw=1, label="apic, cell 0.0625 m: tears off")
        check.note(f"apic, cell 0.0625 m: mean difference {mean_difference(*tip(torn), fem):.2f} m")
    axes.plot(fem["t_s"], fem["uy_tip_m"], "k", lw=1, label="finite elements"), axes.plot(cpdi["t_s"], cpdi["uy_tip_m"], "k--", lw=1, label="CPDI")
    axes.set(xlabel="time  s", ylabel="vertical displacement of the corner  m"), axes.legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
