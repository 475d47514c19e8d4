"""Drawing of one frame: particles coloured by a field, with walls and obstacles; and pictures small enough for documents."""
import matplotlib
import numpy as np
import PIL.Image

matplotlib.use("Agg")
import matplotlib.patches as patches  # noqa: E402
import matplotlib.pyplot as plt  # noqa: E402

LABELS = {
    "speed": "speed  m/s",
    "pressure": "pressure  Pa",
    "density": "density  kg/m³",
    "plastic_strain": "plastic strain",
    "body": "body",
}
AXES = "xyz"
SMALL_BYTES = 60_000


def save_small(figure, path, limit=SMALL_BYTES):
    """Writes a figure as a PNG of fewer bytes than `limit`, by as coarse a resolution as that takes, and closes it."""
    for dpi in (100, 85, 70, 55):
        figure.savefig(path, dpi=dpi)
        with PIL.Image.open(path) as image:
            image.convert("RGB").quantize(256, method=PIL.Image.Quantize.MAXCOVERAGE, dither=PIL.Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size < limit:
            break
    plt.close(figure)


def values_of(frame, field):
    """Values by particle of a field: a scalar as it is, `speed`, `body`, or the size of a vector or tensor."""
    if field == "body":
        return np.concatenate([np.full(len(frame.field("position", b)), i, float) for i, b in enumerate(frame.bodies)])
    values = frame.field("velocity" if field == "speed" else field)
    if values is None:
        raise SystemExit(f"{frame.path} has no field '{field}'; it has speed, body, {', '.join(frame.fields())}")
    return values if values.ndim == 1 else np.linalg.norm(values.reshape(len(values), -1), axis=1)


def colour_range(frames, field):
    """One range for all frames, without the outermost half per cent at both ends."""
    samples = [values_of(frame, field) for frame in frames]
    low = min((np.quantile(v, 0.005) for v in samples if len(v)), default=0.0)
    high = max((np.quantile(v, 0.995) for v in samples if len(v)), default=1.0)
    return (min(low, 0.0) if low >= 0 else low), (high if high > low else low + 1.0)


def particle_spacing(deck):
    """Distance of neighbouring particles as they are seeded, m: the smallest of all bodies."""
    dimension = len(deck["domain"]["min"])
    cell = deck["domain"]["cell_size"]
    return min(b["spacing"] if b.get("spacing") else cell / (b.get("particles_per_cell") or 2**dimension) ** (1 / dimension) for b in deck["bodies"])


def outline(shape, directory):
    """Outlines of a shape's cut in its first two axes, as closed lists of points; height maps and meshes are left out."""
    kind, data = next(iter(shape.items()))
    if kind == "box":
        (a, b), (c, d) = data["min"][:2], data["max"][:2]
        return [[(a, b), (c, b), (c, d), (a, d)]]
    if kind == "polygon":
        return [data["points"]]
    if kind == "sphere":
        turn = np.linspace(0, 2 * np.pi, 60)
        return [np.c_[data["center"][0] + data["radius"] * np.cos(turn), data["center"][1] + data["radius"] * np.sin(turn)]]
    if kind == "union":
        return [line for part in data for line in outline(part, directory)]
    if kind == "difference":
        return outline(data[0], directory)
    if kind == "height_map" and data["file"].endswith(".csv"):
        points = np.array([[float(c) for c in row.split(",")[:2]] for row in open(directory / data["file"]) if row[0] in "-+.0123456789"])
        offset = np.array((list(np.ravel(data.get("offset") or [])) + [0.0, 0.0])[:2])
        points = points * [1, data.get("vertical_scale", 1)] + offset
        floor = points[:, 1].min() - 10 * np.ptp(points[:, 1])
        return [np.vstack([points, [points[-1, 0], floor], [points[0, 0], floor]])]
    return []


WALL_STYLES = {"slip": dict(color="0.55", lw=1.0), "no_slip": dict(color="k", lw=2.2), "separate": dict(color="tab:blue", lw=1.4), "friction": dict(color="tab:brown", lw=2.2),
               "periodic": dict(color="0.55", lw=1.0, ls="--"), "open": dict(color="0.75", lw=1.0, ls=":")}


def draw_scene(axes, deck, deck_directory, horizontal=0, vertical=1):
    """The domain's faces in the style of their walls, and the obstacles, cut in two axes."""
    low, high = deck["domain"]["min"], deck["domain"]["max"]
    for axis, other in ((horizontal, vertical), (vertical, horizontal)):
        for end, at in (("min", low[axis]), ("max", high[axis])):
            wall = deck.get("walls", {}).get(f"{AXES[axis]}_{end}", {})
            style = WALL_STYLES[wall.get("kind", "slip")]
            line = ([at, at], [low[other], high[other]])
            axes.plot(*(line if axis == horizontal else line[::-1]), **style, zorder=3)
    for obstacle in deck.get("obstacles", []):
        if len(low) == 3 and (horizontal, vertical) == (0, 1):
            draw_terrain(axes, obstacle["shape"], deck_directory)
        for points in outlines_in(obstacle["shape"], deck_directory, horizontal, vertical):
            axes.add_patch(patches.Polygon(points, closed=True, fc=(0.75, 0.75, 0.75, 1.0 if len(low) == 2 else 0.4), ec="k", lw=0.8, zorder=2))


def draw_terrain(axes, shape, directory):
    """Contour lines of a height map (ESRI ASCII grid) in the top view, for the eye: nothing where the file is not found."""
    kind, data = next(iter(shape.items()))
    path = directory / data["file"] if kind == "height_map" else None
    if path is None or path.suffix != ".asc" or not path.is_file():
        return
    header = {}
    with open(path, encoding="utf-8") as file:
        for _ in range(6):
            key, value = file.readline().split()
            header[key.lower()] = float(value)
        heights = np.loadtxt(file)[::-1] * data.get("vertical_scale", 1)
    offset = list(np.ravel(data.get("offset") or [])) + [0.0] * 3
    size = header["cellsize"]
    first = [header[f"{a}llcenter"] if f"{a}llcenter" in header else header[f"{a}llcorner"] + size / 2 for a in "xy"]
    x, y = (first[a] + offset[a] + size * np.arange(heights.shape[1 - a]) for a in (0, 1))
    lines = axes.contour(x, y, np.where(heights == header.get("nodata_value"), np.nan, heights) + offset[2], levels=25, colors="0.5", linewidths=0.5, zorder=0)
    axes.clabel(lines, lines.levels[::5], fontsize=6, fmt="%.0f")


def outlines_in(shape, directory, horizontal, vertical):
    kind, data = next(iter(shape.items()))
    pick = [horizontal, vertical]
    if kind == "box":
        return outline({"box": {"min": [data["min"][i] for i in pick], "max": [data["max"][i] for i in pick]}}, directory)
    if kind == "sphere":
        return outline({"sphere": {"center": [data["center"][i] for i in pick], "radius": data["radius"]}}, directory)
    if kind == "cylinder":
        ends = np.array([data["from"], data["to"]])[:, pick]
        if np.allclose(ends[0], ends[1]):
            return outline({"sphere": {"center": ends[0], "radius": data["radius"]}}, directory)
        side = np.array([-(ends[1] - ends[0])[1], (ends[1] - ends[0])[0]])
        side *= data["radius"] / np.linalg.norm(side)
        return [[ends[0] - side, ends[1] - side, ends[1] + side, ends[0] + side]]
    if kind in ("union", "difference"):
        return [line for part in (data if kind == "union" else data[:1]) for line in outlines_in(part, directory, horizontal, vertical)]
    return outline(shape, directory) if pick == [0, 1] else []


def view_box(results, frames, axes_pair):
    """What to show along two axes: the domain, cut back to where the material goes when that is much less."""
    low, high = np.array(results.deck["domain"]["min"], float), np.array(results.deck["domain"]["max"], float)
    ends = [(p.min(axis=0), p.max(axis=0)) for p in (f.field("position") for f in frames) if len(p)]
    if not ends:
        return [(low[a], high[a]) for a in axes_pair]
    first, last = np.min([e[0] for e in ends], axis=0), np.max([e[1] for e in ends], axis=0)
    margin = 0.08 * (last - first).max()
    return [(max(low[a], first[a] - margin), min(high[a], last[a] + margin)) for a in axes_pair]


def draw_2d(axes, frame, results, field, limits, box):
    position = frame.field("position")
    values = values_of(frame, field)
    spacing = particle_spacing(results.deck)
    axes.set_aspect("equal")
    axes.set_xlim(box[0]), axes.set_ylim(box[1])
    axes.figure.canvas.draw_idle()
    width = axes.get_window_extent().width * 72 / axes.figure.dpi
    size = max(0.4, 1.25 * spacing * width / (box[0][1] - box[0][0])) ** 2
    drawn = axes.scatter(position[:, 0], position[:, 1], c=values, s=size, cmap="viridis", vmin=limits[0], vmax=limits[1], linewidths=0, rasterized=True)
    draw_scene(axes, results.deck, results.deck_directory)
    label_axes(axes, 0, 1)
    return drawn


def label_axes(axes, horizontal, vertical):
    """Names of the axes, and few enough ticks for coordinates of a national grid, which are long, to fit."""
    axes.set_xlabel(f"{AXES[horizontal]}  m"), axes.set_ylabel(f"{AXES[vertical]}  m")
    if max(np.abs(axes.get_xlim())) >= 1e4:
        axes.locator_params(axis="x", nbins=5)


def splat(points, depth, values, spacing, box, pixels=1100):
    """An image of what lies nearest to the viewer (greatest depth), NaN where nothing is; pixels not finer than the particles."""
    size = max(1.25 * spacing, max(box[0][1] - box[0][0], box[1][1] - box[1][0]) / pixels)
    columns, rows = (int(np.ceil((b - a) / size)) + 1 for a, b in box)
    image, near = np.full((rows, columns), np.nan), np.full((rows, columns), np.nan)
    i = ((points[:, 0] - box[0][0]) / size).astype(int)
    j = ((points[:, 1] - box[1][0]) / size).astype(int)
    shown = (i >= 0) & (i < columns) & (j >= 0) & (j < rows)
    order = np.flatnonzero(shown)[np.argsort(depth[shown], kind="stable")]
    image[j[order], i[order]] = values[order]
    near[j[order], i[order]] = depth[order]
    return image, near, size


def draw_3d(axes, frame, results, field, limits, box, pair):
    """A view along the third axis; the shade follows the slope of the visible surface."""
    position = frame.field("position")
    across = 3 - pair[0] - pair[1]
    depth = position[:, across] * (1 if across == 2 else -1)
    image, near, size = splat(position[:, pair], depth, values_of(frame, field), particle_spacing(results.deck), box)
    colours = matplotlib.colormaps["viridis"]((image - limits[0]) / (limits[1] - limits[0]))
    slope = np.nan_to_num(np.gradient(near, size)[1] + np.gradient(near, size)[0] if min(near.shape) > 1 else near * 0)
    colours[..., :3] *= np.clip(0.85 + 0.15 * np.tanh(slope), 0.6, 1)[..., None]
    colours[np.isnan(image)] = 0
    (a, b), (c, d) = box
    axes.imshow(colours, origin="lower", extent=(a, a + size * image.shape[1], c, c + size * image.shape[0]), interpolation="nearest", zorder=1)
    axes.set_xlim(a, b), axes.set_ylim(c, d)
    draw_scene(axes, results.deck, results.deck_directory, *pair)
    axes.set_aspect("equal")
    label_axes(axes, *pair)
    return matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(*limits), "viridis")
