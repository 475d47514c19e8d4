"""Shallow dam break against Ritter's solution: L1 error of the depth profile over the water's volume."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, depth_profile, np, plt  # noqa: E402

DEPTH, GATE = 0.1, 1.0  # H0 and L0, m


def ritter(x, time):
    """h = (4 / 9g) (√(g H0) − x / 2t)² between −t √(g H0) and 2 t √(g H0), x from the gate (Ritter 1892; SWASHES, Delestre et al. 2013, 4.1.1)."""
    speed = np.sqrt(GRAVITY * DEPTH)
    fan = 4 / (9 * GRAVITY) * (speed - x / (2 * time)) ** 2
    return np.where(x < -time * speed, DEPTH, np.where(x > 2 * time * speed, 0, fan))


def error(results, time, width=None):
    """Σ|h − h_Ritter| Δx / (H0 L0), from the depths of columns `width` wide (a cell unless given)."""
    frame = results.frame_at(time)
    x, depth = depth_profile(frame, results.deck, width=width)
    width = x[1] - x[0]
    return np.abs(depth - ritter(x - GATE, frame.time)).sum() * width / (DEPTH * GATE)


def draw(check, runs, times):
    figure, axes = plt.subplots(len(times), 1, figsize=(8, 2.1 * len(times)), sharex=True, layout="constrained")
    for at, time in zip(axes, times):
        for name, results in runs.items():
            frame = results.frame_at(time)
            at.plot(*depth_profile(frame, results.deck), lw=1, label=name)
        x = np.linspace(0, 2, 800)
        at.plot(x, ritter(x - GATE, frame.time), "k--", lw=1, label="Ritter")
        at.set_ylabel("depth  m"), at.set_title(f"t = {frame.time:g} s", fontsize=9, loc="left"), at.grid(alpha=0.3)
    axes[0].legend(fontsize=7, ncols=4), axes[-1].set_xlabel("x  m")
    check.save(figure)


def main():
    check = Check(__doc__, __file__)
    times = (0.1, 0.2, 0.3, 0.4)
    transfers = {"flip": {"/method/transfer": "flip"}, "apic": {}, "tpic": {"/method/transfer": "tpic"}}
    coarse = {"/domain/cell_size": 0.01, "/time/step": 4e-5, "/output/interval": 0.1} if check.quick else {}
    runs = {name: check.run("dam_break_2d.json", name, {**settings, **coarse}) for name, settings in transfers.items()}
    for name, results in runs.items():
        for time in (0.3, 0.4):
            check.figure("error", 100 * error(results, time), f"{name}, t = {time} s")
    if not check.quick:
        runs["apic, no tension limit"] = check.run("dam_break_2d.json", "apic_tension", {"/materials/water/tension_limit": 1e9})
        runs["apic, half the cell"] = check.run("dam_break_2d.json", "apic_fine", {"/domain/cell_size": 0.002, "/time/step": 5e-6})
    for name, results in runs.items():
        check.note(f"{name}: " + ", ".join(f"{100 * error(results, t):.2f} % at {t} s" for t in times))
    draw(check, runs, times)
    check.finish()


if __name__ == "__main__":
    main()
