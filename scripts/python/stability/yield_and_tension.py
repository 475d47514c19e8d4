"""Drucker–Prager at its apex and in tension: sand that is pulled apart, thrown, and falls back; every stress must stay admissible and finite."""
from study import BASES, GRAVITY, Study, body, box, deck, np, plt, sand

CELL, SPEED, DENSITY = 0.01, 20.0, 1500.0
COHESION = 500.0  # Pa
ANGLE = np.radians(30)
CONE = 6 / (np.sqrt(3) * (3 + np.sin(ANGLE)))  # q_φ = CONE sin φ, k_φ = CONE c cos φ
APEX = COHESION / np.tan(ANGLE)                # k_φ/q_φ, Pa
SOILS = {
    "cohesionless": {},
    "cohesive, no tension": {"cohesion": COHESION},
    "cohesive, cut-off half the apex": {"cohesion": COHESION, "tension_cutoff": APEX / 2},
    "cohesive, cut-off at the apex": {"cohesion": COHESION, "tension_cutoff": APEX * (1 - 1e-9)},
    "dilatant (ψ = φ), cut-off half the apex": {"cohesion": COHESION, "tension_cutoff": APEX / 2, "dilation_angle": 30},
}


def scene(kind, soil, method):
    side = 16 * CELL
    common = {"method": method, "gauges": ("energy",), "frames": 40, "fields": ["stress", "velocity", "density"]}
    law = {"m": sand(SPEED, 30, DENSITY, **soil)}
    if kind == "pulled apart":  # expands from its middle at 1 m/s at the edges
        block = body("m", box([side, side], [2 * side, 2 * side]), velocity=[f"{2 / side} * (x - {1.5 * side})", f"{2 / side} * (y - {1.5 * side})"])
        return deck([3 * side, 3 * side], CELL, law, [block], 0.1, **common)
    if kind == "thrown at a wall":
        block = body("m", box([side, 0], [2 * side, side]), velocity=[-2.0, 1.0], jitter={"fraction": 0.3})
        return deck([4 * side, 3 * side], CELL, law, [block], 0.6, gravity=[0, -GRAVITY], walls={"y_min": {"kind": "friction", "coefficient": 0.4}}, **common)
    block = body("m", box([0, 0], [side / 2, side]), initial_stress={"k0": 0.5}, velocity=[f"{1 / side} * y", 0])  # a column that is knocked over
    return deck([4 * side, 2 * side], CELL, law, [block], 0.6, gravity=[0, -GRAVITY], walls={"y_min": {"kind": "no_slip"}}, **common)


def invariants(stress):
    """Mean stress and τ = √J2, Pa."""
    mean = stress[:, :3].mean(axis=1)
    deviator = stress[:, :3] - mean[:, None]
    return mean, np.sqrt(0.5 * (deviator**2).sum(axis=1) + (stress[:, 3:] ** 2).sum(axis=1))


def excess(run, soil):
    """Largest of the mean tension above the cut-off and of the yield function, over all frames, in Pa; and the largest mean tension."""
    cohesion, cutoff = soil.get("cohesion", 0.0), soil.get("tension_cutoff", 0.0)
    tension, shear, most = -np.inf, -np.inf, -np.inf
    for frame in run.results.frames:
        mean, tau = invariants(frame.field("stress"))
        tension, most = max(tension, (mean - cutoff).max()), max(most, mean.max())
        shear = max(shear, (tau + CONE * (np.sin(ANGLE) * mean - cohesion * np.cos(ANGLE))).max())
    return tension, shear, most


def gained(run):
    """Energy that came from nowhere, as part of what was there to move: kinetic, potential and strain energy above its start."""
    _, energy = run.energy()
    moving = energy["kinetic"] + energy["strain"] + energy["potential"]
    return (moving - moving[0]).max() / (moving[0] - energy["potential"].min())


def main():
    study = Study(
        __file__, "Drucker–Prager at the apex and in tension",
        "where the cone and the tension cut-off meet, and at the apex, a return mapping may leave the admissible region, divide by nothing, or take a tension back that the grains do not have; loose grains may swell and come back stiff.",
    )  # fmt: skip
    kinds = ("pulled apart", "thrown at a wall", "knocked over")
    rows, worst, failed = [], 0.0, 0
    for kind in kinds:
        for name, soil in SOILS.items():
            for label, method in (("apic, quadratic", {}), ("flip 1, linear", {"transfer": "flip", "flip_fraction": 1, "basis": "linear"}), ("apic, quadratic, f32", {"precision": "f32"})):
                run = study.run(scene(kind, soil, method), may_fail=True)
                failed += not run.done
                if not run.done:
                    rows.append([kind, name, label, "failed", "", "", "", ""])
                    continue
                tension, shear, most = excess(run, soil)
                speed = max(np.linalg.norm(f.field("velocity"), axis=1).max() for f in run.results.frames)
                scale = DENSITY * SPEED**2
                if "f32" not in label:
                    worst = max(worst, tension / scale, shear / scale)
                rows.append([kind, name, label, "finite", most, max(tension, 0) / scale, max(shear, 0) / scale, gained(run)])
                study.data[f"{kind}, {name}, {label}"] = {"tension_excess": tension, "yield_excess": shear, "largest_mean": most, "gained": gained(run), "speed": speed}
    study.table(
        "Sand of 30°, cell 1 cm; excess relative to ρc²", ["scene", "soil", "scheme", "", "largest mean tension, Pa", "above the cut-off", "outside the cone", "energy gained / available"], rows,
    )  # fmt: skip
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
    soil = SOILS["dilatant (ψ = φ), cut-off half the apex"]
    run = study.run(scene("thrown at a wall", soil, {}))
    for frame in run.results.frames[5::8]:
        mean, tau = invariants(frame.field("stress"))
        axes[0].plot(mean, tau, ".", ms=1.5, label=f"{frame.time:.2f} s")
    mean = np.linspace(-8000, soil["tension_cutoff"], 2)
    axes[0].plot(mean, CONE * (COHESION * np.cos(ANGLE) - np.sin(ANGLE) * mean), "k", lw=0.8), axes[0].axvline(soil["tension_cutoff"], color="k", lw=0.8)
    axes[0].set(xlim=(-5000, 1.5 * APEX), ylim=(0, 3500), xlabel="mean stress  Pa (tension positive)", ylabel="√J2  Pa", title="thrown, dilatant"), axes[0].legend(fontsize=7, markerscale=4)
    place = run.last("position")
    axes[1].scatter(place[:, 0], place[:, 1], s=2, c=run.last("density"), vmin=0.9 * DENSITY, vmax=1.02 * DENSITY), axes[1].set_aspect("equal"), axes[1].set(xlabel="x  m", ylabel="y  m", title="density at the end")
    study.draw(figure)
    most_gained = max(entry["gained"] for entry in study.data.values())
    study.finish(
        f"no state outside the surface by more than {worst:.1g} ρc² (double precision)", "cured (exact return, corner, opening of gaps)",
        f"{len(rows) - failed} of {len(rows)} runs end with finite numbers. In double precision no stress lies outside the cone or above the cut-off by more than {worst:.1g} ρc², also with the cut-off at the apex and in a block that is torn apart. "
        f"The largest energy that came from nowhere is {100 * most_gained:.2g} % of what was there to move.",
    )  # fmt: skip
