"""What a scene of the speed–accuracy charts is, and the variants of its grid. Each scene is one file in chart_scenes/ that defines SCENE."""
import dataclasses
import importlib.util
import itertools
import json
import pathlib
import sys
import typing

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = pathlib.Path(__file__).resolve().parent / "chart_scenes"
sys.path[:0] = [str(ROOT / "validation"), str(ROOT / "validation" / "pressure")]

from roughness import roughness  # noqa: E402, F401
from support import depth_profile, np  # noqa: E402

TRANSFERS, BASES, PRECISIONS, GRADIENTS = ("pic", "flip", "apic", "tpic"), ("linear", "quadratic", "cubic"), ("f32", "f64"), ("spline", "mls")
AVERAGING = 0.9  # /method/volume_averaging of the curves that have it
# Of the paper's configuration, where the scene is none of the paper's.
NOT_THEIR_SCENE = ("Du & He 2025 do not have this scene: their scheme, basis and particles per cell, and a fixed step of a tenth of what a wave takes to cross a cell, "
                   "as in their aluminium bars.")


def curves(transfers=TRANSFERS, bases=BASES, precisions=PRECISIONS, gradients=GRADIENTS[:1], averaging=(0,)):
    """(transfer, basis, precision, gradient, volume averaging) of every combination."""
    return tuple(itertools.product(transfers, bases, precisions, gradients, averaging))


EVERY = curves() + curves(TRANSFERS[1:], BASES[1:], gradients=["mls"])
AVERAGED = curves(TRANSFERS[1:], BASES[1:2], averaging=[AVERAGING])
# Those that fine cells are spent on, and the finest.
CHOSEN = curves(TRANSFERS[1:], ["quadratic"]) + curves(["apic"], ["linear", "cubic"], ["f32"]) + curves(["flip", "apic"], ["quadratic"], ["f32"], ["mls"])
FINEST = curves(TRANSFERS[2:], ["quadratic"]) + curves(["apic"], ["quadratic"], ["f32"], ["mls"])


@dataclasses.dataclass(frozen=True)
class Variant:
    """One way to compute a scene; `step` is a fixed step in s, or "auto"."""
    transfer: str
    basis: str
    precision: str
    gradient: str
    averaging: float
    cell: float
    per_cell: int = 4
    step: float | str = "auto"

    @property
    def name(self):
        fixed = "" if self.step == "auto" else f"_step{self.step:g}"
        averaged = f"_averaged{self.averaging:g}" if self.averaging else ""
        return f"{self.transfer}_{self.basis}_{self.precision}_{self.gradient}_{self.cell:g}_{self.per_cell}{averaged}{fixed}"


@dataclasses.dataclass(frozen=True)
class Block:
    """A part of the grid: every curve at every cell size (m) with every number of particles per cell."""
    cells: tuple
    per_cell: tuple = (4,)
    curves: tuple = EVERY

    def variants(self):
        return [Variant(*curve, cell, count) for cell in self.cells for count in self.per_cell for curve in self.curves]


@dataclasses.dataclass(frozen=True)
class Measure:
    """An error: of(results, results of the reference run) in `unit`."""
    label: str
    unit: str
    of: typing.Callable


@dataclasses.dataclass(frozen=True)
class Scene:
    title: str
    says: str        # what the scene is and how its errors are measured: a paragraph of the page
    deck: pathlib.Path
    end: float       # s
    blocks: tuple
    measures: dict   # key → Measure; the Pareto front goes by the first
    paper: Variant   # the numerical choices of Du & He 2025
    paper_says: str  # where they come from
    advice: typing.Callable  # Kept (charts_data) → a sentence with its evidence
    reference: Variant | None = None  # a run that others are compared with
    frames: float | None = None       # s between frames; only the last one otherwise
    gauges: float | None = None       # s between values of gauges; as frames otherwise
    fields: tuple = ("velocity",)     # of the frames, beside positions
    flip_fraction: float = 0.99
    cost: str = "cpu_seconds"  # what front and rival go by: that, or "particle_steps" where something else than the method takes the time
    settings: dict = dataclasses.field(default_factory=dict)  # further assignments by pointer

    def variants(self):
        return list(dict.fromkeys(variant for block in self.blocks for variant in block.variants()))

    def assignments(self, variant):
        """The deck's values by pointer that make it this variant."""
        method = {"transfer": variant.transfer, "basis": variant.basis, "precision": variant.precision, "gradient": variant.gradient,
                  "volume_averaging": variant.averaging}
        if variant.transfer == "flip":
            method["flip_fraction"] = self.flip_fraction
        frames = self.frames or self.end
        whole = {
            "/domain/cell_size": variant.cell, "/bodies/0/particles_per_cell": variant.per_cell, "/method": method,
            "/time": {"end": self.end, "step": variant.step},
            "/output": {"interval": frames, **({"gauge_interval": self.gauges} if self.gauges else {}), "formats": ["hdf5"], "fields": list(self.fields)},
            **self.settings,
        }
        return {pointer: json.dumps(value) for pointer, value in whole.items()}

    def reduced(self):
        """The scene on a grid of seconds: APIC and FLIP at the two largest cell sizes, the paper's choices and the reference made as coarse."""
        cells = sorted({variant.cell for variant in self.variants()}, reverse=True)[:3]
        block = Block(cells[:2], curves=curves(["apic", "flip"], ["quadratic"]))
        coarser = cells[1] / self.paper.cell
        paper = dataclasses.replace(self.paper, cell=cells[1], step=self.paper.step * coarser)
        reference = self.reference and dataclasses.replace(self.reference, cell=cells[2])
        return dataclasses.replace(self, blocks=(block,), paper=paper, reference=reference)


def scenes():
    """Name → scene, by the files of chart_scenes/."""
    return {path.stem: _module(path).SCENE for path in sorted(FOLDER.glob("*.py"))}


def check_of(case):
    """The check of a validation case as a module: its closed forms and measures."""
    return _module(ROOT / "validation" / case / "check.py")


def profile_distance(results, reference, time, width):
    """Σ|h − h'| Δx / Σ h' Δx of the depth profiles of two runs, in columns `width` wide (m)."""
    depth, other = (depth_profile(run.frame_at(time), run.deck, width=width)[1] for run in (results, reference))
    return np.abs(depth - other).sum() / other.sum()


def _module(path):
    spec = importlib.util.spec_from_file_location(f"{path.parent.name}_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
