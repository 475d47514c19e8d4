"""Slow drift in single precision: 1 mm/s for 200,000 steps of 1e-5 s, and the same scene 10 km from the origin with the same bits."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, np  # noqa: E402

SPEED, AWAY = 1e-3, 1e4  # m/s, m


def main():
    check = Check(__doc__, __file__)
    end = 0.1 if check.quick else 2.0
    short = {"/time/end": end, "/output/interval": end / 4}
    home = check.run("drift.json", "home", short)
    path = home.frames[-1].field("position") - home.frames[0].field("position")
    travelled = SPEED * home.frames[-1].time
    check.figure("path", 100 * np.abs(path - [travelled, 0]).max() / travelled)
    far_places = {"/domain/min": [AWAY, AWAY], "/domain/max": [AWAY + 0.64, AWAY + 0.32]}
    far_places |= {"/bodies/0/shape/box/min": [AWAY + 0.2, AWAY + 0.1], "/bodies/0/shape/box/max": [AWAY + 0.28, AWAY + 0.18]}
    far = check.run("drift.json", "away", {**short, **far_places})
    same = all(np.array_equal(a.field(name), b.field(name)) for a, b in zip(home.frames, far.frames) for name in ("velocity", "pressure"))
    check.holds("same_bits", same and len(home.frames) == len(far.frames))
    apart = max(np.abs(b.field("position") - AWAY - a.field("position")).max() for a, b in zip(home.frames, far.frames))
    check.figure("shift", apart)
    check.finish()


if __name__ == "__main__":
    main()
