"""Run-out and height of granular cylinders, a = 0.5, 1, 2, 4: the axisymmetric laws of Lube et al. (2004) and Lajeunesse et al. (2004)."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, law_value, np, plt, reference  # noqa: E402

RADIUS, ANGLE = 0.1, 25  # R0, m; friction angle nearest to Lajeunesse's glass beads (repose 22, avalanche 27.4 degrees), degrees
ASPECTS = np.array([0.5, 1.0, 2.0, 4.0])
LAWS = ("Lube2004", "Lajeunesse2004")
RUN_OUT, HEIGHT = "(Rinf-R0)/R0", "Hinf/R0"


def settings(aspect, quick):
    """The deck of the case granular_cylinder with another cylinder, in a box that ends 7 R0 from the axis."""
    cell, end = (0.02, 0.6) if quick else (0.0125, 0.8)
    top = 0.1 * np.ceil(10 * aspect * RADIUS) + 0.1
    domain = {"/domain/min": "[-0.2,-0.2,0]", "/domain/max": f"[1.2,1.2,{top:g}]", "/domain/cell_size": cell}
    body = {"/bodies/0/shape/cylinder/radius": RADIUS, "/bodies/0/shape/cylinder/to": f"[0.5,0.5,{aspect * RADIUS:g}]"}
    return {**domain, **body, "/materials/sand/friction_angle": ANGLE, "/time/end": end}


def main():
    check = Check(__doc__, __file__)
    laws = reference("granular_collapse_scaling_laws.csv")
    aspects = ASPECTS[1:3] if check.quick else ASPECTS
    run_out, height = [], []
    for aspect in aspects:
        results = check.run("granular_cylinder.json", f"a_{aspect:g}", settings(aspect, check.quick))
        time, radius = (np.ravel(values) for values in results.gauge("radius"))
        run_out.append(radius[-1] / RADIUS - 1), height.append(np.ravel(results.gauge("middle")[1])[-1] / RADIUS)
        check.note(f"a = {aspect:g}: {(radius[-1] - np.interp(0.8 * time[-1], time, radius)) / RADIUS:.3f} R0 of the run-out in the last fifth of the time")
        expected = {law: law_value(laws, law, RUN_OUT, aspect) for law in LAWS}
        nearest = min(expected.values(), key=lambda law: abs(np.log(run_out[-1] / law)))
        quoted = ", ".join(f"{value:.2f} {law}" for law, value in expected.items())
        check.figure("run_out", run_out[-1] / nearest, f"a = {aspect:g}", f"{run_out[-1]:.2f} R0", f"R0 × ({quoted})")
        law = law_value(laws, "Lajeunesse2004", HEIGHT, aspect)
        check.figure("height", height[-1] / law, f"a = {aspect:g}", f"{height[-1]:.2f} R0", f"{law:.2f} R0")
    slope = np.diff(np.log(run_out)) / np.diff(np.log(aspects))
    check.note("exponent from one cylinder to the next: " + ", ".join(f"{s:.2f}" for s in slope))
    if not check.quick:
        check.figure("exponent_low", slope[0], "", slope[0], "1")
        check.figure("exponent_high", slope[-1], "", slope[-1], "0.5")
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="constrained")
    fine = np.geomspace(0.3, 6, 200)
    for law in LAWS:
        axes[0].loglog(fine, [law_value(laws, law, RUN_OUT, a) for a in fine], lw=1, label=law)
    axes[1].loglog(fine, [law_value(laws, "Lajeunesse2004", HEIGHT, a) for a in fine], "C1", lw=1)
    axes[0].loglog(aspects, run_out, "ro", label="jaxmpm"), axes[1].loglog(aspects, height, "ro")
    axes[0].set(xlabel="H0 / R0", ylabel="run-out / R0"), axes[1].set(xlabel="H0 / R0", ylabel="height on the axis / R0"), axes[0].legend(fontsize=8)
    for at, levels in zip(axes, ((0.5, 1, 2, 4), (0.4, 0.5, 0.6, 0.7))):
        at.minorticks_off(), at.set_xticks(ASPECTS, [f"{a:g}" for a in ASPECTS]), at.set_yticks(levels, [f"{level:g}" for level in levels])
        at.grid(alpha=0.3)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
