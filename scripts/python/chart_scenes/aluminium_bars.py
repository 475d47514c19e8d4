"""The collapse of aluminium bars, against the measured deposit."""
from charts_scene import CHOSEN, ROOT, Block, Measure, Scene, Variant, check_of, curves, np
from support import distance_to_line, front, reference

WIDTH = 0.005  # m, columns of the depth profile, the same for all cell sizes
bars = check_of("aluminium_bars")
surface = reference("bui2008_aluminium_bars_surface.csv")
FINEST = curves(["flip"], ["quadratic"]) + curves(["apic"], ["quadratic"], ["f32"]) + curves(["flip"], ["quadratic"], ["f32"], ["mls"])
MEASURED = np.c_[surface["x_m"], surface["y_m"]]


def deposit(results, _):
    line = bars.surface_line(results.frames[-1], results.deck, WIDTH)
    return 1e3 * distance_to_line(MEASURED, line).mean()


def run_out(results, _):
    return 100 * abs(front(results.frames[-1]) / MEASURED[-1, 0] - 1)


def advice(kept):
    def point(transfer, cell, per_cell=4):
        return kept.point(transfer=transfer, precision="f32", cell=cell, per_cell=per_cell)

    def errors(transfer, key, unit):
        return ", ".join(f"{point(transfer, cell)['errors'][key]:.2g}" for cell in (0.005, 0.004, 0.0025, 0.002)) + f" {unit}"
    good, quick = point("apic", 0.005), point("flip", 0.01, 9)
    return (f"Take APIC or TPIC with quadratic splines in single precision and 5 mm cells: the surface is {good['errors']['surface']:.2g} mm off in {good['cpu_seconds']:.2g} s, and finer cells do not come nearer to the measured one (APIC "
            f"{errors('apic', 'surface', 'mm')} at 5, 4, 2.5 and 2 mm); where that is too long, FLIP with nine particles in 10 mm cells has {quick['errors']['surface']:.2g} mm in {quick['cpu_seconds']:.2g} s; "
            f"only for the run-out go on to 2 mm, with FLIP ({errors('flip', 'run_out', '%')}), for APIC runs past the measured one ({errors('apic', 'run_out', '%')}): where the error passes through zero, a small one is "
            f"in part chance. Linear splines are not for this: {sum(f['basis'] == 'linear' for f in kept.failed)} of their runs broke off.")


SCENE = Scene(
    title="Aluminium bars",
    says="`inputs/aluminium_bars.json` ([validation/aluminium_bars](../validation/aluminium_bars/README.md)). Errors: mean distance of the measured points of the surface to the computed one (depth in columns of "
         "5 mm), and run-out (99.5 % of the mass) against the measured one. FLIP without PIC, as in the deck.",
    deck=ROOT / "inputs" / "aluminium_bars.json",
    end=0.65,
    blocks=(Block((0.01, 0.005)), Block((0.01,), (1, 9, 16)), Block((0.004, 0.0025), curves=CHOSEN), Block((0.002,), curves=FINEST)),
    measures={"surface": Measure("surface", "mm", deposit), "run_out": Measure("run-out", "%", run_out)},
    paper=Variant("flip", "quadratic", "f64", "spline", 0, 0.002, step=1e-5),
    paper_says="Du & He 2025, section 4.1.2: cell size, step and FLIP are stated there; 4 particles a cell and double precision are those of the deck.",
    advice=advice,
    flip_fraction=1,
)
