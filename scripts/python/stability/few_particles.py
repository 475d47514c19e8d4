"""From nine particles a cell to a quarter of one: water at rest, and a column that is let go."""
from study import BASES, GRAVITY, Study, body, box, deck, np, plt, water

CELL, SIDE = 0.01, 20                    # m, cells
HEIGHT = SIDE * CELL
NUMBERS = (60, 40, 30, 20, 16, 14, 10)  # particles along the side
SOUND = 10 * np.sqrt(2 * GRAVITY * HEIGHT)


def square(count):
    return body("m", box([0, 0], [HEIGHT, HEIGHT]), spacing=HEIGHT / count, initial_stress="hydrostatic")


def pond(count, basis):
    return deck([HEIGHT, 1.5 * HEIGHT], CELL, {"m": water(SOUND, tension_limit=0)}, [square(count)], 2.0, gravity=[0, -GRAVITY], method={"basis": basis}, gauges=("energy",), fields=["pressure"])


def dam(count, basis):
    gauges = {"front": {"kind": "front", "body": "body", "axis": "x", "quantile": 0.9}}
    return deck([5 * HEIGHT, 1.5 * HEIGHT], CELL, {"m": water(SOUND, tension_limit=0)}, [square(count)], 1.5 * np.sqrt(HEIGHT / GRAVITY), gravity=[0, -GRAVITY], method={"basis": basis}, gauges=gauges, samples=30, fields=["pressure"])


def main():
    study = Study(
        __file__, "One particle per cell and fewer",
        "with one particle per cell integrals over the body become coarse; with fewer there are nodes that no particle reaches, the linear basis first, and the body has holes through which it comes apart or sinks into itself.",
    )  # fmt: skip
    found, dams = {}, {}
    for basis in BASES:
        for count in NUMBERS:
            rest = study.run(pond(count, basis), may_fail=True)
            fall = study.run(dam(count, basis), may_fail=True)
            if not rest.done or not fall.done:
                found[basis, count] = (np.nan,) * 3
                continue
            y, pressure = rest.last("position")[:, 1], rest.last("pressure")
            wrong = np.sqrt(np.mean((pressure / (1000 * GRAVITY) - (HEIGHT - y)) ** 2)) / HEIGHT
            sunk = (rest.first("position")[:, 1].mean() - y.mean()) / (HEIGHT / 2)
            dams[basis, count] = fall.results.gauge("front")[1]
            found[basis, count] = (wrong, sunk, np.sqrt(np.mean((dams[basis, count] - dams[basis, NUMBERS[0]]) ** 2)) / HEIGHT)
    rows = [[basis, (count / SIDE) ** 2, SIDE / count, *(100 * v for v in found[basis, count][:2]), 100 * found[basis, count][2] if count != NUMBERS[0] else "–"] for basis in BASES for count in NUMBERS]
    study.table("Errors in %, by particles per cell", ["basis", "particles per cell", "spacing, cells", "pressure at rest, rms / ρgH", "sinking of the centre / its height", f"front against {(NUMBERS[0] / SIDE) ** 2:g} per cell, rms / H"], rows)
    study.data = {"per_cell": [(n / SIDE) ** 2 for n in NUMBERS], **{basis: {"pressure": [found[basis, n][0] for n in NUMBERS], "sunk": [found[basis, n][1] for n in NUMBERS], "front": [found[basis, n][2] for n in NUMBERS]} for basis in BASES}}
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for basis in BASES:
        axes[0].loglog(study.data["per_cell"], 100 * np.array(study.data[basis]["pressure"]), "o-", ms=4, lw=1, label=basis)
        axes[1].loglog(study.data["per_cell"][1:], 100 * np.array(study.data[basis]["front"][1:]), "o-", ms=4, lw=1, label=basis)
    axes[0].set(xlabel="particles per cell", ylabel="pressure at rest, rms / ρgH, %"), axes[1].set(xlabel="particles per cell", ylabel="front, rms / H, %"), axes[0].legend(fontsize=7)
    study.draw(figure)
    quadratic = {(n / SIDE) ** 2: found["quadratic", n] for n in NUMBERS}
    study.finish(
        f"quadratic: pressure at rest {100 * quadratic[4][0]:.2g} % off with 4 per cell, {100 * quadratic[1][0]:.2g} % with 1, {100 * quadratic[0.25][0]:.2g} % with 1 in 4 cells", "advised below 4 per cell in 2D, 8 in 3D",
        "With quadratic splines the rms error of the pressure at rest is " + ", ".join(f"{100 * v[0]:.2g} % with {n:.3g}" for n, v in quadratic.items()) + " particles per cell; the front of a column that is let go is off by "
        + ", ".join(f"{100 * v[2]:.2g} % with {n:.3g}" for n, v in list(quadratic.items())[1:]) + " of its height.",
    )  # fmt: skip
