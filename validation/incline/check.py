"""Block on an incline of 25° with Coulomb friction: slides with g (sin θ − μ cos θ) where tan θ > μ, sticks where not."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, np, plt  # noqa: E402

ANGLE = np.radians(25)
SLIDES, STICKS = 0.3, 0.6  # coefficients below and above tan 25° = 0.466
KINDS = {"wall": "/walls/y_min/coefficient", "polygon": "/obstacles/0/coefficient", "height_map": "/obstacles/0/coefficient"}


def down_the_plane(kind):
    return np.array([1.0, 0.0]) if kind == "wall" else np.array([np.cos(ANGLE), -np.sin(ANGLE)])


def motion(results, kind):
    """(time, mean velocity, mean displacement) along the plane."""
    along = down_the_plane(kind)
    start = results.frames[0].field("position").mean(axis=0)
    rows = [(f.time, f.field("velocity").mean(axis=0) @ along, (f.field("position").mean(axis=0) - start) @ along) for f in results.frames]
    return np.array(rows).T


def acceleration(results, kind):
    time, velocity, _ = motion(results, kind)
    late = time >= 0.2 * time[-1]  # the block is set down on the plane and rings at first
    return np.polyfit(time[late], velocity[late], 1)[0]


def penetration(results):
    """Deepest particle below the plane y = (2 − x) tan 25° over all frames, m."""
    deepest = 0.0
    for frame in results.frames:
        x, y = frame.field("position").T
        deepest = max(deepest, ((2 - x) * np.sin(ANGLE) - y * np.cos(ANGLE)).max())
    return deepest


def main():
    check = Check(__doc__, __file__)
    theory = GRAVITY * (np.sin(ANGLE) - SLIDES * np.cos(ANGLE))
    cells = (0.02,) if check.quick else (0.04, 0.02, 0.01)
    figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
    for kind, coefficient in KINDS.items():
        for cell in cells:
            results = check.run(f"incline_block_{kind}.json", f"{kind}_slides_{cell}", {"/domain/cell_size": cell, coefficient: SLIDES})
            found, label = acceleration(results, kind), f"{kind.replace('_', ' ')}, cell {cell} m"
            check.figure("wall" if kind == "wall" else "obstacle", 100 * abs(found / theory - 1), label, f"{found:.4f} m/s²", f"{theory:.4f} m/s²")
            if cell == 0.02:
                axes.plot(*motion(results, kind)[:2], lw=1, label=kind)
            if kind != "wall":
                check.figure("penetration", penetration(results) / cell, label)
        stuck = check.run(f"incline_block_{kind}.json", f"{kind}_sticks", {coefficient: STICKS})
        _, velocity, moved = motion(stuck, kind)
        check.figure("sticks", abs(moved[-1]) / 0.02, f"{kind.replace('_', ' ')}, μ = {STICKS}")
        axes.plot(*motion(stuck, kind)[:2], lw=1, ls=":", label=f"{kind}, coefficient {STICKS}")
    time = np.linspace(0, 0.8, 2)
    axes.plot(time, theory * time, "k--", lw=1, label="g (sin θ − μ cos θ) t")
    axes.set(xlabel="time  s", ylabel="velocity along the plane  m/s"), axes.legend(fontsize=8)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
