"""Calibration from data that are not the model's own: α and four coefficients of friction from runs with half the cell, another transfer, and noise."""
import json
import pathlib
import shutil
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

PARTICLES, NOISE = 100, 0.01  # observed; of the root mean square displacement
TOLD = 0.1  # largest standard error of a number that the data are said to tell
TRUTH = {
    "velocity_linear": {"/parameters/alpha": 2.0},
    "friction": {f"/walls/y_min/segments/{k}/coefficient": value for k, value in enumerate((0.0, 0.5, 0.1, 0.2))},
}
BODY = {"velocity_linear": "column", "friction": "column"}
METHOD = {"method": "gauss_newton", "iterations": 20, "tolerance": 1e-4}


def settings(check, name, half=False):
    """Cell and step of the quick or the full form; of the truth with half the cell, half of both."""
    cell, step = {"velocity_linear": (0.01, 3e-5), "friction": (0.01, 4e-5)}[name]
    scale = (2 if check.quick else 1) * (0.5 if half else 1)
    return {"/domain/cell_size": cell * scale, "/time/step": step * scale}


def paths(frames, cell):
    """Times and positions (frames, particles, 2) of the coarse lattice's particles, each the mean of the particles that started in its place."""
    start = frames[0].field("position")
    place = np.floor(start / (cell / 2)).astype(int)
    _, group = np.unique(place[:, 0] * 100000 + place[:, 1], return_inverse=True)
    count = np.bincount(group)
    mean = [np.stack([np.bincount(group, f.field("position")[:, d]) / count for d in (0, 1)], axis=1) for f in frames]
    return np.array([f.time for f in frames]), np.array(mean)


def write_data(path, truth, model, noise):
    """CSV of the paths of PARTICLES particles of the model's own ids, in the second half of the run."""
    cell = model.deck["domain"]["cell_size"]
    times, positions = paths(truth.frames, cell)
    ids, (_, own) = model.frames[0].field("id"), paths(model.frames[:1], cell)
    random = np.random.default_rng(1)
    chosen = random.choice(len(own[0]), PARTICLES, replace=False)
    at = {tuple(np.round(p, 9)): k for k, p in zip(ids, model.frames[0].field("position"))}
    late = np.flatnonzero(times >= times[-1] / 2)
    moved = positions[late][:, chosen] - positions[0][chosen]
    deviation = noise * np.sqrt((moved**2).sum(axis=2).mean())
    rows = []
    for f in late:
        for k in chosen:
            x, y = positions[f, k] + deviation * random.standard_normal(2)
            rows.append(f"{times[f]:.12g},{at[tuple(np.round(own[0][k], 9))]},{x:.12g},{y:.12g}")
    path.write_text("time,id,x,y\n" + "\n".join(rows) + "\n", encoding="utf-8")


def estimates(inversion):
    """Value and standard error by pointer, and whether the report says that what is left is no noise, so that standard errors do not hold."""
    report = json.loads(inversion.read_text())
    warned = any(one["noise"] is False for one in report["observations"])
    return {pointer: (one["value"], one["standard_error"]) for pointer, one in report["unknowns"].items()}, warned


def invert(check, name, case, data):
    """estimates() of the inversion."""
    out = check.out / f"{name}_{case}"
    observation = [{"kind": "particles", "body": BODY[name], "field": "position", "file": str(data)}]
    deck = pathlib.Path(check.folder).parents[1] / "inputs" / f"invert_{name}.json"
    result = out / "inversion.json"
    if check.reuse and result.is_file() and json.loads(result.read_text())["stopped"] in ("converged", "iterations", "stalled"):
        return estimates(result)
    shutil.rmtree(out, ignore_errors=True)
    words = [str(check.program), "invert", str(deck), "-o", str(out), "--threads", "1", "-q"]
    for pointer, value in {**settings(check, name), "/inverse/observations": observation, "/inverse/optimizer": METHOD}.items():
        words += ["--set", f"{pointer}={json.dumps(value)}"]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        sys.exit(f"  {name}, {case}: exit {done.returncode}\n{done.stdout}")
    return estimates(result)


def main():
    check = Check(__doc__, __file__)
    figure, axes = plt.subplots(1, 2, figsize=(9, 3), layout="constrained", width_ratios=(1, 3))
    for place, (name, truth) in zip(axes, list(TRUTH.items())[: 1 if check.quick else 2]):
        many = {"/output/interval": 0.005, "/output/formats": '["hdf5"]'}
        model = check.run(f"truth_{name}.json", f"{name}_own", {**settings(check, name), **many})
        cases = {"noise": (model, NOISE)}
        cases |= {} if check.quick else {
            "half the cell": (check.run(f"truth_{name}.json", f"{name}_half", {**settings(check, name, half=True), **many}), 0),
            "tpic": (check.run(f"truth_{name}.json", f"{name}_tpic", {**settings(check, name), **many, "/method/transfer": "tpic"}), 0),
            "flip": (check.run(f"truth_{name}.json", f"{name}_flip", {**settings(check, name), **many, "/method/transfer": "flip"}), 0),
        }
        for number, (case, (source, noise)) in enumerate(cases.items()):
            data = check.out / f"{name}_{case.replace(' ', '_')}.csv"
            write_data(data, source, model, noise)
            found, warned = invert(check, name, case.replace(" ", "_"), data)
            apart = {p: abs(found[p][0] - value) for p, value in truth.items()}
            inside = all(apart[p] <= 3 * (found[p][1] or 0) + 1e-6 for p in truth)
            values = ", ".join(f"{found[p][0]:.4f} ± {found[p][1] or 0:.1g}" for p in truth)
            said = "the report says that what is left is no noise" if warned else "the report takes what is left for noise"
            check.note(f"{name}, {case}: {values}; {'within' if inside else 'NOT within'} three standard errors; {said}")
            label = f"{name.replace('_', ' ')}, {case}"
            if case == "noise":
                check.holds("noise", inside and not warned, label)
            else:
                check.holds("told", inside or warned, label)
            told = [p for p in truth if (found[p][1] or 0) < TOLD]  # the data say something of it
            if len(told) < len(truth):
                check.note(f"{label}: {len(truth) - len(told)} of {len(truth)} numbers are not told by the data (standard error above {TOLD}); the figure is of the others")
            check.figure("alpha" if name == "velocity_linear" else "friction", max(apart[p] for p in told), label, values, ", ".join(f"{v:g}" for v in truth.values()))
            index = np.arange(len(truth))
            place.errorbar(index + 0.12 * (number - 1.5), [found[p][0] for p in truth], [3 * (found[p][1] or 0) for p in truth], fmt="o", ms=4, capsize=2, label=case)
        place.plot(np.arange(len(truth)), list(truth.values()), "k_", ms=30, label="true"), place.legend(fontsize=7)
        place.set(title={"velocity_linear": "α", "friction": "friction of four stretches"}[name], xticks=range(len(truth)))
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
