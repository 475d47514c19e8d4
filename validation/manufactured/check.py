"""Order of accuracy in space and time by a manufactured solution: a neo-Hookean block in a box follows a prescribed motion under the body force that it takes; 2D and 3D, by basis and transfer; and what smaller steps do at one cell."""
import json
import pathlib
import sys

import sympy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

DENSITY, E, NU = 1000.0, 1e6, 0.3
AMPLITUDE, END = 0.05, 0.05            # m of the box of 1 m; s: about a wave's way through the box and half
RATE = (60.0, 75.0, 50.0)              # of the motion along each axis, 1/s
SHEAR, LAME = E / (2 * (1 + NU)), E * NU / ((1 + NU) * (1 - 2 * NU))
x, t = sympy.symbols("x y z"), sympy.Symbol("t")


def motion(dim):
    """The solution and the force it takes, symbolic. The motion is given backwards, X_i = x_i − a sin(ω_i t) sin(π x_i), so that all is a formula
    of the present place, as the deck wants it; F = diag(1/(∂X_i/∂x_i)), and at the walls nothing moves."""
    start = [x[i] - AMPLITUDE * sympy.sin(RATE[i] * t) * sympy.sin(sympy.pi * x[i]) for i in range(dim)]
    velocity = [-sympy.diff(start[i], t) / sympy.diff(start[i], x[i]) for i in range(dim)]
    stretch = [1 / sympy.diff(start[i], x[i]) for i in range(dim)]
    J = sympy.prod(stretch)
    stress = [(SHEAR * (stretch[i] ** 2 - 1) + LAME * sympy.log(J)) / J for i in range(dim)]
    force = [sympy.diff(velocity[i], t) + velocity[i] * sympy.diff(velocity[i], x[i]) - J / DENSITY * sympy.diff(stress[i], x[i]) for i in range(dim)]
    return start, velocity, stress, force


def formula(expression):
    """In the deck's language."""
    return sympy.sstr(expression.xreplace({sympy.pi: sympy.Float(np.pi, 17)})).replace("**", "^").replace("log(", "ln(")


class Solution:
    def __init__(self, dim):
        self.dim = dim
        start, velocity, stress, force = motion(dim)
        self.assignments = {
            "/body_force": json.dumps([formula(f) for f in force]),
            "/bodies/0/velocity": json.dumps([formula(v.subs(t, 0)) for v in velocity]),
        }
        if dim == 3:
            self.assignments |= {"/domain/min": "[0, 0, 0]", "/domain/max": "[1, 1, 1]", "/gravity": "[0, 0, 0]",
                                 "/bodies/0/shape/box": '{"min": [0, 0, 0], "max": [1, 1, 1]}'}
        self.stress_at = [sympy.lambdify((x[:dim], t), s) for s in stress]
        self.velocity_at = [sympy.lambdify((x[:dim], t), v) for v in velocity]

    def place(self, X, time):
        """Where the particles that began at X are: Newton on the backward motion."""
        place = X.copy()
        for _ in range(30):
            for i in range(self.dim):
                a = AMPLITUDE * np.sin(RATE[i] * time)
                place[:, i] -= (place[:, i] - a * np.sin(np.pi * place[:, i]) - X[:, i]) / (1 - a * np.pi * np.cos(np.pi * place[:, i]))
        return place

    def errors(self, results):
        """Root mean square over the particles of displacement, velocity and stress, %, of their largest values."""
        X, last = results.frames[0].field("position"), results.frames[-1]
        exact = self.place(X, last.time)
        position, velocity, stress = last.field("position"), last.field("velocity"), last.field("stress")
        v = np.stack([f(exact.T, last.time) for f in self.velocity_at], axis=1)
        s = np.stack([f(exact.T, last.time) for f in self.stress_at], axis=1)
        rms = lambda difference, scale: 100 * np.sqrt(np.mean(np.sum(difference**2, axis=1))) / np.max(np.linalg.norm(scale, axis=1))  # noqa: E731
        return rms(position - exact, exact - X), rms(velocity - v, v), rms(stress[:, : self.dim] - s, s)


def order(sizes, errors):
    """Slope of log error over log size, by least squares over the first three: what comes behind them may be the floor of the particles' sums."""
    return np.polyfit(np.log(sizes[:3]), np.log(errors[:3]), 1)[0]


def space(check, solution, name, assignments, sizes, axis):
    found = []
    for size in sizes:
        results = check.run("solid.json", f"{solution.dim}d_{name.replace(', ', '_').replace(' ', '_')}_{size}",
                            {**solution.assignments, **assignments, "/domain/cell_size": size, "/time/step": 5e-4 * size})
        found.append(solution.errors(results))
        check.note(f"{solution.dim}D, {name}, cell {size:g}: displacement {found[-1][0]:.4g}, velocity {found[-1][1]:.4g}, stress {found[-1][2]:.4g} %")
    found = np.array(found)
    axis.loglog(sizes, found[:, 0], "o-" if solution.dim == 2 else "s--", lw=1, ms=3, label=f"{solution.dim}D, {name}")
    return found


def steps_at_one_cell(check, solution, name, assignments, size, steps, axis):
    """The displacement's error against the length of the step: each transfer between particles and grid takes something of the motion."""
    errors = []
    for step in steps:
        results = check.run("solid.json", f"steps_{name.replace(', ', '_')}_{step:g}", {**solution.assignments, **assignments, "/domain/cell_size": size, "/time/step": step})
        errors.append(solution.errors(results)[0])
    axis.loglog(steps, errors, "o-", ms=3, label=f"{name}, {1 / size:g} cells")
    return errors


def time_order(check, name, assignments):
    """A block in an oscillating uniform force moves as one, whatever the splines: what is left is the error of the time steps."""
    omega, steps = 40.0, [2e-3, 1e-3, 5e-4]
    errors = []
    for step in steps:
        results = check.run("solid.json", f"time_{name.replace(', ', '_')}_{step:g}", {
            **assignments, "/time/step": step, "/time/end": 0.1, "/output/interval": 0.1, "/materials/rubber/youngs_modulus": 1e4,
            "/bodies/0/shape/box": '{"min": [0.3, 0.3], "max": [0.7, 0.7]}', "/body_force": json.dumps([f"50*cos({omega}*t)", f"50*sin({omega}*t)"])})
        moved = np.mean(results.frames[-1].field("position") - results.frames[0].field("position"), axis=0)
        t_end = results.frames[-1].time
        exact = 50 / omega**2 * np.array([1 - np.cos(omega * t_end), omega * t_end - np.sin(omega * t_end)])
        errors.append(np.linalg.norm(moved - exact) / np.linalg.norm(exact))
    return order(steps, errors)


def main():
    check = Check(__doc__, __file__)
    plane = Solution(2)
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained")
    sizes = [1 / 8, 1 / 16] if check.quick else [1 / 8, 1 / 16, 1 / 32, 1 / 64]
    variants = {"apic, quadratic": {}, "apic, cubic": {"/method/basis": "cubic"}, "tpic, quadratic": {"/method/transfer": "tpic"},
                "flip, quadratic": {"/method/transfer": "flip", "/method/flip_fraction": 1}, "apic, mls": {"/method/gradient": "mls"},
                "apic, linear": {"/method/basis": "linear"}, "pic, quadratic": {"/method/transfer": "pic"}}
    for name in (("apic, quadratic", "flip, quadratic") if check.quick else variants):
        found = space(check, plane, name, variants[name], sizes, axes[0])
        kind = {"apic, linear": "order_linear", "pic, quadratic": "order_pic"}.get(name, "order_space")
        check.figure(kind, order(sizes, found[:, 0]), f"2D, {name}")
        if kind == "order_space":
            check.figure("displacement", found[-1, 0], f"2D, {name}, {1 / sizes[-1]:g} cells")
    if not check.quick:
        dense = space(check, plane, "apic, quadratic, 16 particles a cell", {"/bodies/0/particles_per_cell": 16}, sizes[:3], axes[0])
        check.figure("dense", dense[-1, 0], f"2D, {1 / sizes[2]:g} cells")
    found = space(check, Solution(3), "apic, quadratic", {}, sizes[:1] if check.quick else sizes[:3], axes[0])
    if check.quick:
        check.figure("coarse_3d", found[0, 0], "3D, apic, quadratic, 8 cells")
    else:
        check.figure("order_3d", np.log(found[-2, 0] / found[-1, 0]) / np.log(2), "3D, apic, quadratic")

    for name in ("apic, quadratic", "flip, quadratic", "apic, cubic"):
        check.figure("order_time", time_order(check, name, variants[name]), name)
    steps = [2e-4, 5e-5, 1.25e-5]
    for name in ("apic, quadratic", "flip, quadratic", "tpic, quadratic", "apic, cubic"):
        errors = steps_at_one_cell(check, plane, name, variants[name], 1 / 8 if check.quick else 1 / 16, steps, axes[1])
        check.figure("smaller_steps", errors[-1] / errors[0], name)
    axes[0].loglog(sizes, found[0, 0] * (np.array(sizes) / sizes[0]) ** 2, "k:", lw=1, label="order 2")
    axes[0].set(xlabel="cell size  m", ylabel="displacement error  %"), axes[0].legend(fontsize=7)
    axes[1].set(xlabel="time step  s", ylabel="displacement error  %"), axes[1].legend(fontsize=7)
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
