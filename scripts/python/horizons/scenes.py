"""The scenes of the study: decks of one unknown that can be run for any number of steps."""
import dataclasses
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "stability"))

from study import GRAVITY, body, box, deck, sand, water  # noqa: E402


@dataclasses.dataclass
class Scene:
    """`deck(steps)` is the scene for so many steps; `unknown` a pointer into it, which goes through `values` while the truth is `truth`."""

    title: str
    deck: object
    step: float  # s
    unknown: str
    values: list
    truth: float
    seen: dict  # by name: the observation, as the deck's, without its file


PATHS = {"kind": "particles", "body": "m", "field": "position"}
MEAN = {"kind": "gauge", "gauge": "mean"}
PROFILE = {"kind": "profile", "body": "m"}
DEPTH = {**PROFILE, "reading": "depth"}


def spread(low, high, count=7):
    return [low + (high - low) * k / (count - 1) for k in range(count)]


def liquid(size, column, cell, step, velocity):
    def scene(steps):
        end = steps * step
        gauges = {"mean": {"kind": "region_mean", "field": "velocity", "min": [0, 0], "max": size}}
        pool = body("m", box([0, 0], column), "m", velocity=velocity, initial_stress="hydrostatic")
        return deck(size, cell, {"m": water(0.4 * cell / step, tension_limit=0)}, [pool], end, gravity=[0, -GRAVITY], time={"step": step}, method={"precision": "f64"}, gauges=gauges, samples=1, parameters={"a": 0.0})

    return scene


def column_of_sand(floor):
    def scene(steps):
        end, step = steps * 5e-5, 5e-5
        heap = body("m", box([0, 0], [0.15, 0.1]), "m", initial_stress={"k0": 0.7})
        grains = sand(26, density=2650)  # bulk modulus 1.1 MPa
        return deck([0.6, 0.15], 0.005, {"m": grains}, [heap], end, gravity=[0, -GRAVITY], time={"step": step}, method={"precision": "f64"}, gauges=(), walls={"y_min": floor}, fields=["velocity", "density"])

    return scene


# A standing wave of a pool: the potential flow of its first mode, which does not break at these speeds.
WAVE = ["-a*sin(_pi*x/0.4)*(exp(_pi*y/0.4) + exp(-_pi*y/0.4))/2", "a*cos(_pi*x/0.4)*(exp(_pi*y/0.4) - exp(-_pi*y/0.4))/2"]

SCENES = {
    "wave": Scene("Water: a standing wave in a pool", liquid([0.4, 0.3], [0.4, 0.15], 0.0125, 2.5e-4, WAVE), 2.5e-4, "/parameters/a", spread(0.02, 0.1), 0.11, {"paths": PATHS, "mean": MEAN}),
    "splash": Scene("Water: a dam break that runs up a wall and falls back", liquid([0.6, 0.6], [0.2, 0.3], 0.0125, 1.5e-4, ["a*x/0.2", 0]), 1.5e-4, "/parameters/a", spread(0.1, 0.5), 0.55, {"paths": PATHS, "mean": MEAN}),
    "sand": Scene("Sand: a column that collapses on a floor with friction", column_of_sand({"kind": "friction", "coefficient": 0.35}), 5e-5, "/materials/m/friction_angle", spread(25, 33), 24, {"paths": PATHS, "profile": PROFILE, "depth": DEPTH}),
    "sand_rough": Scene("Sand: the same on a floor that it sticks to", column_of_sand({"kind": "no_slip"}), 5e-5, "/materials/m/friction_angle", spread(25, 33), 24, {"paths": PATHS, "profile": PROFILE}),
}  # fmt: skip
