"""The viscosity that a transfer adds: decay of a plane shear wave in an inviscid fluid, by transfer, basis, step and wavelength."""
from study import BASES, SCHEMES, Study, body, box, deck, np, plt, water

CELL, SPEED, AMPLITUDE = 0.01, 10.0, 0.01


def shear(method, cells, cfl, steps):
    """v_x = a cos(πy/H) between slip walls, H = `cells`; the fluid has no viscosity, so that it should go on for ever. The domain is as long as the flow needs no ends."""
    high, long = cells * CELL, 8 * CELL
    turn = f"{AMPLITUDE} * cos(_pi * y / {high})"
    pool = body("m", box([0, 0], [long, high]), velocity=[f"{turn} * sin(_pi * x / {long})", f"-{AMPLITUDE} * {high / long} * sin(_pi * y / {high}) * cos(_pi * x / {long})"])
    step = cfl * CELL / SPEED
    return deck([long, high], CELL, {"m": water(SPEED)}, [pool], steps * step, time={"step": step}, method=method, samples=steps)


def viscosity(study, method, cells, cfl):
    """Of the decay of kinetic energy exp(−2 ν k² t), in h²/dt."""
    steps = 60
    time, energy = study.run(shear(method, cells, cfl, steps)).energy()
    kinetic, late = energy["kinetic"], slice(10, None)
    rate = -np.polyfit(time[late], np.log(kinetic[late]), 1)[0] / 2
    wave2 = np.pi**2 * (1 / (cells * CELL) ** 2 + 1 / (8 * CELL) ** 2)
    return rate / wave2 * (cfl * CELL / SPEED) / CELL**2


def main():
    study = Study(
        __file__, "Dissipation of PIC and of blends with it",
        "each transfer there and back averages over the width of the basis. PIC does so with velocities at every step, which acts like a viscosity of some h²/dt: it grows as the step shrinks. A FLIP blend has (1 − flip_fraction) of it.",
    )  # fmt: skip
    found = {scheme: {basis: viscosity(study, {**method, "basis": basis}, 16, 0.2) for basis in BASES} for scheme, method in SCHEMES.items()}
    study.table("Viscosity by transfer and basis in h²/dt (eddy of 8 by 16 cells, dt c/h = 0.2)", ["transfer", *BASES], [[s, *(found[s][b] for b in BASES)] for s in SCHEMES])
    sizes, steps = (8, 16, 32), (0.05, 0.1, 0.2, 0.4)
    scaling = {size: [viscosity(study, SCHEMES["pic"], size, cfl) for cfl in steps] for size in sizes}
    study.table("PIC with quadratic splines: viscosity in h²/dt by height of the eddy and step", ["height, cells", *(f"dt c/h = {c}" for c in steps)], [[size, *scaling[size]] for size in sizes])
    study.data = {"by_scheme": found, "pic_quadratic": scaling, "cfl": steps}
    figure, axes = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
    for scheme in SCHEMES:
        axes[0].semilogy(range(3), [max(abs(found[scheme][b]), 1e-7) for b in BASES], "o-", ms=4, lw=1, label=scheme)
    axes[0].set_xticks(range(3), BASES), axes[0].set(ylabel="added viscosity  h²/dt"), axes[0].legend(fontsize=7)
    for size in sizes:
        axes[1].loglog(steps, np.array(scaling[size]) * 1 / np.array(steps), "o-", ms=4, label=f"{size} cells")
    axes[1].set(xlabel="dt c/h", ylabel="PIC's viscosity / (h c)"), axes[1].legend(fontsize=7)
    study.draw(figure)
    pic = found["pic"]
    study.finish(
        f"PIC adds {pic['quadratic']:.2f} h²/dt (quadratic), flip 0.99 {found['flip 0.99']['quadratic']:.2g}, apic {abs(found['apic']['quadratic']):.1g}", "cured by the default (apic); `check` advises against PIC and states the viscosity of a blend",
        f"PIC acts like a kinematic viscosity of {pic['linear']:.2f}, {pic['quadratic']:.2f} and {pic['cubic']:.2f} h²/dt with linear, quadratic and cubic splines; a FLIP blend of 0.99 has {found['flip 0.99']['quadratic'] / pic['quadratic']:.3f} of it, 0.9 has {found['flip 0.9']['quadratic'] / pic['quadratic']:.2f}. "
        f"In units of h²/dt it changes by less than a factor {max(max(v) for v in scaling.values()) / min(min(v) for v in scaling.values()):.2f} over steps and sizes: halving the step doubles it. With h = 1 cm and dt = 0.1 ms that is {pic['quadratic'] * 1e-4 / 1e-4:.2g} m²/s, where water has 1e-6.",
    )  # fmt: skip
