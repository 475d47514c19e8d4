"""Runs the studies and writes docs/stability.md from the figures kept of all of them."""
import argparse
import importlib
import json
import time

from study import KEPT, ROOT

STUDIES = (
    "time_step", "sound_speed", "flip_noise", "pic_dissipation", "cell_crossing", "single_precision", "numerical_fracture", "tiny_masses", "yield_and_tension",
    "stick_slip", "thin_layers", "few_particles", "thrown_out", "contrast", "dimension",
)  # fmt: skip
PAGE = ROOT / "docs" / "stability.md"

HEAD = """# Stability maps

Made by `scripts/study-stability` from the figures of each study that were kept last, in [stability/](stability/); not to be edited by hand. Each study is a small scene in
[scripts/python/stability/](../scripts/python/stability/) that is pushed until it fails. The last column says what the program does about the failure: *cured* (it does not happen with
the defaults, or an automatic choice avoids it), *refused* (the program stops and explains), *advised* (`jaxmpm check` warns), or *open*. Lengths are in cells h, c is the speed of the fastest wave.

| study | measured threshold | what the program does |
|---|---|---|
"""


def section(report):
    lines = [f"## {report['title']}", "", f"Expected: {report['expected']}", ""]
    for paragraph in report["said"]:
        lines += [paragraph, ""]
    for table in report["tables"]:
        lines += [f"{table['caption']}:", "", f"| {' | '.join(table['columns'])} |", "|" + "---|" * len(table["columns"])]
        lines += [f"| {' | '.join(row)} |" for row in table["rows"]] + [""]
    if report["picture"]:
        lines += [f"![{report['title']}](stability/{report['picture']})", ""]
    commits = f" of commit {', '.join(report['commits'])}" if report["commits"] else ""
    lines += [f"`scripts/study-stability {report['study']}`: {report['runs']:,} runs, {report['particle_steps'] / 1e6:.0f} million particle-steps; program{commits}; {report['date']}.", ""]
    return lines


def anchor(title):
    """Of a heading's address GitHub keeps letters, digits, _, - and turns spaces into -."""
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c in "_-")


def page(reports):
    rows = [f"| [{r['title']}](#{anchor(r['title'])}) | {r['threshold']} | {r['verdict']} |" for r in reports]
    return HEAD + "\n".join(rows) + "\n\n" + "\n".join(line for r in reports for line in section(r)).rstrip() + "\n"


def kept():
    paths = [KEPT / f"{name}.json" for name in STUDIES]
    return [json.loads(path.read_text(encoding="utf-8")) for path in paths if path.is_file()]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("studies", nargs="*", metavar="STUDY", help=f"of {', '.join(STUDIES)}; all when none is named")
    chosen = parser.parse_args().studies or STUDIES
    unknown = [name for name in chosen if name not in STUDIES]
    if unknown:
        parser.error(f"there is no study {', '.join(unknown)}; there are {', '.join(STUDIES)}")
    for name in chosen:
        began = time.monotonic()
        importlib.import_module(name).main()
        print(f"{name}: {time.monotonic() - began:.0f} s", flush=True)
    PAGE.write_text(page(kept()), encoding="utf-8")
    print(f"written: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
