"""Pictures and an animation of any results.h5 of jaxmpm: frames.png, last.png, gauges.png and animation.gif; of an inversion.json: inversion.png."""
import argparse
import pathlib
import sys

import matplotlib
import numpy as np

import pictures
import plot_inversion
from results import Results

matplotlib.use("Agg")
import matplotlib.animation as animation  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/plot", description=__doc__)
    parser.add_argument("results", help="results.h5 or inversion.json, or the folder that holds it")
    parser.add_argument("--field", help="colour by this field: speed (default), pressure, plastic_strain, body, …")
    parser.add_argument("--times", type=float, nargs="+", metavar="S", help="times of frames.png, s (default: four over the run)")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="range of the colours (default: that of all frames)")
    parser.add_argument("--out", type=pathlib.Path, help="folder for the pictures (default: pictures/ beside the results)")
    parser.add_argument("--deck-directory", type=pathlib.Path, default=ROOT / "inputs", help="folder of the deck, where its terrain is looked for (default: inputs/)")
    parser.add_argument("--truth", metavar="RESULTS", help="with inversion.json: results.h5 of the run that was observed; says how far off the values found are")
    parser.add_argument("--no-animation", action="store_true", help="only the pictures")
    parser.add_argument("--animation-frames", type=int, default=80, metavar="N", help="at most so many frames in the animation")
    parser.add_argument("--fps", type=int, default=12, help="frames of the animation a second")
    return parser.parse_args()


def views(results):
    """Pairs of axes to look at: the plane itself in 2D; a side view and a top view in 3D."""
    if results.dimension == 2:
        return [(0, 1)]
    up = int(np.argmax(np.abs(results.deck["gravity"])))
    level = [a for a in range(3) if a != up]
    return [(level[0], up), tuple(level)]


def draw(axes, frame, results, field, limits, box, pair):
    if results.dimension == 2:
        return pictures.draw_2d(axes, frame, results, field, limits, box)
    return pictures.draw_3d(axes, frame, results, field, limits, box, pair)


def panel_grid(results, count, boxes):
    """Figure and axes: one row for each time, one column for each view, sized to the shape of what is shown."""
    ratios = [(b[1][1] - b[1][0]) / (b[0][1] - b[0][0]) for b in boxes]
    width = 9.0 / len(boxes)
    height = max(ratios) * width * 0.88 + 0.7
    while count * height > 16 and width > 2.5:
        width, height = width * 0.9, max(ratios) * width * 0.8 + 0.7
    figure, axes = plt.subplots(count, len(boxes), figsize=(width * len(boxes) + 1.6, count * height + 0.4), squeeze=False, layout="constrained")
    return figure, axes


def draw_frames(frames, results, field, limits, boxes):
    figure, axes = panel_grid(results, len(frames), boxes)
    figure.suptitle(results.deck.get("title") or results.directory.name, fontsize=11)
    figure.canvas.draw()
    for row, frame in zip(axes, frames):
        for at, pair, box in zip(row, views(results), boxes):
            drawn = draw(at, frame, results, field, limits, box, pair)
            at.set_title(f"t = {frame.time:.4g} s", fontsize=9, loc="left")
    figure.colorbar(drawn, ax=axes, label=pictures.LABELS.get(field, field), fraction=0.03, pad=0.01)
    return figure


def draw_gauges(results, names):
    figure, axes = plt.subplots(len(names), 1, figsize=(8, 2.2 * len(names)), squeeze=False, sharex=True, layout="constrained")
    for at, name in zip(axes[:, 0], names):
        time, value = results.gauge(name)
        labels = results.gauge_components(name)
        if len(time) == 0:  # nothing was ever there
            at.text(0.5, 0.5, "no reading", transform=at.transAxes, ha="center", color="0.5")
        for i, column in enumerate(value.reshape(len(time), -1).T if len(time) else []):
            at.plot(time, column, lw=1.1, label=labels[i] if i < len(labels) else None)
        if labels:
            at.legend(fontsize=7, ncols=4)
        at.set_ylabel(name), at.grid(alpha=0.3)
    axes[-1, 0].set_xlabel("time  s")
    return figure


def animate(frames, results, field, limits, boxes, target, fps):
    """One figure whose content is drawn anew for each frame."""
    figure, axes = panel_grid(results, 1, boxes)
    drawn = draw(axes[0, 0], frames[0], results, field, limits, boxes[0], views(results)[0])
    figure.colorbar(drawn, ax=axes, label=pictures.LABELS.get(field, field), fraction=0.03, pad=0.01)

    def show(frame):
        for at, pair, box in zip(axes[0], views(results), boxes):
            at.clear()
            draw(at, frame, results, field, limits, box, pair)
        axes[0, 0].set_title(f"t = {frame.time:.3f} s", fontsize=9, loc="left")
        return []

    show(frames[0])
    figure.canvas.draw()
    writer = animation.PillowWriter(fps=fps)
    animation.FuncAnimation(figure, show, frames=frames, init_func=lambda: []).save(target, writer=writer, dpi=90)
    plt.close(figure)


def thinned(items, count):
    """At most `count` of them, evenly, the first and the last among them."""
    picks = np.unique(np.linspace(0, len(items) - 1, min(count, len(items))).round().astype(int))
    return [items[i] for i in picks]


def save(figure, path):
    figure.savefig(path, dpi=130)
    plt.close(figure)
    print(path)


def main():
    options = arguments()
    inversion = plot_inversion.find(options.results)
    if inversion:
        return plot_inversion.main(inversion, options.out, options.truth)
    try:
        results = Results(options.results)
    except (OSError, KeyError) as error:
        sys.exit(f"{options.results} is no results file of jaxmpm: {error}")
    if not results.frames:
        sys.exit(f"{options.results} holds no frames")
    results.deck_directory = options.deck_directory
    out = options.out or results.directory / "pictures"
    out.mkdir(parents=True, exist_ok=True)
    field = options.field or "speed"
    sample = thinned(results.frames, 9)
    limits = options.range or pictures.colour_range(sample, field)
    boxes = [pictures.view_box(results, sample, pair) for pair in views(results)]
    chosen = [results.frame_at(t) for t in options.times] if options.times else thinned(results.frames, 4)
    save(draw_frames(chosen, results, field, limits, boxes), out / "frames.png")
    save(draw_frames(results.frames[-1:], results, field, limits, boxes), out / "last.png")
    gauges = [name for name in results.gauge_names if "value" in results.gauge_datasets(name)]
    if gauges:
        save(draw_gauges(results, gauges), out / "gauges.png")
    if not options.no_animation:
        target = out / "animation.gif"
        animate(thinned(results.frames, options.animation_frames), results, field, limits, boxes, target, options.fps)
        print(target)


if __name__ == "__main__":
    main()
