"""The bands of validation/bands.json: what each figure may be, why, and since when."""
import json
import pathlib

FILE = pathlib.Path(__file__).resolve().parent / "bands.json"
KEYS = {"what", "unit", "full", "quick", "aim", "reason", "date"}
FORMS = ("full", "quick")


class Band:
    """One figure's band. A limit is a number (at most), a pair (from … to), or true (must hold)."""

    def __init__(self, key, entry):
        unknown, missing = set(entry) - KEYS, {"what", "full", "reason", "date"} - set(entry)
        if unknown or missing:
            raise SystemExit(f"{FILE.name}: {key}: " + ", ".join([f"unknown {k}" for k in sorted(unknown)] + [f"no {k}" for k in sorted(missing)]))
        self.key, self.entry = key, entry
        self.what, self.unit, self.reason, self.date = entry["what"], entry.get("unit", ""), entry["reason"], entry["date"]

    def limit(self, form):
        """The limit of a form; None where the form does not judge this figure."""
        return self.entry.get(form)

    def holds(self, value, form):
        return within(value, self.limit(form))

    def aimed(self, value):
        """Whether the full-size figure is as good as the reference asks for, which may be more than the band does."""
        return within(value, self.entry.get("aim", self.entry["full"]))

    def text(self, form):
        return limit_text(self.limit(form), self.unit)

    def aim_text(self):
        return limit_text(self.entry["aim"], self.unit) if "aim" in self.entry else ""


def within(value, limit):
    if limit is None:
        return True
    if limit is True:
        return value is True
    low, high = limit if isinstance(limit, list) else (float("-inf"), limit)
    return low <= value <= high  # false for NaN


def limit_text(limit, unit):
    if limit is None:
        return "not judged"
    if limit is True:
        return "must hold"
    text = f"{limit[0]:g} … {limit[1]:g}" if isinstance(limit, list) else f"at most {limit:g}"
    return f"{text} {unit}".rstrip()


def cases():
    """Case → its bands by key, in the order of the file."""
    whole = json.loads(FILE.read_text(encoding="utf-8"))
    return {case: {key: Band(f"{case}/{key}", entry) for key, entry in entries.items()} for case, entries in whole.items()}
