"""docs/long_horizons.md, from the figures of all scenes."""
import pathlib

import remedies
from figures import summary, useful_steps

PAGE = pathlib.Path(__file__).resolve().parents[3] / "docs" / "long_horizons.md"
ADVICE = pathlib.Path(__file__).with_name("advice.md")
HEAD = """# Gradients over long runs

Made by `scripts/study-horizons` from the figures kept in [horizons/](horizons/); not to be edited by hand. An exact gradient says what an infinitely small change does. A search asks what a change of a useful size does. Over short runs both are the same; over long ones a flow may
amplify small changes until the first says nothing of the second. Here four scenes of one unknown run for 100 to 20,000 steps. What is seen is the last state alone: the *paths* (positions of all particles), or a *mean* (the velocity of all the water; the *profile* of the heap). The loss is half the sum of
squares of differences from a run with the true value. At the inner five of seven values, none of them the truth, the exact gradient is compared with the slope of the loss over a distance, between the neighbours to both sides.
"""


def table(rows):
    lines = ["| steps | exact: median (lowest to highest) | over a distance: median | exact leads to the truth | … and within a factor of two of the slope | the slope leads to the truth |", "|---|---|---|---|---|---|"]
    for r in rows:
        lines.append(f"| {r['steps']:,} | {r['exact']:.2g} ({r['lowest']:.2g} to {r['highest']:.2g}) | {r['wide']:.2g} | {r['exact_leads']:.0%} | {r['near']:.0%} | {r['wide_leads']:.0%} |")
    return lines


def section(report):
    values = report["values"]
    lines = [f"## {report['title']}", "", f"`{report['unknown']}` from {values[0]:g} to {values[-1]:g}, the truth is {report['truth']:g}; steps of {report['step']:g} s.", "", f"![Sizes of gradients, and losses at the end](horizons/{report['scene']}.png)", ""]
    for seen in report["seen"]:
        rows = summary(report, seen)
        useful = useful_steps(rows)
        verdict = f"right up to {useful:,} steps" if useful else "not to be relied on at any of these lengths"
        lines += [f"**{seen.capitalize()}**: {verdict}.", "", *table(rows), ""]
    return [*lines, f"`scripts/study-horizons {report['scene']}`; program of commit {report['commit']}; {report['date']}.", ""]


def overview(reports):
    lines = ["| scene | seen | exact gradients are right up to | 20,000 steps: exact / over a distance |", "|---|---|---|---|"]
    for report in reports:
        for seen in report["seen"]:
            rows = summary(report, seen)
            useful = useful_steps(rows)
            lines.append(f"| {report['title']} | {seen} | {f'{useful:,} steps' if useful else '–'} | {rows[-1]['exact'] / rows[-1]['wide']:.2g} |")
    return [*lines, ""]


def page(reports, searches):
    lines = [HEAD, *overview(reports), ADVICE.read_text(encoding="utf-8"), *remedies.table(searches), ""]
    for report in reports:
        lines += section(report)
    return "\n".join(lines).rstrip() + "\n"
