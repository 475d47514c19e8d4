"""Layers of a quarter to eight cells: a viscous film that starts to flow down a slope, and a slab that slides with friction."""
from study import BASES, GRAVITY, Study, body, box, deck, np, plt, sand, water

DEPTH, SLOPE = 0.01, np.radians(10)  # m
VISCOSITY = np.sqrt(GRAVITY * np.sin(SLOPE) * DEPTH**3 / 3)  # m²/s: the film flows its own depth in DEPTH²/VISCOSITY
END = DEPTH**2 / VISCOSITY
THICK = (0.25, 0.5, 1, 2, 4, 8)      # cells
STEEP, FRICTION = np.radians(30), 0.3


def per_cell(thick):
    """Sixteen where a layer thinner than a cell has to hold a row of particles."""
    return 16 if thick < 1 else 4


def cell_of(thick):
    return DEPTH / thick


def layer(thick, long):
    cell = cell_of(thick)
    start = cell * np.ceil(2 * DEPTH / cell)
    return box([start, 0], [start + cell * np.ceil(long / cell), DEPTH]), [start + cell * np.ceil(long / cell) + cell * np.ceil(8 * DEPTH / cell), max(4 * cell, cell * np.ceil(2 * DEPTH / cell))]


def film(thick, basis):
    """Water-like, no slip at the bed; only its middle is looked at."""
    shape, size = layer(thick, 40 * DEPTH)
    law = water(10 * np.sqrt(2 * GRAVITY * DEPTH), viscosity=1000 * VISCOSITY, tension_limit=0)
    gravity = [GRAVITY * np.sin(SLOPE), -GRAVITY * np.cos(SLOPE)]
    gauges = {"bed": {"kind": "force", "wall": "y_min"}}
    return deck(size, cell_of(thick), {"m": law}, [body("m", shape, initial_stress={"kind": "hydrostatic", "surface": {"point": [0, DEPTH]}}, particles_per_cell=per_cell(thick))], END, gravity=gravity,
                method={"basis": basis}, walls={"y_min": {"kind": "no_slip"}}, gauges=gauges, samples=100, fields=["velocity"])  # fmt: skip


def slab(thick, basis):
    """Sand that slides as a whole: its own friction (35°) is more than the bed's."""
    shape, size = layer(thick, 20 * DEPTH)
    law = sand(10 * np.sqrt(2 * GRAVITY * DEPTH), 35, 1500)
    gravity = [GRAVITY * np.sin(STEEP), -GRAVITY * np.cos(STEEP)]
    return deck(size, cell_of(thick), {"m": law}, [body("m", shape, initial_stress={"k0": 0.5, "surface": {"point": [0, DEPTH]}}, particles_per_cell=per_cell(thick))], 0.1, gravity=gravity,
                method={"basis": basis}, walls={"y_min": {"kind": "friction", "coefficient": FRICTION}}, gauges=(), frames=20, fields=["velocity"])  # fmt: skip


def middle(run):
    """Which particles lie in the middle half of the layer at the start."""
    x = run.first("position")[:, 0]
    return np.abs(x - x.mean()) < 0.25 * np.ptp(x)


def film_speed(time):
    """Mean velocity of the closed form for a film at rest at t = 0, m/s."""
    a = (2 * np.arange(40) + 1) * np.pi / 2
    return GRAVITY * np.sin(SLOPE) * DEPTH**2 / VISCOSITY * (1 / 3 - (2 / a**4 * np.exp(-(a**2) * VISCOSITY * time / DEPTH**2)).sum())


def film_errors(run):
    """Of the film's mean speed and of the weight on the bed; NaN where the run failed."""
    if not run.done:
        return np.nan, np.nan
    inner = middle(run)
    time, force = run.results.gauge("bed")
    weight = 1000 * GRAVITY * np.cos(SLOPE) * DEPTH * np.ptp(run.first("position")[:, 0])
    return run.last("velocity")[inner, 0].mean() / film_speed(END) - 1, np.abs(force[len(time) // 2 :, 1]).mean() / weight - 1


def slab_error(run):
    """Of the slab's acceleration; NaN where the run failed."""
    if not run.done:
        return np.nan
    core = middle(run)
    times = np.array([f.time for f in run.results.frames])
    velocities = np.array([f.field("velocity")[core, 0].mean() for f in run.results.frames])
    pull = GRAVITY * (np.sin(STEEP) - FRICTION * np.cos(STEEP))
    return np.polyfit(times[5:], velocities[5:], 1)[0] / pull - 1


def main():
    study = Study(
        __file__, "Very thin layers",
        "a layer thinner than the basis is wide has no profile: shear, pressure and friction at the bed come from nodes that the layer hardly fills.",
    )  # fmt: skip
    rows, data = [], {}
    for basis in BASES:
        for thick in THICK:
            speed, load = film_errors(study.run(film(thick, basis), may_fail=True))
            gain = slab_error(study.run(slab(thick, basis), may_fail=True))
            data[f"{basis}, {thick}"] = {"film": speed, "load": load, "slab": gain}
            rows.append([basis, thick, 100 * speed, 100 * load, 100 * gain])
    study.table("Error in %, by thickness in cells", ["basis", "thickness, cells", "mean speed of the viscous film", "weight on the bed", "acceleration of the sliding slab"], rows)
    study.data = data
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for basis in BASES:
        for ax, key in zip(axes, ("film", "slab")):
            ax.loglog(THICK, [np.maximum(abs(100 * data[f"{basis}, {t}"][key]), 1e-3) for t in THICK], "o-", ms=4, lw=1, label=basis)
    axes[0].set(xlabel="thickness, cells", ylabel="error of the film's speed, %"), axes[1].set(xlabel="thickness, cells", ylabel="error of the slab's acceleration, %"), axes[0].legend(fontsize=7)
    study.draw(figure)
    quadratic = {t: data[f"quadratic, {t}"] for t in THICK}
    study.finish(
        f"quadratic: film {100 * abs(quadratic[1]['film']):.2g} % off at 1 cell, {100 * abs(quadratic[4]['film']):.2g} % at 4; sliding slab {100 * abs(quadratic[0.25]['slab']):.2g} % off at a quarter of a cell", "advised",
        f"A viscous film (closed form of a film that starts from rest) runs at {100 * quadratic[0.5]['film']:+.2g} % of its speed with half a cell, {100 * quadratic[1]['film']:+.2g} % with one, {100 * quadratic[2]['film']:+.2g} % with two, {100 * quadratic[4]['film']:+.2g} % with four and {100 * quadratic[8]['film']:+.2g} % with eight cells "
        f"(quadratic). A slab that slides with friction is off by {100 * quadratic[0.25]['slab']:+.2g} % with a quarter of a cell and by {100 * quadratic[4]['slab']:+.2g} % with four: sliding as a whole asks nothing of the profile. A dash stands for a run that ended with an error: linear splines and tiny nodal masses.",
    )  # fmt: skip
