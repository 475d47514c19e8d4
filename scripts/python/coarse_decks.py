"""The decks of inputs/ in a form light enough for tests (inputs/coarse.txt)."""
import pathlib

INPUTS = pathlib.Path(__file__).resolve().parents[2] / "inputs"


def coarse_decks():
    """Deck name → words of the command line that make it coarse: --set POINTER=VALUE …"""
    lines = (INPUTS / "coarse.txt").read_text(encoding="utf-8").splitlines()
    words = [line.split() for line in lines if line.strip() and not line.startswith("#")]
    return {deck: [part for assignment in assignments for part in ("--set", assignment)] for deck, *assignments in words}
