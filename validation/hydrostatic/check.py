"""Material at rest: water started with hydrostatic stress stays at rest, water started without it settles to ρ g d, a sand bed does not move."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, np, plt  # noqa: E402

DEPTH, DENSITY = 0.2, 1000.0  # m, kg/m³


def layer_means(frames, cell):
    """Mean pressure of each layer of cells over the frames, Pa, and the depth of its middle, m."""
    count = int(round(DEPTH / cell))
    total, number = np.zeros(count), np.zeros(count)
    for frame in frames:
        layer = np.clip((frame.field("position")[:, 1] / cell).astype(int), 0, count - 1)
        total += np.bincount(layer, frame.field("pressure"), count)
        number += np.bincount(layer, minlength=count)
    return total / np.maximum(number, 1), DEPTH - (np.arange(count) + 0.5) * cell


def main():
    check = Check(__doc__, __file__)
    end = {"/time/end": 1.0} if check.quick else {}
    still = check.run("hydrostatic.json", "started_hydrostatic", end)
    fastest = max(np.linalg.norm(frame.field("velocity"), axis=1).max() for frame in still.frames)
    check.figure("speed", fastest / np.sqrt(GRAVITY * DEPTH))

    if not check.quick:
        settled = check.run("hydrostatic_settling.json", "started_without")
        last = [frame for frame in settled.frames if frame.time >= settled.frames[-1].time - 1.0]
        mean, depth = layer_means(last, settled.deck["domain"]["cell_size"])
        error = np.abs(mean - DENSITY * GRAVITY * depth) / (DENSITY * GRAVITY * DEPTH)
        check.figure("pressure", 100 * error.max())
        axes = plt.figure(figsize=(4.5, 4.5), layout="constrained").gca()
        axes.plot(mean, depth, "o", ms=4, label="settled, mean of the last second"), axes.plot(DENSITY * GRAVITY * depth, depth, "k", lw=1, label="ρ g d")
        axes.set(xlabel="pressure  Pa", ylabel="depth  m"), axes.invert_yaxis(), axes.legend(fontsize=8)
        check.save(axes.figure)

    bed = check.run("sand_bed.json", "sand_bed", {"/time/end": 0.3} if check.quick else {})
    start = bed.frames[0].field("position")
    moved = max(np.linalg.norm(frame.field("position") - start, axis=1).max() for frame in bed.frames)
    check.figure("sand", moved / bed.deck["domain"]["cell_size"])
    check.finish()


if __name__ == "__main__":
    main()
