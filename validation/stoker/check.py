"""Dam break on a wet bed against Stoker's solution: depth profile, and the depth, speed and bore of the stretch between the waves."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import GRAVITY, Check, depth_profile, np, plt  # noqa: E402

LEFT, RIGHT, GATE = 0.1, 0.02, 1.5  # depths hl and hr, place of the gate, m
TIMES = (0.4, 0.8)


class Stoker:
    """Stoker 1957; SWASHES, Delestre et al. 2013, section 4.1.2. x counts from the gate."""

    def __init__(self):
        fast = np.sqrt(GRAVITY * LEFT)
        # −8 g hr c² (√(g hl) − c)² + (c² − g hr)² (c² + g hr) = 0 for c between √(g hr) and √(g hl), by bisection.
        low, high = np.sqrt(GRAVITY * RIGHT), fast
        for _ in range(80):
            c = 0.5 * (low + high)
            rest = -8 * GRAVITY * RIGHT * c**2 * (fast - c) ** 2 + (c**2 - GRAVITY * RIGHT) ** 2 * (c**2 + GRAVITY * RIGHT)
            low, high = (c, high) if rest < 0 else (low, c)
        self.fast, self.c = fast, c
        self.depth, self.speed = c**2 / GRAVITY, 2 * (fast - c)
        self.bore = 2 * c**2 * (fast - c) / (c**2 - GRAVITY * RIGHT)

    def profile(self, x, time):
        fan = 4 / (9 * GRAVITY) * (self.fast - x / (2 * time)) ** 2
        parts = [x < -time * self.fast, x < time * (2 * self.fast - 3 * self.c), x < time * self.bore]
        return np.select(parts, [LEFT, fan, self.depth], RIGHT)

    def plateau(self, time, margin):
        """Ends of the stretch of constant depth, `margin` (of its length) away from both waves."""
        a, b = GATE + time * (2 * self.fast - 3 * self.c), GATE + time * self.bore
        return a + margin * (b - a), b - margin * (b - a)


def bore_place(x, depth):
    """Farthest crossing, from above, of the mean of the depths on both sides of the bore."""
    level = 0.5 * (stoker.depth + RIGHT)
    i = np.flatnonzero((depth[:-1] >= level) & (depth[1:] < level))[-1]
    return x[i] + (depth[i] - level) / (depth[i] - depth[i + 1]) * (x[i + 1] - x[i])


stoker = Stoker()


def main():
    check = Check(__doc__, __file__)
    results = check.run("dam.json", "wet_bed", {"/domain/cell_size": 0.01} if check.quick else {})
    figure, axes = plt.subplots(len(TIMES), 1, figsize=(8, 4), sharex=True, layout="constrained")
    for at, time in zip(axes, TIMES):
        frame = results.frame_at(time)
        x, depth = depth_profile(frame, results.deck, width=2 * results.deck["domain"]["cell_size"])
        error = np.abs(depth - stoker.profile(x - GATE, frame.time)).sum() * (x[1] - x[0]) / (LEFT * GATE)
        low, high = stoker.plateau(frame.time, 0.3)
        mean = depth[(x > low) & (x < high)].mean()
        place = frame.field("position")[:, 0]
        speed = frame.field("velocity")[(place > low) & (place < high), 0].mean()
        bore = (bore_place(x, depth) - GATE) / frame.time
        label = f"t = {time} s"
        check.figure("error", 100 * error, label)
        check.figure("depth", 100 * abs(mean / stoker.depth - 1), label, f"{mean:.4f} m", f"{stoker.depth:.4f} m")
        check.figure("speed", 100 * abs(speed / stoker.speed - 1), label, f"{speed:.3f} m/s", f"{stoker.speed:.3f} m/s")
        check.figure("bore", 100 * abs(bore / stoker.bore - 1), label, f"{bore:.3f} m/s", f"{stoker.bore:.3f} m/s")
        at.plot(x, depth, lw=1, label="jaxmpm"), at.plot(x, stoker.profile(x - GATE, frame.time), "k--", lw=1, label="Stoker")
        at.set_ylabel("depth  m"), at.set_title(label, fontsize=9, loc="left"), at.grid(alpha=0.3)
    axes[0].legend(fontsize=8), axes[-1].set_xlabel("x  m")
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
