"""Gradients of whole runs: Taylor remainders of second order along random directions, over 1000 steps of water and of sand."""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

TRUTH = {"/bodies/0/velocity/0/mlp/seed": 7}  # another velocity field than that where the gradient is taken


def checked_gradient(check, deck, name, assignments, directions):
    """What `jaxmpm gradient --check` finds; the data are positions of a run with another velocity."""
    check.run(deck, f"{name}_truth", {**assignments, **TRUTH})
    words = [str(check.program), "gradient", str(check.folder / deck), "--check", "--json", "--threads", "1", "--directions", str(directions)]
    for pointer, value in {**assignments, "/inverse/observations/0/file": json.dumps(str(check.out / f"{name}_truth" / "results.h5"))}.items():
        words += ["--set", f"{pointer}={value}"]
    done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode not in (0, 1):
        sys.exit(f"  {name}: exit {done.returncode}\n{done.stderr}")
    found = json.loads(done.stdout)["check"]
    check.note(f"{name}: {found['summary']}; {found['particle_steps_at_kinks']} of {found['particle_steps']} particle-steps at kinks")
    return found


def second_order(found):
    """Share of the directions whose remainder has a slope of 2 ± 0.1 over three decades, in %."""
    return 100 * np.mean([abs(one["slope"] - 2) <= 0.1 for one in found["directions"]])


def difference(found):
    """Largest difference of the adjoint's g·d from that of forward runs, over the root mean square of all g·d."""
    derivative, other = (np.array([one[key] for one in found["directions"]]) for key in ("derivative", "difference"))
    return np.abs(derivative - other).max() / np.sqrt(np.mean(derivative**2))


def draw(check, cases):
    picture, axes = plt.subplots(1, len(cases), figsize=(3.3 * len(cases), 3.3), layout="constrained", sharey=True)
    for name, found, place in zip(cases, cases.values(), axes):
        for one in found["directions"]:
            remainder = np.array(one["remainders"]) / one["remainders"][0]
            place.loglog(one["steps"], remainder, lw=0.8, color="C0" if abs(one["slope"] - 2) <= 0.1 else "C3")
        steps = np.array(found["directions"][0]["steps"])
        place.loglog(steps, (steps / steps[0]) ** 2, "k--", lw=1, label="ε²")
        place.set(title=name, xlabel="ε"), place.legend(fontsize=8)
    axes[0].set(ylabel="remainder, of the first")
    check.save(picture)


def main():
    check = Check(__doc__, __file__)
    few, many = (3, 5) if check.quick else (10, 40)
    fluid = {
        "quadratic, mls": checked_gradient(check, "fluid.json", "quadratic_mls", {"/method/gradient": '"mls"'}, few),
        "cubic, spline": checked_gradient(check, "fluid.json", "cubic", {"/method/basis": '"cubic"'}, few),
        "quadratic, spline": checked_gradient(check, "fluid.json", "quadratic", {}, few),
    }
    sand = checked_gradient(check, "sand.json", "sand", {}, many)
    for name, found in fluid.items():
        rough = name == "quadratic, spline"
        check.figure("jumps_share" if rough else "fluid_share", second_order(found), name)
        check.figure("jumps_difference" if rough else "fluid_difference", difference(found), name)
    check.figure("sand_share", second_order(sand))
    check.figure("sand_difference", difference(sand))
    draw(check, {**fluid, "sand, friction": sand})
    check.finish()


if __name__ == "__main__":
    main()
