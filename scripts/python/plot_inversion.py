"""Picture of an inversion of jaxmpm: loss and unknowns over the iterations, from inversion.json."""
import json
import pathlib

import matplotlib

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


def main(path, out):
    history = json.loads(path.read_text(encoding="utf-8"))
    folder = out or path.parent / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    figure = draw(history)
    figure.savefig(folder / "inversion.png", dpi=130)
    plt.close(figure)
    print(folder / "inversion.png")
