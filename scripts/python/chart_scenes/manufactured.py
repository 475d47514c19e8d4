"""A neo-Hookean block that follows a prescribed motion under the body force that it takes, against the closed form."""
import json

from charts_scene import CHOSEN, NOT_THEIR_SCENE, ROOT, Block, Measure, Scene, Variant, check_of, curves

manufactured = check_of("manufactured")
solution = manufactured.Solution(2)
FINEST = curves(["apic"], ["quadratic"], ["f64"]) + curves(["apic"], ["cubic"]) + curves(["apic"], ["cubic"], ["f32"], ["mls"])


def displacement(results, _):
    return solution.errors(results)[0]


def stress(results, _):
    return solution.errors(results)[2]


def advice(kept):
    def errors(cells, **choice):
        return ", ".join(f"{kept.point(cell=cell, **choice)['errors']['displacement']:.3g}" for cell in cells) + " %"
    fine = (1 / 32, 1 / 64, 1 / 128)
    return (f"Where particles of a solid move through cells, take APIC with cubic splines in single precision: {errors(fine, basis='cubic', precision='f32')} at 1/32, 1/64 and 1/128 m, where quadratic ones, at the same cost here, stop "
            f"({errors(fine)}); up to 1/16 m quadratic ones are as good ({errors((1 / 8, 1 / 16))} against {errors((1 / 8, 1 / 16), basis='cubic')} at 1/8 and 1/16 m); linear ones do not converge "
            f"({errors((1 / 8, 1 / 16, 1 / 32), basis='linear')} at 1/8 to 1/32 m) and break off with one particle a cell; double precision buys nothing ({errors((1 / 128,), basis='cubic')} at 1/128 m).")


SCENE = Scene(
    title="Manufactured solution",
    says="`validation/manufactured/solid.json` in 2D ([validation/manufactured](../validation/manufactured/README.md)): a block of rubber of 1 m that follows a prescribed motion for 0.05 s. Errors: root mean square "
         "of displacement and stress over the particles, of their largest values. FLIP without PIC, as there. Most of the time goes into the body force, a formula of 3000 letters for each node and step: "
         "particle-steps are the cost here.",
    deck=ROOT / "validation" / "manufactured" / "solid.json",
    end=manufactured.END,
    blocks=(Block((1 / 8, 1 / 16, 1 / 32)), Block((1 / 16,), (1, 9, 16)), Block((1 / 64,), curves=CHOSEN), Block((1 / 128,), curves=FINEST)),
    measures={"displacement": Measure("displacement", "%", displacement), "stress": Measure("stress", "%", stress)},
    paper=Variant("apic", "quadratic", "f64", "spline", 0, 1 / 32, step=8.5e-5),
    paper_says=NOT_THEIR_SCENE,
    advice=advice,
    flip_fraction=1,
    cost="particle_steps",
    settings={**{pointer: json.loads(text) for pointer, text in solution.assignments.items()}, "/output": {"interval": manufactured.END, "formats": ["hdf5"], "fields": ["velocity", "stress"]}},
)
