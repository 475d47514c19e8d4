"""Single against double precision over long runs."""
import json

from study import GRAVITY, ROOT, Study, body, box, deck, np, plt, solid, water

CELL, SPEED, STEPS = 0.025, 10.0, 20000
HEIGHT, REST = 0.1, 20.0


def bar(precision):
    """The first mode of a bar, held at one end."""
    step = 0.4 * CELL / SPEED
    block = body("m", box([0, 0], [1, 0.1]), velocity=["0.02 * sin(_pi * x / 2)", 0])
    return deck([1.2, 0.1], CELL, {"m": solid("linear_elastic", SPEED)}, [block], STEPS * step, time={"step": step}, method={"precision": precision}, gauges=("energy", "momentum"), samples=2000)


def pond(precision):
    """Water at rest, started hydrostatic."""
    pool = body("m", box([0, 0], [2 * HEIGHT, HEIGHT]), initial_stress="hydrostatic")
    sound = 10 * np.sqrt(2 * GRAVITY * HEIGHT)
    return deck([2 * HEIGHT, 1.5 * HEIGHT], 0.01, {"m": water(sound, tension_limit=0)}, [pool], REST, gravity=[0, -GRAVITY], method={"precision": precision}, frames=4, samples=200, fields=["pressure"])


def drift():
    """Error of the path of a cloud that drifts at 1 mm/s for 200,000 steps, % (the validation case that measures it at full length)."""
    report = json.loads((ROOT / "docs" / "validation" / "drift_f32.json").read_text(encoding="utf-8"))
    return {figure["band"]: figure["value"] for figure in report["figures"]}["path"]


def main():
    study = Study(
        __file__, "Drift of single precision",
        "sums of 10⁵ small increments lose digits in single precision: slow motion freezes, energy and pressure drift. Positions are kept in double and densities as ρ/ρ0 − 1, so that neither should happen.",
    )  # fmt: skip
    figure, axes = plt.subplots(1, 2, figsize=(9, 3), layout="constrained")
    kept, momentum, pressure = {}, {}, {}
    for precision in ("f64", "f32"):
        run = study.run(bar(precision))
        time, energy = run.energy()
        moving = energy["kinetic"] + energy["strain"]
        kept[precision], momentum[precision] = moving[-1] / moving[0], run.results.gauge("momentum")[1][:, 0]
        axes[0].plot(time, moving / moving[0], "-" if precision == "f64" else "--", lw=1, label=precision)
        rest = study.run(pond(precision))
        position, pressure[precision] = rest.last("position"), rest.last("pressure")
        axes[1].plot(pressure[precision] / 1000, position[:, 1], "." if precision == "f64" else "x", ms=3, label=precision)
    apart = np.abs(momentum["f32"] - momentum["f64"]).max() / np.abs(momentum["f64"]).max()
    off = np.sqrt(np.mean((pressure["f32"] - pressure["f64"]) ** 2)) / (1000 * GRAVITY * HEIGHT)
    axes[0].set(xlabel="time  s", ylabel="energy of the bar / start"), axes[0].legend(fontsize=8)
    axes[1].plot([HEIGHT * GRAVITY, 0], [0, HEIGHT], "k", lw=0.6), axes[1].set(xlabel="pressure at the end  kPa", ylabel="height  m"), axes[1].legend(fontsize=8)
    study.draw(figure)
    path = drift()
    study.data = {"path_error_percent": path, "energy_kept": kept, "momentum_apart": apart, "pressure_apart": off}
    study.table(
        "Single against double precision", ["scene", "measure", "value"],
        [["cloud drifting at 1e-8 m a step, 200,000 steps", "error of the path", f"{path:.2g} %"],
         [f"vibrating bar, {STEPS:,} steps", "energy kept, f64 and f32", f"{kept['f64']:.5f} and {kept['f32']:.5f}"],
         [f"vibrating bar, {STEPS:,} steps", "largest difference of momentum / amplitude", f"{apart:.2g}"],
         [f"water at rest, {rest.summary['steps']:,} steps", "rms difference of pressure / ρgH", f"{off:.2g}"]],
    )  # fmt: skip
    study.finish(
        f"after 200,000 steps of 1e-8 m the path is off by {path:.2g} %", "cured (positions in double, densities as differences)",
        f"The path of a cloud that moves 1e-8 m a step for 200,000 steps is off by {path:.2g} % ([validation](validation.md#slow-drift-in-single-precision)). A bar that vibrates for {STEPS:,} steps keeps {kept['f32']:.4f} of its energy in single and {kept['f64']:.4f} in double precision; "
        f"its momentum differs by {apart:.1g} of the amplitude at most, the pressure of water at rest by {off:.1g} of ρgH. For the forward run of scenes like these single precision gives nothing away.",
    )  # fmt: skip
