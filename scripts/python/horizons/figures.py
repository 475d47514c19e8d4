"""What the page says in numbers: exact gradients, slopes over a distance, and whether both lead to the truth."""
import numpy as np


def slopes(values, found):
    """Of the loss, at the inner values: exact gradients, and differences between the neighbours to both sides."""
    loss, gradient = (np.array([at[key] for at in found]) for key in ("loss", "gradient"))
    return gradient[1:-1], (loss[2:] - loss[:-2]) / (np.array(values[2:]) - np.array(values[:-2]))


def summary(report, seen):
    """By number of steps: median size of exact gradients and the lowest and highest, median size of slopes over a distance, the shares of both whose
    sign leads to the truth, and of exact gradients that are also within a factor of two of the slope."""
    way = np.sign(np.mean(report["values"]) - report["truth"])  # along which the loss should grow
    rows = []
    for steps, found in zip(report["steps"], report["seen"][seen]):
        exact, wide = slopes(report["values"], found)
        leads = way * exact > 0
        near = leads & (np.abs(exact) < 2 * np.abs(wide)) & (np.abs(exact) > np.abs(wide) / 2)
        size = np.abs(exact)
        rows.append({
            "steps": steps, "exact": np.median(size), "lowest": size.min(), "highest": size.max(), "wide": np.median(np.abs(wide)),
            "exact_leads": leads.mean(), "wide_leads": (way * wide > 0).mean(), "near": near.mean(),
        })  # fmt: skip
    return rows


def useful_steps(rows):
    """The longest run up to which all exact gradients lead to the truth with about the right size; 0 when none does."""
    good = 0
    for row in rows:
        if row["near"] < 1:
            break
        good = row["steps"]
    return good
