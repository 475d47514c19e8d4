"""How far an elastic bar can be stretched until its particles no longer share nodes: a heavy block, thrown, pulls the bar and must come back."""
from study import BASES, Study, body, box, deck, np, plt

CELL, DENSITY, SHEAR = 0.01, 1000.0, 5e4  # of the bar, ν = 0: λ = 0, E = 2 μ
LENGTH, HIGH, RATIO = 8, 4, 100           # cells, cells, density and stiffness of the block over those of the bar
BAR = DENSITY * LENGTH * CELL             # kg per m² of cross-section
BLOCK = RATIO * DENSITY * HIGH * CELL
MOVED = BLOCK + BAR / 3                   # the bar's velocity grows linearly along it
TARGETS = (1.25, 1.5, 2, 2.5, 3, 4, 5, 6, 8)
PER_CELL = (1, 4, 9, 16)
SUPPORT = {"linear": 2, "quadratic": 3, "cubic": 4}  # cells apart at which two particles share no node


def stored(stretch):
    """Energy per m³ of the bar at rest, uniaxial strain: μ/2 (Λ² − 1 − 2 ln Λ)."""
    return SHEAR / 2 * (stretch**2 - 1 - 2 * np.log(stretch))


def flight(target):
    """Launch speed for a largest stretch, and time and stretch until the bar has its length again (energy balance)."""
    speed = np.sqrt(2 * LENGTH * CELL * stored(target) / MOVED)
    share = np.sin(np.linspace(0, np.pi / 2, 400)[:-1])  # of the way: dense where it turns
    stretch = 1 + (target - 1) * share
    velocity = np.sqrt(np.maximum(2 * LENGTH * CELL * (stored(target) - stored(stretch)) / MOVED, 1e-30)) / (LENGTH * CELL)
    out = np.concatenate([[0], np.cumsum(np.diff(stretch) * 2 / (velocity[1:] + velocity[:-1]))])
    last = (target - stretch[-1]) * 2 / velocity[-1]
    time = np.concatenate([out, out[-1] + last + (out[-1] + last - out[::-1])])
    return speed, time, np.concatenate([stretch, stretch[::-1]])


def pulled(basis, per_cell, target):
    speed, time, _ = flight(target)
    high, long = HIGH * CELL, LENGTH * CELL
    bar = {"model": "neo_hookean", "density": DENSITY, "youngs_modulus": 2 * SHEAR, "poisson_ratio": 0}
    block = {**bar, "density": RATIO * DENSITY, "youngs_modulus": 2 * RATIO * SHEAR}
    bodies = [
        body("bar", box([0, 0], [long, high]), "bar", velocity=[f"{speed} * x / {long}", 0], particles_per_cell=per_cell),
        body("block", box([long, 0], [long + high, high]), "block", velocity=[speed, 0], particles_per_cell=per_cell),
    ]
    far = CELL * np.ceil(LENGTH * (1 + 2.5 * (target - 1)) + HIGH + 4)
    return deck([far, high], CELL, {"bar": bar, "block": block}, bodies, time[-1], method={"basis": basis}, gauges=(), frames=60, fields=["stress"])


def follow(study, basis, per_cell, target):
    """Time and stretch by frame (from the block's mean place), and the largest gap of neighbours along the bar, cells."""
    run = study.run(pulled(basis, per_cell, target), may_fail=True)
    if not run.done:
        return None
    place = np.array([frame.field("position", "block")[:, 0].mean() for frame in run.results.frames]) / CELL
    gaps = [np.diff(np.unique(np.round(frame.field("position", "bar")[:, 0] / CELL, 3))).max() for frame in run.results.frames]
    return np.array([f.time for f in run.results.frames]), (place - HIGH / 2) / LENGTH, max(gaps)


def reach(study, basis, per_cell):
    """Targets in turn until the bar's largest stretch is off by more than a tenth of its extension: the last good one, and the first bad with its stretch."""
    good = 1.0
    for target in TARGETS:
        found = follow(study, basis, per_cell, target)
        if found is None:
            return good, target, np.nan
        if abs(found[1].max() - target) > 0.1 * (target - 1):
            return good, target, found[1].max()
        good = target
    return good, np.nan, np.nan


def main():
    study = Study(
        __file__, "Tensile instability and numerical fracture",
        "particles hold together as long as they share nodes. Stretched by Λ their distance grows to Λ times the spacing; once that nears the width of the basis (2, 3 or 4 cells) the bar comes apart although the material cannot break.",
    )  # fmt: skip
    rows, found = [], {}
    for basis in BASES:
        for per_cell in PER_CELL:
            good, bad, stretch = reach(study, basis, per_cell)
            predicted = SUPPORT[basis] * np.sqrt(per_cell)
            found.setdefault(basis, {})[per_cell] = {"good": good, "bad": bad, "stretch": stretch, "predicted": predicted}
            rows.append([basis, per_cell, good, good / np.sqrt(per_cell), bad, stretch, predicted])
    study.table(
        f"Stretch from which the block returns as it should (within a tenth of the extension; tried: {', '.join(map(str, TARGETS))})",
        ["basis", "particles per cell", "right up to Λ", "particles then apart, cells", "first wrong at Λ", "reached there", "no common node beyond Λ"], rows,
    )  # fmt: skip
    study.data = found
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    shown = 4
    _, time, stretch = flight(shown)
    axes[0].plot(time, stretch, "k--", lw=0.8, label="energy balance")
    for basis in BASES:
        seen = follow(study, basis, 4, shown)
        if seen:
            axes[0].plot(seen[0], seen[1], lw=1, label=basis)
        axes[1].plot(np.sqrt(PER_CELL), [found[basis][n]["good"] for n in PER_CELL], "o-", ms=4, label=basis)
    axes[0].set(xlabel="time  s", ylabel="stretch Λ", title="thrown for Λ = 4, 4 particles per cell"), axes[0].legend(fontsize=7)
    axes[1].set(xlabel="particles per cell along an axis", ylabel="right up to Λ"), axes[1].legend(fontsize=7)
    study.draw(figure)
    four = {basis: found[basis][4] for basis in BASES}
    study.finish(
        "elastic bar with 4 particles per cell right up to a stretch of " + ", ".join(f"{four[b]['good']:g} ({b})" for b in BASES), "open; more particles per cell help",
        f"A block of {BLOCK / BAR:.0f} times the bar's mass is thrown so that the bar stretches to Λ and pulls it back; the closed form is the energy balance. With four particles per cell the bar follows it up to Λ = "
        + ", ".join(f"{four[b]['good']:g} with {b}" for b in BASES) + " splines.",
        "The program neither cures this nor refuses it: a run in which an elastic body has come apart goes on. It can be seen in the frames, and more particles per cell move the threshold up in proportion to their number along an axis.",
    )  # fmt: skip
