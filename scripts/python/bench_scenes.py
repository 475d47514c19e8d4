"""The fixed scenes of scripts/bench: (deck, steps, assignments for --set), each one command line away."""
from bench_runs import ROOT

BLOCKS = {3: ROOT / "scripts" / "yardstick" / "block3d.json", 2: ROOT / "scripts" / "yardstick" / "block2d.json"}
INPUTS = ROOT / "inputs"
BASE_PRECISION = {3: "f32", 2: "f64"}

SPLINE = {"/method/gradient": "spline"}
ELASTIC = {"density": 1000, "youngs_modulus": 1e6, "poisson_ratio": 0.3}
MATERIALS = {
    "newtonian, viscous": {"model": "newtonian", "density": 1000, "sound_speed": 35, "viscosity": 1e-3},
    "linear_elastic": {"model": "linear_elastic", **ELASTIC},
    "neo_hookean": {"model": "neo_hookean", **ELASTIC},
    "drucker_prager": {"model": "drucker_prager", "density": 1000, "bulk_modulus": 7e5, "poisson_ratio": 0.3, "friction_angle": 20},
}
# Cells along a side of a cube or square that hold about 10^3 … 10^7 particles, eight or four a cell.
SIDES = {3: (5, 11, 23, 50, 108), 2: (16, 50, 158, 500, 1581)}


def block(dim, steps, **more):
    """The yardstick's scene: 614,400 particles in 3D, 10,000 in 2D; `more`: further assignments."""
    return (BLOCKS[dim], steps, more)


def variant_block(dim, assignments):
    """The scene on which configurations are compared: in 3D a quarter of the yardstick's, so that a pair takes a second."""
    smaller = {"/bodies/0/shape/box/max": [0.07, 0.26, 0.22]} if dim == 3 else {}
    return (BLOCKS[dim], {3: 20, 2: 800}[dim], {**smaller, **assignments})


def cube(dim, side, assignments, work):
    """A cube (square) of side³ (side²) cells in the same domain's corner; as many steps as `work` particle-steps are, 4 to 2,000."""
    cell = {3: 0.005, 2: 0.01}[dim]
    low = {3: 4, 2: 8}[dim]
    particles = (2 * side) ** dim
    box = {"min": [low * cell] * dim, "max": [(low + side) * cell] * dim}
    domain = [(2 * low + side) * cell] * dim
    steps = max(4, min(2000, round(work / particles)))
    return (BLOCKS[dim], steps, {"/domain/max": domain, "/bodies/0/shape/box/min": box["min"], "/bodies/0/shape/box/max": box["max"], **assignments})


def configurations(dim):
    """Groups of comparisons: base assignments with a name, and variants by name."""
    other = {"f32": "f64", "f64": "f32"}[BASE_PRECISION[dim]]
    by_key = {
        f"precision {other}": {"/method/precision": other},
        **{f"transfer {t}": {"/method/transfer": t} for t in ("pic", "flip", "tpic")},
        **{f"basis {b}": {"/method/basis": b} for b in ("linear", "cubic")},
        **{name: {"/materials/water": m} for name, m in MATERIALS.items()},
    }
    return {
        "gradient spline": (SPLINE, {name: {**SPLINE, **v} for name, v in by_key.items()}),
        "gradient mls": ({}, {"gradient spline": SPLINE, f"precision {other}": by_key[f"precision {other}"], "drucker_prager": by_key["drucker_prager"]}),
    }


# Typical runs, shortened in time only: deck, assignments.
RUNS = {
    "dam_break_2d": ("dam_break_2d.json", {"/time/end": 0.1}),
    "dam_break_3d, cells of 1 cm": ("dam_break_3d.json", {"/domain/cell_size": 0.01, "/time/end": 0.3}),
    "granular_column_a2": ("granular_column_a2.json", {"/time/end": 0.2}),
    "dam_break_obstacle": ("dam_break_obstacle.json", {"/time/end": 0.15}),
}

# What a gradient costs over a plain run: deck, steps, assignments.
GRADIENTS = {
    "velocity of a column, 2D": ("truth_velocity_linear.json", 500, {}),
    "granular column, 2D": ("granular_column_a2.json", 200, {}),
    "dam break, 3D, single precision": ("dam_break_3d.json", 40, {"/domain/cell_size": 0.01}),
    "dam break, 3D, double precision": ("dam_break_3d.json", 40, {"/domain/cell_size": 0.01, "/method/precision": "f64"}),
    "granular column, 3D, double precision": ("granular_column_3d.json", 40, {"/domain/cell_size": 0.01, "/method/precision": "f64"}),
}
