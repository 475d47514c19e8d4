"""Run-out of granular columns, a = 0.5, 1, 2, 3: trend and bands of the published laws; the figures of Du & He 2025 beside ours."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, law_value, np, plt, reference  # noqa: E402

BASE = 0.14                                            # L0, m
PAPER = {0.5: 2.05, 1.0: 3.97, 2.0: 7.76, 3.0: 10.65}  # Du & He 2025, section 4.2.2; base and measure are not stated there
LAWS = ("Lube2005", "Lajeunesse2005", "LSP2011")       # plane columns: experiments, experiments, continuum computation


def main():
    check = Check(__doc__, __file__)
    laws = reference("granular_collapse_scaling_laws.csv")
    decks = {0.5: "a05", 1.0: "a1", 2.0: "a2", 3.0: "a3"}
    coarse = {"/domain/cell_size": 0.01, "/time/end": 1.0} if check.quick else {}
    aspects = np.array(list(decks))
    run_out, height = [], []
    for aspect, deck in decks.items():
        results = check.run(f"granular_column_{deck}.json", deck, coarse)
        time, front = results.gauge("front")
        _, level = results.gauge("height")
        run_out.append((np.ravel(front)[-1] - BASE) / BASE)
        height.append(np.ravel(level)[-1] / BASE)
        crept = abs(np.ravel(front)[-1] - np.interp(time[-1] - 0.2, time, np.ravel(front))) / BASE
        quoted = ", ".join(f"{law} {law_value(laws, law, '(Linf-L0)/L0', aspect):.2f}" for law in LAWS)
        base = BASE * run_out[-1] / PAPER[aspect]
        check.note(f"a = {aspect:g}: run-out {run_out[-1]:.2f} L0 ({crept:.3f} of it in the last 0.2 s); laws: {quoted}; Du & He 2025: {PAPER[aspect]:g}, the same length for a base of {1000 * base:.0f} mm")
        check.note(f"          height at the wall {height[-1]:.2f} L0; laws: {law_value(laws, 'Lajeunesse2005', 'Hinf/L0', aspect):.2f} (Lajeunesse 2005)")
    run_out = np.array(run_out)
    for aspect, value in zip(aspects, run_out):
        expected = {law: law_value(laws, law, "(Linf-L0)/L0", aspect) for law in ("Lube2005", "Lajeunesse2005")}
        nearest = min(expected.values(), key=lambda law: abs(np.log(value / law)))
        quoted = ", ".join(f"{text:.2f} {law}" for law, text in expected.items())
        check.figure("run_out", value / nearest, f"a = {aspect:g}", f"{value:.2f} L0", f"L0 × ({quoted})")
    slope = np.diff(np.log(run_out)) / np.diff(np.log(aspects))
    check.note("exponent from one column to the next: " + ", ".join(f"{s:.2f}" for s in slope))
    check.figure("exponent_low", slope[0], "", slope[0], "1")
    check.figure("exponent_high", slope[-1], "", slope[-1], "0.65 … 1")
    axes = plt.figure(figsize=(6, 4.5), layout="constrained").gca()
    fine = np.linspace(0.3, 4, 200)
    for law in LAWS:
        axes.loglog(fine, [law_value(laws, law, "(Linf-L0)/L0", a) for a in fine], lw=1, label=law)
    axes.loglog(list(PAPER), list(PAPER.values()), "kx", label="Du & He 2025 (3D, base not stated)"), axes.loglog(aspects, run_out, "ro", label="jaxmpm")
    axes.set(xlabel="H0 / L0", ylabel="run-out / L0"), axes.legend(fontsize=8), axes.grid(alpha=0.3, which="both")
    check.save(axes.figure)
    check.finish()


if __name__ == "__main__":
    main()
