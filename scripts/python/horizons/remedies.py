"""What helps where exact gradients over the whole run do not: searches by several methods for the value of one scene."""
import json
import pathlib
import re
import tempfile

STEPS, EARLY = 10000, 2000  # of the run; in which the early data lie
SEARCHES = {
    "splash": {"start": 0.1, "bounds": [0, 1], "adam": 0.05},
    "sand": {"start": 33, "bounds": [15, 45], "adam": 1.0},
}


def methods(adam):
    return {
        "last state, L-BFGS": ("last", {"method": "lbfgs", "iterations": 15}),
        "last state, Adam (steps of one size: clipped gradients)": ("last", {"method": "adam", "learning_rate": adam, "decay": 0.95, "iterations": 25}),
        "last state, Gauss–Newton over close distances (`spacing` 1e-4)": ("last", {"method": "gauss_newton", "spacing": 1e-4, "iterations": 10}),
        "last state, Gauss–Newton over a distance (`spacing` 0.2)": ("last", {"method": "gauss_newton", "spacing": 0.2, "iterations": 10}),
        f"a window of early states (up to step {EARLY:,}), L-BFGS": ("early", {"method": "lbfgs", "iterations": 15}),
    }


def search(name, scene, program):
    """By method: the value found, the loss, and how many runs and gradients it took."""
    settings = SEARCHES[name]
    with tempfile.TemporaryDirectory(prefix="jaxmpm-remedies-") as scratch:
        place = pathlib.Path(scratch)
        deck = scene.deck(STEPS)
        deck["output"]["interval"] = 500 * scene.step
        (place / "truth.json").write_text(json.dumps(deck), encoding="utf-8")
        program("run", str(place / "truth.json"), "--set", f"{scene.unknown}={scene.truth}", "-o", str(place / "truth"), "-q", "--threads", "1")
        found = {}
        for number, (method, (window, optimizer)) in enumerate(methods(settings["adam"]).items()):
            observation = {**scene.seen["paths"], "file": str(place / "truth" / "results.h5")}
            observation |= {"from_time": (STEPS - 1) * scene.step} if window == "last" else {"to_time": (EARLY + 1) * scene.step}
            unknown = {"path": scene.unknown, "start": settings["start"], "bounds": settings["bounds"]}
            case = {**deck, "inverse": {"unknowns": [unknown], "observations": [observation], "optimizer": optimizer, "memory": "3 GiB"}}
            (place / f"{number}.json").write_text(json.dumps(case), encoding="utf-8")
            said = program("invert", str(place / f"{number}.json"), "-o", str(place / f"{number}"), "--threads", "1")
            result = json.loads((place / f"{number}" / "inversion.json").read_text(encoding="utf-8"))
            found[method] = {"value": result["unknowns"][scene.unknown]["value"], "loss": result["loss"], "evaluations": result["evaluations"], "first_loss": result["iterations"][0]["loss"]}
            print(f"{name}, {method}: {found[method]['value']:.4g} {re.findall('Converged|Out of iterations|No step', said)}", flush=True)
    return {"scene": name, "start": settings["start"], "truth": scene.truth, "steps": STEPS, "found": found}


def table(reports):
    lines = ["| scene, start, truth | method | found | loss / that of the start | evaluations |", "|---|---|---|---|---|"]
    for report in reports:
        for method, at in report["found"].items():
            lines.append(f"| {report['scene']}, {report['start']:g}, {report['truth']:g} | {method} | {at['value']:.4g} | {at['loss'] / at['first_loss']:.2g} | {at['evaluations']} |")
    return lines
