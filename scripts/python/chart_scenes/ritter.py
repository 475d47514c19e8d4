"""Ritter's dam break, against the closed form and against a fine run."""
from charts_scene import AVERAGED, AVERAGING, CHOSEN, EVERY, FINEST, ROOT, Block, Measure, Scene, Variant, check_of, np, profile_distance, roughness

TIMES, WIDTH = (0.3, 0.4), 0.02  # s, m: columns of the depth profile, the same for all cell sizes
ritter = check_of("ritter")


def against_ritter(results, _):
    return 100 * np.mean([ritter.error(results, time, WIDTH) for time in TIMES])


def against_fine(results, reference):
    return 100 * np.mean([profile_distance(results, reference, time, WIDTH) for time in TIMES])


def noise(results, _):
    height = np.ptp(results.frames[0].field("position")[:, 1])
    return 100 * roughness([results.frame_at(time) for time in TIMES], results.deck, 1000 * 9.81 * height)


def advice(kept):
    points = [kept.point(cell=cell, precision="f32") for cell in (0.02, 0.01, 0.005)]
    steps = ", ".join(f"{p['errors']['fine']:.2g} % at {1000 * p['cell']:g} mm ({p['cpu_seconds']:.2g} s)" for p in points)
    linear, mls = (kept.point(cell=0.01, precision="f32", **choice) for choice in ({"basis": "linear"}, {"gradient": "mls"}))
    one, nine = (kept.point(cell=0.01, basis="linear", per_cell=count)["errors"]["fine"] for count in (1, 9))
    base, averaged = points[1], kept.point(cell=0.01, precision="f32", averaging=AVERAGING)
    rough, smooth = base["errors"]["noise"], averaged["errors"]["noise"]
    return (f"Take APIC or TPIC with quadratic splines in single precision and choose the cell by the error that you can bear: {steps}, where Ritter's own neglect is {points[-1]['errors']['ritter']:.2g} %; "
            f"moving least squares have the same error ({mls['errors']['fine']:.2g} % at 10 mm) in {mls['cpu_seconds'] / base['cpu_seconds']:.2g} of the time, linear splines {linear['errors']['fine']:.2g} % in "
            f"{linear['cpu_seconds'] / base['cpu_seconds']:.2g}, for their steps are shorter, and only with four particles a cell or more ({one:.2g} % with 1, {nine:.2g} % with 9). "
            f"Where pressures are read, `volume_averaging` {AVERAGING:g} brings their noise from {rough:.2g} to {smooth:.2g} % of ρgH in {averaged['cpu_seconds'] / base['cpu_seconds']:.2g} of the time, "
            f"the depth being {averaged['errors']['fine']:.2g} % off.")


SCENE = Scene(
    title="Ritter's dam break",
    says="`inputs/dam_break_2d.json` ([validation/ritter](../validation/ritter/README.md)). Errors are L1 of the depth profile over the water's volume, mean of 0.3 and 0.4 s, in columns of 20 mm: against a "
         "run with 2 mm cells, and against Ritter's closed form, which no refinement meets because it knows no vertical acceleration. Noise of the pressure: what a plane through the particles around leaves of it, rms over ρgH "
         "([validation/pressure](../validation/pressure/README.md)). FLIP is blended with 1 % of PIC at each step (the default).",
    deck=ROOT / "inputs" / "dam_break_2d.json",
    end=0.4,
    frames=0.1,
    fields=("velocity", "pressure", "density"),
    blocks=(Block((0.02, 0.01), curves=EVERY + AVERAGED), Block((0.01,), (1, 9)), Block((0.005,), curves=CHOSEN + AVERAGED), Block((0.004,), curves=FINEST + AVERAGED)),
    measures={"fine": Measure("against 2 mm cells", "%", against_fine), "ritter": Measure("against Ritter", "%", against_ritter),
              "noise": Measure("noise of the pressure", "% ρgH", noise)},
    reference=Variant("apic", "quadratic", "f64", "spline", 0, 0.002),
    paper=Variant("apic", "quadratic", "f64", "spline", 0, 0.004, step=1e-5),
    paper_says="Du & He 2025, section 4.1.1: all of it but the precision is stated there.",
    advice=advice,
)
