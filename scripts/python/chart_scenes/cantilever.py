"""A cantilever near incompressibility that sinks under its own weight, against Timoshenko's beam: locking, noise of the pressure, and their cure."""
import statistics

from charts_scene import BASES, CHOSEN, EVERY, NOT_THEIR_SCENE, ROOT, TRANSFERS, Block, Measure, Scene, Variant, check_of, curves, roughness

NU, WHOLE = 0.499, 1  # Poisson's ratio; volume averaging of all of the change
pressure = check_of("pressure")
CURED = curves(TRANSFERS[1:], BASES, averaging=[WHOLE])


def drop(results, _):
    return 100 * abs(pressure.tip(results) / pressure.sag(NU) - 1)


def noise(results, _):
    return 100 * roughness(results.frames[-1:], results.deck, pressure.DENSITY * pressure.WEIGHT * pressure.DEPTH)


def advice(kept):
    cell = 0.125
    base, cured, cubic, both = (kept.point(cell=cell, **choice) for choice in ({}, {"averaging": WHOLE}, {"basis": "cubic"}, {"basis": "cubic", "averaging": WHOLE}))
    seconds = statistics.median(kept.point(cell=c, averaging=WHOLE)["cpu_seconds"] / kept.point(cell=c)["cpu_seconds"] for c in (0.25, cell))
    return (f"Near incompressibility give `volume_averaging` {WHOLE}: at {1000 * cell:g} mm the drop is {cured['errors']['drop']:.2g} instead of {base['errors']['drop']:.2g} % off and the noise of the pressure {cured['errors']['noise']:.2g} "
            f"instead of {base['errors']['noise']:.3g} % of ρgh, in {seconds:.2g} of the time; cubic splines have {both['errors']['drop']:.2g} and {cubic['errors']['drop']:.2g} %.")


SCENE = Scene(
    title="Cantilever near incompressibility",
    says="`validation/pressure/beam.json` ([validation/pressure](../validation/pressure/README.md)) with Poisson's ratio 0.499: a clamped beam, four times as long as deep, sinks under its own weight and is damped until it rests, 1.2 s. Errors: drop of the tip "
         "against Timoshenko's beam in plane strain, and noise of the pressure, what a plane through the particles around leaves of it, rms over the weight of the beam's depth. "
         "One particle a cell locks less, as a single point of integration does in finite elements, and its error passes through zero: a small one there is in part chance.",
    deck=ROOT / "validation" / "pressure" / "beam.json",
    end=1.2,  # s: it has come to rest by then, e^-12 of the way
    fields=("velocity", "pressure"),
    blocks=(Block((0.25, 0.125), curves=EVERY + CURED), Block((0.25,), (1, 9), curves=CHOSEN + CURED), Block((1 / 12,), curves=curves(["apic"], ["quadratic"], averaging=[0, WHOLE]))),
    measures={"drop": Measure("drop of the tip", "%", drop), "noise": Measure("noise of the pressure", "% ρgh", noise)},
    paper=Variant("apic", "quadratic", "f64", "spline", 0, 0.125, step=5e-6),
    paper_says=NOT_THEIR_SCENE,
    advice=advice,
    settings={"/materials/rubber/poisson_ratio": NU, "/method/damping": 20},
)
