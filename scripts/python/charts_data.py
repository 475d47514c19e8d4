"""The data of a chart: points with their errors and costs, their Pareto front, and how they stand to the paper's configuration."""
import dataclasses
import json
import statistics

from charts_scene import BASES, GRADIENTS, PRECISIONS, ROOT, TRANSFERS

KEPT = ROOT / "docs" / "charts"
BASE = {"transfer": "apic", "basis": "quadratic", "precision": "f64", "gradient": "spline", "averaging": 0}  # what single choices are compared with
DOMINANT = 1 / 3  # ours dominates the paper's configuration with no larger error in less than this part of its cost
MARGIN = 0.99  # an error has to be smaller by this factor to count as smaller


@dataclasses.dataclass
class Kept:
    """The content of docs/charts/SCENE.json. A point is a dictionary: the variant's fields, its cost, and `errors` by measure."""
    scene: str
    form: str
    date: str
    machine: str
    points: list
    paper: dict
    reference: dict | None
    failed: list
    cost: str = "cpu_seconds"  # what points are compared by, as in Scene

    def point(self, **wanted):
        """The point with these fields; those of BASE and 4 particles per cell unless said otherwise."""
        wanted = {**BASE, "per_cell": 4, **wanted}
        return next(point for point in self.points if all(point[key] == value for key, value in wanted.items()))

    def front(self, measure):
        """Points that no other beats in cost and error, from fast to accurate; errors closer than MARGIN count as the same."""
        front = []
        for point in sorted(self.points, key=lambda p: (p[self.cost], p["errors"][measure])):
            if not front or point["errors"][measure] < MARGIN * front[-1]["errors"][measure]:
                front.append(point)
        return front

    def rival(self, measure):
        """The cheapest point whose error is at most that of the paper's configuration; None where there is none."""
        good = (point for point in self.points if point["errors"][measure] <= self.paper["errors"][measure])
        return min(good, key=lambda point: point[self.cost], default=None)

    def dominates(self, measure):
        rival = self.rival(measure)
        return rival is not None and rival[self.cost] < DOMINANT * self.paper[self.cost]

    def choices(self, measures):
        """(key, value, count, time ratio, error ratios) of each choice beside BASE: medians over points that differ in nothing else."""
        averaging = sorted({point["averaging"] for point in self.points})
        for key, values in (("transfer", TRANSFERS), ("basis", BASES), ("precision", PRECISIONS), ("gradient", GRADIENTS), ("averaging", averaging)):
            for value in values:
                pairs = [] if value == BASE[key] else list(self._pairs(key, value))
                if pairs:
                    errors = [statistics.median(own["errors"][m] / base["errors"][m] for own, base in pairs) for m in measures]
                    yield key, value, len(pairs), statistics.median(own["cpu_seconds"] / base["cpu_seconds"] for own, base in pairs), errors

    def _pairs(self, key, value):
        """(point, point that differs from it only in having the base's value of `key`), the other choices being the base's."""
        wanted = {**BASE, key: value}
        for own in self.points:
            if all(own[k] == v for k, v in wanted.items()):
                for base in self.points:
                    if all(base[k] == v for k, v in BASE.items()) and (base["cell"], base["per_cell"]) == (own["cell"], own["per_cell"]):
                        yield own, base

    def write(self, folder):
        """One line for each point, so that the file can be read and compared."""
        folder.mkdir(parents=True, exist_ok=True)
        whole = dataclasses.asdict(self)
        lines = [f" {json.dumps(key)}: {_text(value)}" for key, value in whole.items()]
        (folder / f"{self.scene}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def _text(value):
    if isinstance(value, list) and value:
        return "[\n" + ",\n".join(f"  {json.dumps(item, ensure_ascii=False)}" for item in value) + "\n ]"
    return json.dumps(value, ensure_ascii=False)


def read(scene, folder=KEPT):
    """The kept data of a scene, None where there is none."""
    path = folder / f"{scene}.json"
    return Kept(**json.loads(path.read_text(encoding="utf-8"))) if path.is_file() else None
