"""Largest stable time step, as a CFL number dt c/h, of each basis and transfer, on scenes that excite what the grid cannot resolve."""
from study import BASES, GRAVITY, SCHEMES, Study, body, box, deck, np, plt, sand, solid, water

CELL, SPEED, STEPS = 0.01, 10.0, 600  # m; m/s, c; steps of each run
GROWTH = 1.5                          # times the energy that is there to move: more is an instability
AUTOMATIC = {"linear": 0.25, "quadratic": 0.4, "cubic": 0.4}  # the deck's default cfl
FIRST, COARSE, FINE = 0.3, 1.2, 1.04  # least CFL number tried; factors of the coarse and the fine scan
JITTER = {"fraction": 0.5}            # particles out of step with the grid, as they are after a while


def confined(method, end, time):
    """A standing wave in a box that water fills."""
    side = 16 * CELL
    pool = body("m", box([0, 0], [side, side]), velocity=[f"{1e-3 * SPEED} * sin(_pi * x / {side})", 0], jitter=JITTER)
    return deck([side, side], CELL, {"m": water(SPEED)}, [pool], end, method=method, time=time)


def column(method, end, time, dim=2):
    """A column of water that is let go: c = 10 √(2gH)."""
    wide, high = (10, 20) if dim == 2 else (6, 12)
    gravity = (SPEED / 10) ** 2 / (2 * high * CELL)
    low, top, far = [0] * dim, [wide * CELL] * (dim - 1) + [high * CELL], [4 * wide * CELL] + [wide * CELL] * (dim - 2) + [1.5 * high * CELL]
    pool = body("m", box(low, top), initial_stress="hydrostatic", jitter=JITTER)
    return deck(far, CELL, {"m": water(SPEED, tension_limit=0)}, [pool], end, method=method, time=time, gravity=[0] * (dim - 1) + [-gravity])


def elastic(method, end, time):
    """A free block of rubber that vibrates in both directions."""
    low, high = 6 * CELL, 18 * CELL
    wave = f"{1e-2 * SPEED} * sin(_pi * ({{0}} - {12 * CELL}) / {12 * CELL})"
    block = body("m", box([low, low], [high, high]), velocity=[wave.format("x"), wave.format("y")], jitter=JITTER)
    return deck([24 * CELL, 24 * CELL], CELL, {"m": solid("neo_hookean", SPEED)}, [block], end, method=method, time=time)


def grains(method, end, time):
    """A column of sand that is let go: waves of 10 √(2gH)."""
    gravity = (SPEED / 10) ** 2 / (2 * 20 * CELL)
    pile = body("m", box([0, 0], [10 * CELL, 20 * CELL]), initial_stress={"k0": 0.5}, jitter=JITTER)
    return deck([40 * CELL, 30 * CELL], CELL, {"m": sand(SPEED)}, [pile], end, method=method, time=time, gravity=[0, -gravity], walls={"y_min": {"kind": "no_slip"}})


SCENES = {
    "water in a closed box": (confined, SCHEMES),
    "column of water": (column, SCHEMES),
    "elastic block": (elastic, SCHEMES),
    "column of sand": (grains, ("flip 1", "apic")),
    "column of water, 3D": (lambda method, end, time: column(method, end, time, 3), ("flip 1", "apic")),
}
LEFT_OUT = ("flip 0.9",)  # lies between flip 0.99 and pic


def stable(study, scene, method, cfl):
    """Whether a run neither fails nor gains energy: more than half of what was there to move."""
    step = cfl * CELL / SPEED
    run = study.run(scene(method, STEPS * step, {"step": step}), may_fail=True)
    if not run.done:
        return False
    _, energy = run.energy()
    moving = energy["kinetic"] + energy["strain"] + energy["potential"]
    available = moving[0] - (energy["potential"].min() if energy["potential"].any() else 0)
    return bool(np.all(np.isfinite(moving)) and (moving - moving[0]).max() < (GROWTH - 1) * available)


def largest_stable(study, scene, method):
    """The largest CFL number below which every one tried is stable; 0 where the first is not."""
    good = 0.0
    for factor in (COARSE, FINE):
        following = good * factor if good else FIRST
        while following < 3 and stable(study, scene, method, following):
            good, following = following, following * factor
    return good


def schemes_of(names):
    for name in names:
        for basis in BASES if name not in LEFT_OUT else ():
            yield name, basis, {**SCHEMES[name], "basis": basis}
    if names is SCHEMES:
        for basis in BASES[1:]:
            yield "apic, mls", basis, {**SCHEMES["apic"], "basis": basis, "gradient": "mls"}


def main():
    study = Study(
        __file__, "Time step against the speed of waves",
        "an explicit step is stable up to a CFL number dt c/h of about one, the more the smoother the basis; beyond it the energy grows at the scale of cells until a particle is thrown out.",
    )  # fmt: skip
    limits = {}
    for scene, (make, names) in SCENES.items():
        for scheme, basis, method in schemes_of(names):
            limits.setdefault(scene, {}).setdefault(scheme, {})[basis] = largest_stable(study, make, method)
    columns = [name for name in [*SCHEMES, "apic, mls"] if name not in LEFT_OUT]
    for scene, found in limits.items():
        rows = [[basis, *(found[s].get(basis, np.nan) if s in found else np.nan for s in columns)] for basis in BASES]
        study.table(f"Largest stable CFL number, {scene}", ["basis", *columns], rows)
    worst = {basis: min((f[basis], scene, scheme) for scene, found in limits.items() for scheme, f in found.items() if basis in f) for basis in BASES}
    study.data = {"limits": limits, "worst": {basis: w[0] for basis, w in worst.items()}}
    figure, axes = plt.subplots(1, len(SCENES), figsize=(11, 3), sharey=True, layout="constrained")
    for ax, (scene, found) in zip(axes, limits.items()):
        for k, scheme in enumerate(found):
            ax.plot(range(3), [found[scheme].get(basis, np.nan) for basis in BASES], "o-", ms=4, lw=1, color=f"C{columns.index(scheme)}", label=scheme)
        ax.plot(range(3), [AUTOMATIC[basis] for basis in BASES], "k--", lw=0.8)
        ax.set_xticks(range(3), BASES, fontsize=8), ax.set_title(scene, fontsize=9)
    axes[0].set_ylabel("largest stable dt c/h"), axes[0].set_ylim(0), axes[2].legend(fontsize=7)
    study.draw(figure)
    margin = min(w[0] / AUTOMATIC[basis] for basis, w in worst.items())
    study.finish(
        "dt c/h up to " + ", ".join(f"{worst[b][0]:.2g} ({b})" for b in BASES), "cured by the automatic step; a fixed step above the limit is refused by `check` and warned of by `run`",
        f"The least limits are {', '.join(f'{w[0]:.2f} for {b} ({w[2]}, {w[1]})' for b, w in worst.items())}. The automatic step ({', '.join(f'{c:g} for {b}' for b, c in AUTOMATIC.items())}) "
        + ("lies inside all of them" if margin >= 1 else "**does not lie inside all of them**") + f": the smallest margin is a factor {margin:.2f}.",
        f"A run counts as unstable when it fails or when its kinetic, potential and strain energy grows by more than half of what was there to move within {STEPS:,} steps; every CFL number tried "
        f"below the one in the table was stable ({FINE - 1:.0%} apart at the end, {COARSE - 1:.0%} before). Particles are displaced at random by up to a quarter of their spacing, as they lie after a while of flow.",
    )  # fmt: skip
