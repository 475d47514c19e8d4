"""Nodes that a particle just grazes: acceleration and stress at the free face of a column, whose outermost particles lie δ beyond a plane of nodes."""
from study import BASES, GRAVITY, Study, body, box, deck, np, plt, sand, solid, water

CELL, HIGH = 0.01, 20
GRAZES = (0.25, 1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-11)  # cells
STEPS = 50
SPEED = 10 * np.sqrt(2 * GRAVITY * HIGH * CELL)
MATERIALS = {"water": (water(SPEED), "hydrostatic"), "neo_hookean": (solid("neo_hookean", SPEED), "geostatic"), "sand": (sand(SPEED), {"k0": 0.5})}


def column(material, method, graze, steps):
    """Half as wide as high; lattice of 20.5 spacings to its face, so that the last particles lie δ behind the node plane 10."""
    spacing = (10 + graze) * CELL / 20.5
    law, stress = MATERIALS[material]
    block = body("m", box([0, 0], [(10 + graze) * CELL + spacing / 2, HIGH * CELL]), spacing=spacing, initial_stress=stress)
    step = 0.4 * CELL / SPEED
    return deck([30 * CELL, 24 * CELL], CELL, {"m": law}, [block], steps * step, time={"step": step}, gravity=[0, -GRAVITY], method=method, gauges=(), fields=["velocity", "stress"])


def extremes(study, material, method, graze):
    """Largest acceleration in the first step over g, and largest stress after STEPS steps over ρgH."""
    once = study.run(column(material, method, graze, 1), may_fail=True)
    later = study.run(column(material, method, graze, STEPS), may_fail=True)
    if not once.done or not later.done:
        return np.nan, np.nan
    step = 0.4 * CELL / SPEED
    density = MATERIALS[material][0]["density"]
    return np.abs(once.last("velocity")).max() / step / GRAVITY, np.abs(later.last("stress")).max() / (density * GRAVITY * HIGH * CELL)


def main():
    study = Study(
        __file__, "Tiny nodal masses",
        "a particle that lies δ beyond a plane of nodes gives the nodes behind it a mass that goes to zero with δ (linear: δ, quadratic: δ²/2, cubic: δ³/6) but a force that falls by one power less: their acceleration has no bound.",
    )  # fmt: skip
    schemes = {f"{basis}, {name}": {"basis": basis, **more} for basis in BASES for name, more in (("apic", {}), ("flip 1", {"transfer": "flip", "flip_fraction": 1}))}
    found = {(material, scheme): [extremes(study, material, method, graze) for graze in GRAZES] for material in MATERIALS for scheme, method in schemes.items()}
    rows = [[material, scheme, max(v[0] for v in values), values[0][0], max(v[1] for v in values), values[0][1]] for (material, scheme), values in found.items()]
    study.table(
        f"Extremes over δ = {GRAZES[0]} … {GRAZES[-1]} cells", ["material", "scheme", "largest acceleration of a particle in the first step / g", f"with δ = {GRAZES[0]}", f"largest stress after {STEPS} steps / ρgH", f"with δ = {GRAZES[0]}"], rows,
    )  # fmt: skip
    study.data = {"graze": GRAZES, **{f"{material}, {scheme}": values for (material, scheme), values in found.items()}}
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for k, scheme in enumerate(schemes):
        for ax, which in zip(axes, (0, 1)):
            ax.loglog(GRAZES, [v[which] for v in found["neo_hookean", scheme]], "o-" if k % 2 == 0 else "s--", ms=4, lw=1, color=f"C{k // 2}", label=scheme)
    axes[0].set(xlabel="δ, cells", ylabel="acceleration of a particle / g"), axes[1].set(xlabel="δ, cells", ylabel=f"stress after {STEPS} steps / ρgH"), axes[0].legend(fontsize=7)
    study.draw(figure)
    worst = {basis: max(max(v[1] for v in values) / values[0][1] for (_, scheme), values in found.items() if scheme.startswith(basis)) for basis in BASES}
    study.finish(
        "largest stress with δ → 0 over that with δ = h/4: " + ", ".join(f"{worst[b]:.3g} ({b})" for b in BASES), "cured with quadratic and cubic splines; `check` advises against linear",
        "The acceleration of such a node comes back to a particle with the same small weight, so velocities stay bounded with every basis. What does not cancel is the velocity gradient: with linear splines ∇φ is 1/h however small φ is, and the particle's strain takes the node's whole velocity; "
        f"with smoother splines ∇φ vanishes together with φ. The largest stress over all δ is {worst['linear']:.3g} times that of a face a quarter of a cell off the nodes with linear splines, {worst['quadratic']:.3g} times with quadratic and {worst['cubic']:.3g} times with cubic ones.",
        "The mass cut-off (1e-20 of the largest particle's mass) only keeps the division from failing: it acts for δ below 1e-10 cells with quadratic splines.",
    )  # fmt: skip
