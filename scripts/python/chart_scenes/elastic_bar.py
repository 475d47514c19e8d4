"""The vibrating elastic bar, against the closed form."""
from charts_scene import CHOSEN, NOT_THEIR_SCENE, ROOT, Block, Measure, Scene, Variant, check_of, np

SPEED = 0.002  # m/s, a tenth of the deck's: the closed form is that of strains that are vanishingly small
bar = check_of("elastic_bar")


def displacement(results, _):
    """Rms error of the displacement of the centre of mass over ten periods, over its rms."""
    time = np.array([frame.time for frame in results.frames])
    place = np.array([frame.field("position")[:, 0].mean() for frame in results.frames])
    exact = 2 * SPEED / (np.pi * bar.FREQUENCY) * np.sin(bar.FREQUENCY * time)
    return 100 * np.sqrt(np.mean((place - place[0] - exact) ** 2) / np.mean(exact**2))


def frequency(results, _):
    return 100 * abs(bar.frequency(*bar.centre_velocity(results)) / bar.FREQUENCY - 1)


def advice(kept):
    cell = 0.0125
    base, linear, single, pic = (kept.point(cell=cell, **choice) for choice in ({}, {"basis": "linear"}, {"precision": "f32"}, {"transfer": "pic"}))
    one, sixteen = (kept.point(cell=0.025, basis="linear", per_cell=count)["errors"]["displacement"] for count in (1, 16))
    return (f"Where nothing moves from cell to cell, take APIC or TPIC with linear splines in single precision: at {1000 * cell:g} mm linear splines have {linear['errors']['displacement']:.2g} % and quadratic ones "
            f"{base['errors']['displacement']:.2g} %, at {linear['cpu_seconds'] / base['cpu_seconds']:.2g} of the time; single precision changes the error from {base['errors']['displacement']:.3g} to "
            f"{single['errors']['displacement']:.3g} % and the time by {single['cpu_seconds'] / base['cpu_seconds']:.2g}; one particle a cell is as good as 16 ({one:.2g} and {sixteen:.2g} % at 25 mm); "
            f"PIC damps the vibration away ({pic['errors']['displacement']:.2g} %).")


SCENE = Scene(
    title="Vibrating elastic bar",
    says="`validation/elastic_bar/bar.json` ([validation/elastic_bar](../validation/elastic_bar/README.md)): ten periods of the first mode, with a tenth of its velocity. Errors: displacement of the centre of mass, rms over the ten "
         "periods over its own rms (a phase that drifts counts, and so does damping), and frequency. FLIP is blended with 1 % of PIC at each step (the default).",
    deck=ROOT / "validation" / "elastic_bar" / "bar.json",
    end=3.45,
    frames=0.03,  # no whole part of the period, 0.345 s
    gauges=0.001,
    blocks=(Block((0.025, 0.1 / 6, 0.0125)), Block((0.025,), (1, 9, 16)), Block((0.1 / 12,), curves=CHOSEN)),
    measures={"displacement": Measure("displacement", "%", displacement), "frequency": Measure("frequency", "%", frequency)},
    paper=Variant("apic", "quadratic", "f64", "spline", 0, 0.0125, step=1e-4),
    paper_says=NOT_THEIR_SCENE,
    advice=advice,
    settings={"/bodies/0/velocity": [f"{SPEED} * sin(1.5707963267948966 * x)", 0], "/gauges": {"momentum": {"kind": "momentum"}}},
)
