"""How rough the pressure of particles is from one to the next: what a plane through a neighbourhood leaves of it, in 2D and 3D."""
import itertools

import numpy as np

LEAST = {2: 9, 3: 27}  # particles that a plane is laid through, by dimension


def blocks_of_three(cells, dim):
    """Sums over the 3^dim cells around each cell of a grid [x, y, …, then anything]."""
    wide = np.pad(cells, [(1, 1)] * dim + [(0, 0)] * (cells.ndim - dim))
    return sum(wide[tuple(slice(i, i + n) for i, n in zip(corner, cells.shape))] for corner in itertools.product(range(3), repeat=dim))


def residual(position, value, low, cell, count):
    """Value of each particle less the plane that fits those of the 3 cells around along each axis best; NaN where one of these cells is empty,
    so that free surfaces and spray do not count. `low`: lower corner of the grid of `count` cells."""
    dim = len(count)
    at = (position - low) / cell
    index = np.clip(at.astype(int), 0, np.array(count) - 1)
    place = at - index - 0.5
    # A plane a + b·x in the middle cell's own coordinates: the sums of its normal equations from moments about the lattice origin.
    basis = np.c_[np.ones(len(at)), at]
    number = np.zeros(count)
    moments, values = np.zeros((*count, dim + 1, dim + 1)), np.zeros((*count, dim + 1))
    where = tuple(index.T)
    np.add.at(number, where, 1)
    np.add.at(moments, where, basis[:, :, None] * basis[:, None, :])
    np.add.at(values, where, basis * value[:, None])
    full = blocks_of_three((number > 0).astype(float), dim) == blocks_of_three(np.ones(count), dim)  # cells beyond a face count as full
    good = full & (blocks_of_three(number, dim) >= LEAST[dim])
    moments, values = blocks_of_three(moments, dim)[good], blocks_of_three(values, dim)[good]
    shift = np.zeros((len(moments), dim + 1, dim + 1))
    shift[:, range(dim + 1), range(dim + 1)] = 1
    shift[:, 1:, 0] = -(np.argwhere(good) + 0.5)
    moments, values = shift @ moments @ np.swapaxes(shift, -1, -2), (shift @ values[..., None])
    plane = np.full((*count, dim + 1), np.nan)
    plane[good] = np.linalg.solve(moments, values)[..., 0]
    return value - np.einsum("pk,pk->p", np.c_[np.ones(len(place)), place], plane[where])


def roughness(frames, deck, weight, body=None):
    """Root mean square over the particles of several frames, in parts of `weight`."""
    low, high, cell = (np.array(deck["domain"][key]) for key in ("min", "max", "cell_size"))
    count = tuple(int(n) for n in np.round((high - low) / cell))
    left = [residual(f.field("position", body), f.field("pressure", body), low, cell, count) for f in frames]
    left = np.concatenate(left)
    return np.sqrt(np.nanmean(left**2)) / weight
