"""Axial vibration of an elastic bar, held at one end: frequency, amplitude and energy of the first mode over ten periods against the closed form."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

LENGTH, DENSITY, YOUNG, POISSON, SPEED = 1.0, 1000.0, 1e5, 0.3, 0.02  # as in the deck
MODULUS = YOUNG * (1 - POISSON) / ((1 + POISSON) * (1 - 2 * POISSON))  # λ + 2G: the walls let the bar not widen
FREQUENCY = np.pi / (2 * LENGTH) * np.sqrt(MODULUS / DENSITY)          # ω, 1/s
PERIODS = 10


def centre_velocity(results):
    """Time and velocity of the centre of mass; the closed form is (2 v0/π) cos ωt."""
    time, momentum = results.gauge("momentum")
    return time, momentum[:, 0] / (DENSITY * LENGTH * 0.1)


def frequency(time, velocity):
    """ω from the zero crossings, which lie half a period apart."""
    before = np.flatnonzero(velocity[:-1] * velocity[1:] < 0)
    crossings = time[before] - velocity[before] * (time[before + 1] - time[before]) / (velocity[before + 1] - velocity[before])
    return np.pi / np.polyfit(np.arange(len(crossings)), crossings, 1)[0]


def amplitude(time, velocity, omega, period):
    """Size of the oscillation in one period, by least squares on cos ωt and sin ωt."""
    inside = (time >= period * 2 * np.pi / omega) & (time <= (period + 1) * 2 * np.pi / omega)
    waves = np.c_[np.cos(omega * time[inside]), np.sin(omega * time[inside])]
    return np.linalg.norm(np.linalg.lstsq(waves, velocity[inside], rcond=None)[0])


def kept_energy(results):
    """Part of the initial energy that is kinetic or elastic at the end."""
    names = results.gauge_components("energy")
    energy = results.gauge("energy")[1]
    mechanical = energy[:, names.index("kinetic")] + energy[:, names.index("strain")]
    return mechanical[-1] / mechanical[0]


def main():
    check = Check(__doc__, __file__)
    cells = (0.025,) if check.quick else (0.025, 0.0125)
    cases = [("apic", "quadratic", cell) for cell in cells] + [(transfer, "quadratic", 0.025) for transfer in ("tpic", "flip", "pic")]
    cases += [] if check.quick else [("apic", "linear", 0.025), ("apic", "cubic", 0.025)]
    figure, axes = plt.subplots(figsize=(9, 3), layout="constrained")
    for transfer, basis, cell in cases:
        name = f"{transfer}, {basis}, cell {1000 * cell:g} mm"
        results = check.run("bar.json", f"{transfer}_{basis}_{cell}", {"/method/transfer": transfer, "/method/basis": basis, "/domain/cell_size": cell})
        time, velocity = centre_velocity(results)
        found = frequency(time, velocity)
        last = amplitude(time, velocity, found, PERIODS - 1) / (2 * SPEED / np.pi)
        judged = transfer != "pic"  # PIC smooths velocities at every step: drawn to show what the others avoid
        if judged:
            check.figure("frequency", 100 * abs(found / FREQUENCY - 1), name, f"{found:.4f} 1/s", f"{FREQUENCY:.4f} 1/s")
            check.figure("amplitude", last, name, last, "1")
            check.figure("energy", kept_energy(results), name, kept_energy(results), "1")
        else:
            check.note(f"{name}: ω {found:.4f} 1/s, amplitude of the tenth period {last:.3f}, energy kept {kept_energy(results):.3f}")
        if cell == 0.025:
            axes.plot(time, velocity, lw=0.8, label=f"{transfer}, {basis}")
    axes.plot(time, 2 * SPEED / np.pi * np.cos(FREQUENCY * time), "k--", lw=0.8, label="closed form")
    axes.set(xlabel="time  s", ylabel="mean velocity  m/s"), axes.legend(fontsize=7, ncols=4, loc="lower left")
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
