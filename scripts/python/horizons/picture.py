"""The picture of one scene: sizes of gradients over the number of steps, and what the loss looks like at the end of the longest run."""
import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

from figures import summary  # noqa: E402
from pictures import plt, save_small  # noqa: E402


def draw(report, path):
    seen = list(report["seen"])
    figure, axes = plt.subplots(1, 1 + len(seen), figsize=(4 * (1 + len(seen)), 3.2), layout="constrained")
    for k, name in enumerate(seen):
        rows = summary(report, name)
        steps, column = [r["steps"] for r in rows], (lambda key, rows=rows: [r[key] for r in rows])
        axes[0].loglog(steps, column("exact"), "o-", color=f"C{k}", label=f"{name}: exact")
        axes[0].fill_between(steps, column("lowest"), column("highest"), color=f"C{k}", alpha=0.2, lw=0)
        axes[0].loglog(steps, column("wide"), "s--", color=f"C{k}", ms=4, label=f"{name}: over a distance")
        draw_loss(axes[1 + k], report, name)
    axes[0].set(xlabel="steps", ylabel="|dL/du|", title="gradients (median and range)"), axes[0].legend(fontsize=7)
    save_small(figure, path)


def draw_loss(axes, report, name):
    """Losses at the end of the longest run, with the exact gradients as short tangents."""
    values, found = np.array(report["values"]), report["seen"][name][-1]
    loss, gradient = (np.array([at[key] for at in found]) for key in ("loss", "gradient"))
    axes.plot(values, loss, "ok", ms=4)
    low, high = loss.min() - 0.3 * np.ptp(loss), loss.max() + 0.3 * np.ptp(loss)
    reach = 0.3 * (values[1] - values[0])
    for x, y, slope in zip(values, loss, gradient):
        axes.plot([x - reach, x + reach], [y - reach * slope, y + reach * slope], "C3", lw=1.2)
    axes.set(xlabel=report["unknown"], ylabel="loss", title=f"{name}, {report['steps'][-1]:,} steps", ylim=(low, high))
