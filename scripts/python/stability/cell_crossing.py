"""Stress of a bar that is compressed evenly while its particles cross cells, against the closed form, by basis and particles per cell."""
from study import BASES, SCHEMES, Study, body, box, deck, np, plt, solid

CELL, SPEED, CELLS, STRAIN = 0.01, 10.0, 40, 0.2
PER_CELL = (1, 4, 9, 16)
END = 0.4 * CELLS * CELL / SPEED  # before the wave from the free end has come to the middle


def bar(method, per_cell):
    """Every particle keeps its velocity −ε' x until the wave from the free end reaches it, so that F = 1 − ε' t; ν = 0."""
    long, high = CELLS * CELL, 4 * CELL
    block = body("m", box([0, 0], [long, high]), velocity=[f"-{STRAIN / END} * x", 0], particles_per_cell=per_cell)
    return deck([1.2 * long, high], CELL, {"m": solid("neo_hookean", SPEED, poisson=0)}, [block], END, method=method, frames=40, gauges=(), fields=["stress"])


def exact(time):
    """σ_xx = μ (F² − 1)/F with μ = E/2 and E = ρ c²."""
    stretch = 1 - STRAIN * time / END
    return 0.5 * 1000 * SPEED**2 * (stretch**2 - 1) / stretch


def noise(study, method, per_cell):
    """Largest rms error over the later half of the frames, relative to the stress; and the last frame's profile."""
    run = study.run(bar(method, per_cell))
    start = run.first("position")[:, 0]
    inner = (start > 3 * CELL) & (start < 0.45 * CELLS * CELL)
    errors = [np.sqrt(np.mean((frame.field("stress")[inner, 0] / exact(frame.time) - 1) ** 2)) for frame in run.results.frames[20:]]
    order = np.argsort(start[inner], kind="stable")
    return max(errors), start[inner][order] / CELL, run.last("stress")[inner, 0][order] / exact(run.results.frames[-1].time)


def main():
    study = Study(
        __file__, "Cell crossing",
        "with linear splines the gradient of the basis jumps where a particle crosses into the next cell, and the internal force with it: the stress of a body that moves through the grid becomes noise. Quadratic and cubic splines have continuous gradients.",
    )  # fmt: skip
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    found = {}
    for basis in BASES:
        for per_cell in PER_CELL:
            found.setdefault(basis, {})[per_cell], place, stress = noise(study, {"basis": basis}, per_cell)
            if per_cell == 4:
                axes[0].plot(place, stress, ".", ms=3, label=basis)
        axes[1].semilogy(PER_CELL, list(found[basis].values()), "o-", ms=4, label=basis)
    flip = {basis: noise(study, {**SCHEMES["flip 1"], "basis": basis}, 4)[0] for basis in BASES}
    axes[0].set(xlabel="place at the start, cells", ylabel="stress / closed form"), axes[0].legend(fontsize=7)
    axes[1].set(xlabel="particles per cell", ylabel="rms error of the stress"), axes[1].legend(fontsize=7)
    study.draw(figure)
    study.table(
        f"Rms error of the stress in %, compression of {100 * STRAIN:.0f} %", ["basis", *(f"apic, {n} per cell" for n in PER_CELL), "flip 1, 4 per cell"],
        [[basis, *(100 * e for e in found[basis].values()), 100 * flip[basis]] for basis in BASES],
    )  # fmt: skip
    study.data = {"apic": found, "flip 1": flip}
    study.finish(
        f"rms stress error with 4 particles per cell: {', '.join(f'{100 * found[b][4]:.2g} % ({b})' for b in BASES)}", "cured by the default (quadratic); `check` advises against linear",
        f"The stress should be the same all along the bar. With four particles per cell its rms error is {100 * found['linear'][4]:.2g} % with linear, {100 * found['quadratic'][4]:.2g} % with quadratic and {100 * found['cubic'][4]:.2g} % with cubic splines. "
        f"With 16 per cell linear splines still have {100 * found['linear'][16]:.2g} %, with one {100 * found['linear'][1]:.2g} %.",
    )  # fmt: skip
