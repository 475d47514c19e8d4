"""From sticking to sliding: acceleration of a block against the angle of its plane, through the angle of friction, and how far it creeps below it."""
from study import GRAVITY, SCHEMES, Study, body, box, deck, np, plt

CELL, FRICTION, END = 0.02, 0.4, 0.8
CRITICAL = np.degrees(np.arctan(FRICTION))
ANGLES = (5, 10, 15, 18, 20, 21, 21.5, 22, 22.5, 23, 25, 30, 40)
SHOWN = ("pic", "apic", "flip 0.99", "flip 1")


def incline(angle, scheme):
    """A rubber block, at rest under its own weight, on a plane of friction; gravity is tilted."""
    gravity = [GRAVITY * np.sin(np.radians(angle)), -GRAVITY * np.cos(np.radians(angle))]
    rubber = {"model": "linear_elastic", "density": 1000, "youngs_modulus": 1e6, "poisson_ratio": 0.3}
    block = body("m", box([0.2, 0], [0.6, 0.2]))
    return deck([3.0, 0.4], CELL, {"m": rubber}, [block], END, gravity=gravity, method=SCHEMES[scheme], walls={"y_min": {"kind": "friction", "coefficient": FRICTION}}, gauges=("momentum",), samples=160)


def motion(run):
    """Acceleration over the last three quarters, and displacement, from the momentum along the plane."""
    time, momentum = run.results.gauge("momentum")
    velocity = momentum[:, 0] / (1000 * 0.4 * 0.2)
    late = time > 0.25 * time[-1]
    moved = (run.last("position") - run.first("position"))[:, 0].mean()
    return np.polyfit(time[late], velocity[late], 1)[0], moved


def main():
    study = Study(
        __file__, "From sticking to sliding",
        "Coulomb's law jumps between sticking and sliding. A block should stay below the angle of friction and slide with g (sin θ − μ cos θ) above it; one that rings leaves the plane between pressings and creeps.",
    )  # fmt: skip
    theory = [max(0.0, GRAVITY * (np.sin(np.radians(a)) - FRICTION * np.cos(np.radians(a)))) for a in ANGLES]
    found = {scheme: [motion(study.run(incline(angle, scheme))) for angle in ANGLES] for scheme in SHOWN}
    study.table(
        f"Acceleration in m/s² by angle, μ = {FRICTION} (angle of friction {CRITICAL:.2f}°)", ["angle °", "closed form", *SHOWN, "pic: moved, cells", "apic: moved, cells"],
        [[a, t, *(found[s][k][0] for s in SHOWN), found["pic"][k][1] / CELL, found["apic"][k][1] / CELL] for k, (a, t) in enumerate(zip(ANGLES, theory))],
    )  # fmt: skip
    study.data = {"angle": ANGLES, "theory": theory, **{s: {"acceleration": [f[0] for f in found[s]], "moved": [f[1] for f in found[s]]} for s in SHOWN}}
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    fine = np.linspace(ANGLES[0], ANGLES[-1], 200)
    axes[0].plot(fine, np.maximum(0, GRAVITY * (np.sin(np.radians(fine)) - FRICTION * np.cos(np.radians(fine)))), "k--", lw=0.8, label="closed form")
    for scheme in SHOWN:
        axes[0].plot(ANGLES, [f[0] for f in found[scheme]], "o", ms=3, label=scheme)
        below = [k for k, a in enumerate(ANGLES) if a < CRITICAL]
        axes[1].semilogy([ANGLES[k] for k in below], [max(abs(found[scheme][k][1]) / CELL, 1e-5) for k in below], "o-", ms=3, lw=1, label=scheme)
    axes[0].set(xlabel="angle  °", ylabel="acceleration  m/s²"), axes[0].legend(fontsize=7)
    axes[1].set(xlabel="angle  °", ylabel=f"moved in {END} s, cells", title="below the angle of friction"), axes[1].legend(fontsize=7)
    study.draw(figure)
    above = [k for k, a in enumerate(ANGLES) if a > CRITICAL + 1]
    off = {s: max(abs(found[s][k][0] / theory[k] - 1) for k in above) for s in SHOWN}
    creep = {s: max(abs(found[s][k][1]) for k, a in enumerate(ANGLES) if a < CRITICAL - 1) / CELL for s in SHOWN}
    sliding = {s: next((a for a, f in zip(ANGLES, found[s]) if f[1] > 0.1 * CELL), np.nan) for s in SHOWN}
    study.finish(
        f"moves by a tenth of a cell in {END} s from {sliding['pic']:g}° (pic) and {sliding['apic']:g}° (apic), friction {CRITICAL:.1f}°", "open for bodies that ring (apic, flip); exact where the ringing is damped",
        f"A degree and more above the angle of friction the acceleration is off by at most {100 * off['pic']:.2g} % with PIC and {100 * off['apic']:.2g} % with APIC. A degree and more below it the block, set down without stress, creeps by {creep['pic']:.2g} cells with PIC, "
        f"{creep['apic']:.2g} with APIC, {creep['flip 0.99']:.2g} with FLIP 0.99 and {creep['flip 1']:.2g} with FLIP 1 in {END} s: while it rings it hops, and what hops slides. Nothing in the friction law itself creeps: where the ringing is gone the block stands.",
    )  # fmt: skip
