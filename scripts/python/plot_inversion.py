"""Pictures of an inversion of jaxmpm: loss and unknowns over the iterations, and the data beside the best run, from inversion.json and .h5; beside the truth of a twin experiment also what was found
of it."""
import json
import pathlib

import h5py
import matplotlib
import numpy as np

from results import Results

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402


def find(path):
    """inversion.json, where `path` is it, inversion.h5 beside it, or a folder that holds it and no results; None otherwise."""
    path = pathlib.Path(path)
    if path.name in ("inversion.json", "inversion.h5"):
        return path.with_name("inversion.json")
    if path.is_dir() and (path / "inversion.json").exists() and not (path / "results.h5").exists():
        return path / "inversion.json"
    return None


def draw(history):
    """Loss above; below, each number with the standard error of its final value."""
    iterations = history["iterations"]
    count = range(1, len(iterations) + 1)
    names = list(iterations[0]["unknowns"]) if iterations else []
    figure, axes = plt.subplots(1 + len(names), 1, figsize=(8, 2.6 + 1.9 * len(names)), squeeze=False, sharex=True, layout="constrained")
    figure.suptitle(history.get("title") or "Inversion", fontsize=11)
    axes[0, 0].semilogy(count, [max(one["loss"], 1e-300) for one in iterations], ".-", lw=1.1)
    axes[0, 0].set_ylabel("loss"), axes[0, 0].grid(alpha=0.3)
    for at, name in zip(axes[1:, 0], names):
        at.plot(count, [one["unknowns"][name] for one in iterations], ".-", lw=1.1)
        found = history["unknowns"][name]
        at.axhline(found["value"], color="k", lw=0.8, ls="--")
        if found["standard_error"]:
            low, high = found["value"] - found["standard_error"], found["value"] + found["standard_error"]
            at.axhspan(low, high, color="k", alpha=0.15)
        at.set_title(name, fontsize=8, loc="left"), at.grid(alpha=0.3)
    axes[-1, 0].set_xlabel("iteration")
    return figure


def comparisons(path):
    """Data beside the readings of the best run, observation by observation; none while the search goes on."""
    with h5py.File(path.with_name("inversion.h5"), "r") as file:
        group = file.get("observations", {})
        return [{key: one[key][...] for key in one} for _, one in sorted(group.items(), key=lambda item: int(item[0]))]


def draw_fit(found):
    """Each observation: a profile over its first coordinate, a gauge over time, paths of particles by what is left of them over time."""
    figure, axes = plt.subplots(len(found), 1, figsize=(8, 3 * len(found)), squeeze=False, layout="constrained")
    for number, (at, one) in enumerate(zip(axes[:, 0], found)):
        profile, many = "at" in one, len(np.unique(one["subject"])) > 1
        along = one["at"][:, 0] if profile else one["time"]
        order = np.argsort(along, kind="stable")
        for k in range(one["observed"].shape[1]):
            if many and not profile:
                at.plot(along, one["read"][:, k] - one["observed"][:, k], ".", ms=2, color=f"C{k}", label=f"read minus observed, {'xyz'[k]}")
                continue
            spread = one["sigma"][order] if np.any(one["sigma"] != 1) else None
            at.errorbar(along[order], one["observed"][order, k], yerr=spread, fmt="o", ms=4, color="k", label="observed" if k == 0 else None)
            at.plot(along[order], one["read"][order, k], ".-", color=f"C{k}", label="best run")
        at.set_title(f"observation {number}: rms {np.sqrt(np.nanmean((one['read'] - one['observed']) ** 2)):.3g}", fontsize=9, loc="left")
        at.set_ylabel("height  m" if profile else "value"), at.set_xlabel("x  m" if profile else "time  s"), at.legend(fontsize=8), at.grid(alpha=0.3)
    return figure


def number_at(deck, pointer):
    """The number of a deck at a JSON pointer; None where it has none."""
    for key in pointer.strip("/").split("/"):
        deck = deck[int(key)] if isinstance(deck, list) else deck.get(key) if isinstance(deck, dict) else None
    return deck if isinstance(deck, (int, float)) else None


def initial_velocities(path, truth):
    """By body: positions, velocities found, and the truth's at the start of its run, in the order of ids."""
    start = truth.frames[0]
    if start.time != 0:
        raise SystemExit(f"{truth.path} has no frame at the start, from which to compare initial velocities")
    with h5py.File(path.with_name("inversion.h5"), "r") as file:
        found = {name: (body["position"][...], body["velocity"][...]) for name, body in file["bodies"].items() if name in start.bodies}
    return {name: (position, velocity, start.field("velocity", name)) for name, (position, velocity) in found.items()}


def relative_error(velocity, true):
    """||found - true|| / ||true|| over the initial particles."""
    return np.linalg.norm(velocity - true) / np.linalg.norm(true)


def compare_numbers(history, truth):
    """Prints each number beside the truth's."""
    for pointer, found in history["unknowns"].items():
        true = number_at(truth.deck, pointer) if isinstance(found["value"], (int, float)) else None
        if true is not None:
            print(f"{pointer}: found {found['value']:.6g}, true {true:.6g}, difference {found['value'] - true:.2g}")


def draw_profiles(bodies):
    """First component of the initial velocity over the height, found and true."""
    figure, axes = plt.subplots(1, len(bodies), figsize=(4.8 * len(bodies), 4.2), squeeze=False, layout="constrained")
    for at, (name, (position, velocity, true)) in zip(axes[0], bodies.items()):
        at.plot(true[:, 0], position[:, -1], ".", ms=3, color="0.6", label="truth")
        at.plot(velocity[:, 0], position[:, -1], ".", ms=2, label="found")
        at.set_title(f"{name}: relative error {relative_error(velocity, true):.2%}", fontsize=10, loc="left")
        at.set_xlabel("initial velocity, x  m/s"), at.set_ylabel("height  m"), at.legend(), at.grid(alpha=0.3)
    return figure


def compare(path, history, truth, folder):
    """What a twin experiment found of the truth: numbers, and the initial velocities where they were asked for."""
    compare_numbers(history, truth)
    if not any("/velocity/" in pointer or pointer.startswith("/parameters/") for pointer in history["unknowns"]):
        return
    bodies = initial_velocities(path, truth)
    for name, (_, velocity, true) in bodies.items():
        if velocity.shape != true.shape:
            return print(f"{name}: the truth has other particles; no velocities to compare")
        print(f"{name}: relative L2 error of the initial velocity {relative_error(velocity, true):.4g}")
    save(draw_profiles(bodies), folder / "velocity.png")


def save(figure, path):
    figure.savefig(path, dpi=130)
    plt.close(figure)
    print(path)


def main(path, out, truth=None):
    history = json.loads(path.read_text(encoding="utf-8"))
    folder = out or path.parent / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    save(draw(history), folder / "inversion.png")
    fit = comparisons(path)
    if fit:
        save(draw_fit(fit), folder / "fit.png")
    if truth:
        compare(path, history, Results(truth), folder)
