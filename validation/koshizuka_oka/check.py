"""Collapse of a water column against Koshizuka & Oka (1996): the front, beside the experiment of Martin & Moyce on the same shape of column."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, np, plt, reference  # noqa: E402

WIDTH = 0.146  # L, m; the column is 2L high, the tank 4L long


def main():
    check = Check(__doc__, __file__)
    table, other = reference("koshizuka_oka1996_front_pysph.csv"), reference("mm1952_n2eq2_front_table2_a2.25in.csv")
    count = 20 if check.quick else 40
    results = check.run("column.json", f"L_{count}", {"/domain/cell_size": WIDTH / count})
    time, place = results.gauge("front")
    clock, front = time * np.sqrt(2 * GRAVITY / WIDTH), np.ravel(place) / WIDTH
    moved = table["T"] > 0
    found = np.interp(table["T"][moved], clock, front)
    apart = np.abs(found - table["Z"][moved])
    worst = apart.argmax()
    check.figure("front", apart.max(), f"at T = {table['T'][moved][worst]:g}", found[worst], table["Z"][moved][worst])
    check.figure("mean", apart.mean())
    between = np.abs(np.interp(table["T"], other["T"], other["Z"]) - table["Z"])[(table["T"] >= other["T"][0]) & (table["T"] <= other["T"][-1])]
    check.note(f"the two experiments differ by {between.max():.2f} L at most, {between.mean():.2f} L on average")
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    axes.plot(clock, front, lw=1.2, label=f"jaxmpm, L/{count}"), axes.plot(table["T"], table["Z"], "ko", ms=4, label="Koshizuka & Oka 1996")
    axes.plot(other["T"], other["Z"], "x", color="0.5", ms=5, label="Martin & Moyce 1952")
    axes.set(xlabel="t √(2g/L)", ylabel="front / L", xlim=(0, 3.4), ylim=(1, 4.1)), axes.legend(fontsize=8)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
