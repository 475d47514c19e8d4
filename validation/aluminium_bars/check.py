"""Collapse of aluminium bars against Bui et al. (2008): final surface, failure surface and run-out."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, depth_profile, distance_to_line, front, np, plt, reference  # noqa: E402

YIELDED = 0.03  # equivalent plastic strain above which the bars have failed


def failure_line(frame, deck):
    """Top of what has not failed, by columns a cell wide: upwards from the floor to the first particle beyond YIELDED."""
    cell = deck["domain"]["cell_size"]
    position, strain = frame.field("position"), frame.field("plastic_strain")
    column = np.floor(position[:, 0] / cell).astype(int)
    line = []
    for i in range(column.max() + 1):
        inside = np.flatnonzero(column == i)
        inside = inside[np.argsort(position[inside, 1])]
        failed = np.flatnonzero(strain[inside] > YIELDED)
        if len(inside) == 0 or (len(failed) and failed[0] == 0):
            break
        line.append([(i + 0.5) * cell, position[inside[failed[0] - 1] if len(failed) else inside[-1], 1]])
    return np.array(line)


def surface_line(frame, deck, width=None):
    """Final surface as a polyline: the depth profile, of columns `width` wide (a cell unless given), from the wall to the first gap."""
    x, depth = depth_profile(frame, deck, width=width)
    end = np.argmax(depth < 1e-9) if (depth < 1e-9).any() else len(depth)
    return np.c_[x, depth][:end]


def run_out(line, thickness):
    """Where the deposit last is as thick as the last measured point of the surface."""
    thick = np.flatnonzero(line[:, 1] >= thickness)
    i = thick[-1]
    if i + 1 == len(line):
        return line[i, 0]
    (x0, d0), (x1, d1) = line[i], line[i + 1]
    return x0 + (d0 - thickness) / (d0 - d1) * (x1 - x0)


def main():
    check = Check(__doc__, __file__)
    surface, failure = (reference(f"bui2008_aluminium_bars_{what}.csv") for what in ("surface", "failure"))
    coarse = {"/domain/cell_size": 0.005, "/time/step": 2.5e-5} if check.quick else {}
    results = check.run("aluminium_bars.json", "bars", coarse)
    frame = results.frames[-1]
    line, failed = surface_line(frame, results.deck), failure_line(frame, results.deck)
    measured, measured_failure = np.c_[surface["x_m"], surface["y_m"]], np.c_[failure["x_m"], failure["y_m"]]
    check.figure("surface", 1e3 * distance_to_line(measured, line).mean())
    # The front as in the granular columns: 99.5 % of the mass lies behind it. Beyond, single bars lie apart; the depth profile, which counts them by
    # the volume that they have loosened to, is thicker than the last measured point (1.5 mm, under a cell) for a few centimetres more.
    reached = front(frame)
    check.figure("run_out", 100 * abs(reached / measured[-1, 0] - 1), "", f"{reached:.4f} m", f"{measured[-1, 0]:.4f} m")
    check.note(f"the profile is thinner than 1.5 mm from {run_out(line, measured[-1, 1]):.4f} m")
    if len(failed) > 1:
        check.note(f"mean distance to the measured failure surface: {1e3 * distance_to_line(measured_failure, failed).mean():.2f} mm")
    figure, axes = plt.subplots(figsize=(9, 3), layout="constrained")
    position = frame.field("position")
    drawn = axes.scatter(position[:, 0], position[:, 1], c=np.minimum(frame.field("plastic_strain"), 0.5), s=1, cmap="viridis", rasterized=True)
    figure.colorbar(drawn, label="plastic strain (cut at 0.5)")
    axes.plot(*measured.T, "ko", ms=4, label="surface, Bui 2008"), axes.plot(*line.T, "r", lw=1, label="surface, jaxmpm")
    axes.plot(*measured_failure.T, "ws", mec="k", ms=4, label="failure, Bui 2008"), axes.plot(*failed.T, "w--", lw=1.2, label=f"plastic strain {YIELDED}") if len(failed) else None
    axes.set(aspect="equal", xlabel="x  m", ylabel="y  m", xlim=(0, 0.55)), axes.legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
