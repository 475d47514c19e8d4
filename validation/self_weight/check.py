"""A bar compressed by its own weight, brought to rest by damping: displacement and stress along it against the closed form of one-dimensional compression, by material, basis and cell size."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np, plt  # noqa: E402

HEIGHT, WIDTH, DENSITY, WEIGHT, E = 1.0, 0.2, 1000.0, 10.0, 1e5  # m, m, kg/m³, m/s², Pa


def stress_of(material, nu, stretch):
    """Vertical stress (Pa) of a confined bar, whose cross section stays the same: nominal and true stress agree."""
    shear, lame = E / (2 * (1 + nu)), E * nu / ((1 + nu) * (1 - 2 * nu))
    if material == "neo_hookean":
        return (shear * (stretch**2 - 1) + lame * np.log(stretch)) / stretch
    return (lame + 2 * shear) * np.log(stretch)  # linear_elastic: rates add up to the logarithm


def closed_form(material, nu, X):
    """Displacement (m) and stress (Pa) at heights X of the undeformed bar: σ(X) = −ρ₀ g (H − X)."""
    stretch = np.linspace(0.3, 1.0, 20001)
    heights = np.linspace(0, HEIGHT, 2001)
    stretches = np.interp(-DENSITY * WEIGHT * (HEIGHT - heights), stress_of(material, nu, stretch), stretch)
    place = np.concatenate([[0], np.cumsum(0.5 * (stretches[1:] + stretches[:-1]) * np.diff(heights))])
    return np.interp(X, heights, place) - X, -DENSITY * WEIGHT * (HEIGHT - X)


def main():
    check = Check(__doc__, __file__)
    cell = 0.05 if check.quick else 0.025
    variants = {
        "neo_hookean": {}, "linear_elastic": {"/materials/foam/model": '"linear_elastic"'}, "neo_hookean, ν = 0": {"/materials/foam/poisson_ratio": 0},
        "flip": {"/method/transfer": "flip"}, "cubic": {"/method/basis": "cubic"},
    }
    runs = [(name, cell) for name in variants] + ([] if check.quick else [("neo_hookean", 0.05), ("neo_hookean", 0.0125)])
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 4), layout="constrained", sharey=True)
    for name, size in runs:
        label = f"{name}, cell {1000 * size:g} mm"
        results = check.run("bar.json", label.replace(", ", "_").replace(" ", ""), {**variants[name], "/domain/cell_size": size, "/domain/max": f"[0.2, {1 + 2 * size}]"})
        material = "linear_elastic" if name == "linear_elastic" else "neo_hookean"
        nu = 0.0 if "ν = 0" in name else 0.3
        X = results.frames[0].field("position")[:, 1]
        last = results.frames[-1]
        moved, stress = last.field("position")[:, 1] - X, last.field("stress")[:, 1]
        exact, exact_stress = closed_form(material, nu, X)
        top = closed_form(material, nu, np.array([HEIGHT]))[0][0]
        displacement = 100 * np.sqrt(np.mean((moved - exact) ** 2)) / abs(top)
        off = 100 * np.sqrt(np.mean((stress - exact_stress) ** 2)) / (DENSITY * WEIGHT * HEIGHT)
        if size <= cell:
            check.figure("displacement", displacement, label)
            check.figure("stress", off, label)
            time, force = results.gauge("ground")
            check.figure("weight", 100 * abs(np.mean(-force[time > 1.5, 1]) / (DENSITY * WEIGHT * HEIGHT * WIDTH) - 1), label)
            check.figure("rest", np.max(np.linalg.norm(last.field("velocity"), axis=1)) / np.sqrt(WEIGHT * HEIGHT), label)
        else:
            check.note(f"{label}: displacement {displacement:.3f} %, stress {off:.2f} %")
        if size == cell and name in ("neo_hookean", "linear_elastic"):
            axes[0].plot(100 * moved, X, ".", ms=2, label=name), axes[1].plot(stress / 1000, X, ".", ms=2)
            rising = np.linspace(0, HEIGHT, 101)
            for axis, values in zip(axes, (100 * closed_form(material, nu, rising)[0], closed_form(material, nu, rising)[1] / 1000)):
                axis.plot(values, rising, "k-", lw=0.8)
    axes[0].set(xlabel="displacement  cm", ylabel="height in the undeformed bar  m", title=f"cell {1000 * cell:g} mm (lines: closed form)"), axes[0].legend(fontsize=8)
    axes[1].set(xlabel="vertical stress  kPa")
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
