"""Writes docs/validation.md from the figures kept in docs/validation/, after it has taken over those of the cases named.

validation_page.py [CASE…]     out/validation/CASE/{figures.json,comparison.png} → docs/validation/CASE.{json,png}; then the page
"""
import argparse
import json
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "validation"))

import bands  # noqa: E402

KEPT = ROOT / "docs" / "validation"
PAGE = ROOT / "docs" / "validation.md"
SAYS = "## What the result says"

HEAD = """# Validation

Made by `scripts/validate` from the full-size figures of each case that were kept last, in [validation/](validation/); not to be edited by hand. A figure is what
the check of [../validation/](../validation/README.md) computed; its band, with reason and date, stands in [bands.json](../validation/bands.json). Where a
reference asks for more than the band does, that is its aim, and the page says so. Run times are those of shared cores and say nothing about speed.

| case | within their bands | with their aims too | computed | commit |
|---|---|---|---|---|
"""


def take_over(case):
    """Keeps the figures and the picture of a case's last full-size run."""
    out = ROOT / "out" / "validation" / case
    report = out / "figures.json"
    if not report.is_file() or json.loads(report.read_text(encoding="utf-8"))["form"] != "full":
        sys.exit(f"{case}: no figures of a full-size run in {out}")
    KEPT.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(report, KEPT / f"{case}.json")
    picture = KEPT / f"{case}.png"
    if (out / "comparison.png").is_file():
        shutil.copyfile(out / "comparison.png", picture)
    else:
        picture.unlink(missing_ok=True)


def readme(case):
    """(title, first paragraph under SAYS) of a case's README."""
    text = (ROOT / "validation" / case / "README.md").read_text(encoding="utf-8")
    if SAYS not in text:
        sys.exit(f"validation/{case}/README.md has no section '{SAYS}'")
    said = text.split(SAYS, 1)[1].strip().split("\n\n", 1)[0]
    return text.splitlines()[0].removeprefix("# "), said


def load(case):
    """The kept report of a case, None where there is none."""
    path = KEPT / f"{case}.json"
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else None


def several(values, text):
    """'a' or 'a … b' of the smallest and largest of some values."""
    low, high = min(values), max(values)
    return text(low) if low == high else f"{text(low)} … {text(high)}"


def runs_line(report):
    runs = report["runs"].values()
    cells = several([run["cell_size"] for run in runs], lambda v: f"{v:.4g}")
    particles = several([run["particles"] for run in runs], lambda v: f"{v:,}")
    seconds = sum(run["seconds"] for run in runs)
    threads = several([run["threads"] for run in runs], str)
    count = f"{len(runs)} runs" if len(runs) > 1 else "One run"
    return f"{count}: cell {cells} m, {particles} particles, {seconds:.0f} s in all with {threads} thread{'' if threads == '1' else 's'}."


def commits(report):
    return ", ".join(sorted({run["git_commit"][:7] for run in report["runs"].values()}))


def value_text(value, unit):
    return ("yes" if value else "no") if isinstance(value, bool) else f"{value:.3g} {unit}".rstrip()


def verdict(band, value):
    if not band.holds(value, "full"):
        return "**outside**"
    return "inside" if band.aimed(value) else f"inside; **misses its aim** ({band.aim_text()})"


def figure_rows(case, report, own):
    for figure in report["figures"]:
        band = own.get(figure["band"])
        if band is None:
            sys.exit(f"docs/validation/{case}.json: the figure '{figure['band']}' has no band: run scripts/validate {case} again")
        name = ", ".join(filter(None, (band.what, figure["label"])))
        beside = " | ".join(figure[key] or "" for key in ("found", "reference"))
        yield f"| {name} | {beside} | {value_text(figure['value'], band.unit)} | {band.text('full')} | {verdict(band, figure['value'])} |"


def section(case, report, own):
    title, said = readme(case)
    lines = [f"## {title}", "", f"[validation/{case}](../validation/{case}/README.md). {said}", ""]
    if report is None:
        return lines + ["Not run at full size yet.", ""]
    lines += [f"{runs_line(report)} Program of commit {commits(report)}; {report['date']}.", ""]
    lines += ["| figure | jaxmpm | reference | judged | band | |", "|---|---|---|---|---|---|", *figure_rows(case, report, own), ""]
    if (KEPT / f"{case}.png").is_file():
        lines += [f"![{title}](validation/{case}.png)", ""]
    return lines


def summary_row(case, report, own):
    title, _ = readme(case)
    # Of a heading's address GitHub keeps letters, digits, _, - and turns spaces into -.
    anchor = "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c in "_-")
    if report is None:
        return f"| [{title}](#{anchor}) | not run yet | | | |"
    judged = [(own[figure["band"]], figure["value"]) for figure in report["figures"]]
    inside = sum(band.holds(value, "full") for band, value in judged)
    aimed = sum(band.holds(value, "full") and band.aimed(value) for band, value in judged)
    return f"| [{title}](#{anchor}) | {inside} of {len(judged)} | {aimed} of {len(judged)} | {report['date']} | {commits(report)} |"


def page():
    """The text of docs/validation.md."""
    every = bands.cases()
    reports = {case: load(case) for case in every}
    sections = [section(case, reports[case], own) for case, own in every.items()]
    rows = [summary_row(case, reports[case], own) for case, own in every.items()]
    return HEAD + "\n".join(rows) + "\n\n" + "\n".join(line for part in sections for line in part).rstrip() + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", nargs="*", help="whose last full-size figures are taken over")
    for case in parser.parse_args().cases:
        take_over(case)
    PAGE.write_text(page(), encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
