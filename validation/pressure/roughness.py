"""How rough the pressure of particles is from one to the next: what a plane through a neighbourhood leaves of it."""
import numpy as np

LEAST = 9  # particles that a plane is laid through


def blocks_of_three(cells):
    """Sums over the 3 x 3 cells around each cell of a grid [x, y, …]."""
    wide = np.pad(cells, [(1, 1), (1, 1)] + [(0, 0)] * (cells.ndim - 2))
    return sum(wide[i : i + cells.shape[0], j : j + cells.shape[1]] for i in range(3) for j in range(3))


def residual(position, value, low, cell, count):
    """Value of each particle less the plane that fits those of the 3 x 3 cells around best; NaN where one of these cells is empty, so that free
    surfaces and spray do not count. `low`: lower corner of the grid of `count` cells."""
    at = (position - low) / cell
    index = np.clip(at.astype(int), 0, np.array(count) - 1)
    place = at - index - 0.5
    # A plane a + b x + c y in the middle cell's own coordinates: the sums of its normal equations from moments about the lattice origin.
    basis = np.c_[np.ones(len(at)), at]
    number = np.zeros(count)
    moments, values = np.zeros((*count, 3, 3)), np.zeros((*count, 3))
    where = (index[:, 0], index[:, 1])
    np.add.at(number, where, 1)
    np.add.at(moments, where, basis[:, :, None] * basis[:, None, :])
    np.add.at(values, where, basis * value[:, None])
    full = blocks_of_three((number > 0).astype(float)) == inside(count)
    good = full & (blocks_of_three(number) >= LEAST)
    moments, values = blocks_of_three(moments), blocks_of_three(values)
    middle = np.stack(np.meshgrid(np.arange(count[0]) + 0.5, np.arange(count[1]) + 0.5, indexing="ij"), -1)
    shift = np.zeros((*count, 3, 3))
    shift[..., 0, 0] = shift[..., 1, 1] = shift[..., 2, 2] = 1
    shift[..., 1, 0], shift[..., 2, 0] = -middle[..., 0], -middle[..., 1]
    moments, values = shift @ moments @ np.swapaxes(shift, -1, -2), (shift @ values[..., None])
    plane = np.full((*count, 3), np.nan)
    plane[good] = np.linalg.solve(moments[good], values[good])[..., 0]
    return value - np.einsum("pk,pk->p", np.c_[np.ones(len(place)), place], plane[where])


def inside(count):
    """How many of the 3 x 3 cells around each cell the grid has: fewer along its faces, which count as full beyond."""
    return blocks_of_three(np.ones(count))


def roughness(frames, deck, weight, body=None):
    """Root mean square over the particles of several frames, in parts of `weight`."""
    low, high, cell = (np.array(deck["domain"][key]) for key in ("min", "max", "cell_size"))
    count = tuple(int(n) for n in np.round((high - low) / cell))
    left = [residual(f.field("position", body), f.field("pressure", body), low, cell, count) for f in frames]
    left = np.concatenate(left)
    return np.sqrt(np.nanmean(left**2)) / weight
