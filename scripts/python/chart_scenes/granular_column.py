"""The collapse of a granular column as high as it is wide, against a fine run."""
from charts_scene import CHOSEN, ROOT, Block, Measure, Scene, Variant, np, profile_distance

END, WIDTH, BASE = 1.0, 0.02, 0.14  # s; m: columns of the depth profile, the same for all cell sizes; m: L0


def deposit(results, reference):
    return 100 * profile_distance(results, reference, END, WIDTH)


def run_out(results, reference):
    """Of 99.5 % of the mass that hangs together with the deposit, as in the validation case: the deck's gauge."""
    ends = [np.ravel(run.gauge("front")[1])[-1] - BASE for run in (results, reference)]
    return 100 * abs(ends[0] / ends[1] - 1)


def advice(kept):
    def errors(key, **choice):
        return ", ".join(f"{kept.point(precision='f32', cell=cell, **choice)['errors'][key]:.2g}" for cell in (0.01, 0.005, 0.0025)) + " %"
    seconds = ", ".join(f"{kept.point(transfer='flip', precision='f32', cell=cell)['cpu_seconds']:.2g}" for cell in (0.01, 0.005, 0.0025))
    flip, apic = (kept.point(transfer=transfer, precision="f32", cell=0.01, per_cell=16)["errors"]["deposit"] for transfer in ("flip", "apic"))
    return (f"Take FLIP without PIC, with quadratic splines in single precision: the deposit is {errors('deposit', transfer='flip')} off at 10, 5 and 2.5 mm ({seconds} s), with APIC {errors('deposit')} at the same cost, though the "
            f"reference is APIC's; the run-out, {errors('run_out', transfer='flip')}, asks for 5 mm. More particles in a cell help FLIP ({flip:.2g} % with 16 in 10 mm) and not APIC ({apic:.2g} %). Linear splines are not for this: "
            f"{sum(f['basis'] == 'linear' for f in kept.failed)} of their runs broke off.")


SCENE = Scene(
    title="Granular column",
    says="`inputs/granular_column_a1.json` ([validation/granular_columns](../validation/granular_columns/README.md)) until 1 s. Errors are against a run with 1.25 mm cells: L1 of the depth profile of the "
         "deposit over its volume, in columns of 20 mm, and run-out of the deck's gauge (99.5 % of the mass that hangs together; loose grains that run ahead differ by a quarter between runs and are left out). FLIP without PIC, as in the aluminium bars.",
    deck=ROOT / "inputs" / "granular_column_a1.json",
    end=END,
    blocks=(Block((0.02, 0.01, 0.005)), Block((0.01,), (1, 9, 16)), Block((0.0025,), curves=CHOSEN)),
    measures={"deposit": Measure("deposit", "%", deposit), "run_out": Measure("run-out", "%", run_out)},
    reference=Variant("apic", "quadratic", "f64", "spline", 0, 0.00125),
    paper=Variant("apic", "quadratic", "f64", "spline", 0, 0.0025, step=1e-5),
    paper_says="Du & He 2025, section 4.2.2 and table 1: cell size, step and 4 particles a cell and plane (8 in their 3D); their scheme is not stated for this scene.",
    advice=advice,
    flip_fraction=1,
)
