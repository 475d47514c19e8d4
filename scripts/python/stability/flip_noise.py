"""Velocities that the grid does not see: what each transfer does to noise, and how much of it a body at rest gathers over a long run."""
from study import GRAVITY, SCHEMES, Study, body, box, deck, np, plt, solid, water

CELL = 0.01
SPACING = CELL / 2
NOISE = 0.01   # m/s
STEPS = 1000
HEIGHT = 0.1
REST = 20.0    # s


def alternating(scheme):
    """A free block whose particles move to and fro in turn, which sums to nothing at the nodes."""
    signs = f"{NOISE} * sin(_pi * x / {SPACING}) * sin(_pi * y / {SPACING})"
    block = body("m", box([4 * CELL, 4 * CELL], [14 * CELL, 14 * CELL]), velocity=[signs, signs])
    step = 0.4 * CELL / 10
    return deck([18 * CELL, 18 * CELL], CELL, {"m": solid("linear_elastic", 10)}, [block], STEPS * step, time={"step": step}, method=SCHEMES[scheme], samples=STEPS)


def pond(scheme):
    """Water at rest in a tank, started hydrostatic on displaced particles, for some ten thousand steps."""
    pool = body("m", box([0, 0], [2 * HEIGHT, HEIGHT]), initial_stress="hydrostatic", jitter={"fraction": 0.3})
    sound = 10 * np.sqrt(2 * GRAVITY * HEIGHT)
    return deck([2 * HEIGHT, 1.5 * HEIGHT], CELL, {"m": water(sound, tension_limit=0)}, [pool], REST, gravity=[0, -GRAVITY], method=SCHEMES[scheme], samples=200, fields=["velocity", "pressure"])


def main():
    study = Study(
        __file__, "FLIP's noise and its null space",
        "FLIP adds only the grid's change to a particle's velocity. What sums to nothing at the nodes is never seen and never damped: with flip_fraction 1 noise stays for ever and grows where the flow feeds it.",
    )  # fmt: skip
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    rows = []
    for scheme in SCHEMES:
        time, energy = study.run(alternating(scheme)).energy()
        noise = np.sqrt(energy["kinetic"] / energy["kinetic"][0])
        run = study.run(pond(scheme))
        at, rest = run.energy()
        mass = 1000 * 2 * HEIGHT**2
        speed = np.sqrt(2 * rest["kinetic"] / mass) / np.sqrt(GRAVITY * HEIGHT)
        position, pressure = run.last("position"), run.last("pressure")
        wrong = np.sqrt(np.mean((pressure - 1000 * GRAVITY * (HEIGHT - position[:, 1])) ** 2)) / (1000 * GRAVITY * HEIGHT)
        late = speed[len(speed) // 2 :]
        halved = int(np.argmax(noise < 0.5)) if (noise < 0.5).any() else None
        study.data[scheme] = {"noise_after": noise[-1], "noise_after_one_step": noise[1], "half_life_steps": halved, "rest_speed": late.mean(), "rest_speed_growth": late[-20:].mean() / speed[5:25].mean(), "rest_pressure_error": wrong, "steps_at_rest": run.summary["steps"]}
        rows.append([scheme, noise[1], noise[-1], "never" if halved is None else halved, late.mean(), study.data[scheme]["rest_speed_growth"], 100 * wrong])
        axes[0].semilogy(np.arange(len(noise)), np.maximum(noise, 1e-12), lw=1, label=scheme), axes[1].semilogy(at[1:], speed[1:], lw=0.8, label=scheme)
    axes[0].set(xlabel="steps", ylabel="rms of alternating velocities / start", ylim=(1e-6, 2)), axes[1].set(xlabel="time  s", ylabel="rms speed of water at rest / √(gH)")
    axes[0].legend(fontsize=7)
    study.draw(figure)
    steps = study.data["apic"]["steps_at_rest"]
    study.table(f"Left of alternating velocities; water at rest for {REST:g} s ({steps:,} steps)", ["transfer", "after one step", f"after {STEPS:,} steps", "steps to one half", "speed at rest / √(gH), second half", "that at the end / at the start", "pressure, rms error at the end, % of ρgH"], rows)
    one, blend, apic = study.data["flip 1"], study.data["flip 0.99"], study.data["apic"]
    study.finish(
        f"flip_fraction 1 keeps {100 * one['noise_after']:.0f} % of the noise after {STEPS:,} steps, 0.99 halves it in {blend['half_life_steps']} steps", "cured by the default (apic); `check` advises against 1",
        f"Of velocities that alternate from particle to particle FLIP with fraction 1 still has {100 * one['noise_after']:.0f} % after {STEPS:,} steps; with 0.99 half is gone after {blend['half_life_steps']} steps; PIC, APIC and TPIC have {100 * apic['noise_after_one_step']:.2g} % after a single one. "
        f"Water at rest moves at {one['rest_speed']:.2g} √(gH) with fraction 1, at {blend['rest_speed']:.2g} with 0.99 and at {apic['rest_speed']:.2g} with APIC.",
    )  # fmt: skip
