"""Ritter's dam break, whole and cut off by an open face in its fast part: depths upstream of the face, and what has left."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import Check, depth_profile, np, plt  # noqa: E402

DEPTH, FACE = 0.1, 1.3  # H0 and the face's place, m


def passed(results, time):
    """Ids of the particles that are not upstream of the face."""
    first, frame = results.frames[0], results.frame_at(time)
    upstream = frame.field("id")[frame.field("position")[:, 0] < FACE]
    return set(first.field("id")) - set(upstream)


def main():
    check = Check(__doc__, __file__)
    coarse = {"/domain/cell_size": 0.01, "/time/step": 4e-5} if check.quick else {}
    figure, axes = plt.subplots(2, 1, figsize=(8, 4.5), sharex=True, layout="constrained")
    for at, transfer in zip(axes, ("flip", "apic")):
        settings = {"/method/transfer": transfer, "/output/interval": 0.1, **coarse}
        whole = check.run("dam_break_2d.json", f"{transfer}_whole", settings)
        top = whole.deck["domain"]["max"][1]
        cut = check.run("dam_break_2d.json", f"{transfer}_cut", {**settings, "/domain/max": [FACE, top], "/walls/x_max": '{"kind": "open"}'})
        for time in (0.3, 0.4):
            (x, depth), (_, shorter) = (depth_profile(r.frame_at(time), r.deck) for r in (whole, cut))
            apart = np.abs(depth[: len(shorter)] - shorter).max() / DEPTH
            check.figure("depth", 100 * apart, f"{transfer}, t = {time} s")
            gone, left = passed(whole, time), passed(cut, time)
            check.figure("left", 100 * len(gone ^ left) / len(gone), f"{transfer}, t = {time} s", f"{len(left)} particles", f"{len(gone)}")
            at.plot(x, depth, "k-", lw=1, label="whole" if time == 0.3 else None)
            at.plot(x[: len(shorter)], shorter, "r--", lw=1, label="cut off" if time == 0.3 else None)
        at.axvline(FACE, color="0.7", lw=0.8), at.set_ylabel("depth  m"), at.set_title(f"{transfer}, t = 0.3 and 0.4 s", fontsize=9, loc="left"), at.grid(alpha=0.3)
    axes[0].legend(fontsize=8), axes[-1].set_xlabel("x  m")
    check.save(figure)
    check.finish()


if __name__ == "__main__":
    main()
