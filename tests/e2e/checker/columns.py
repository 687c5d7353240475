"""Vertical lines through triangle meshes."""
import numpy as np

from .triangles import projected_weights

_CELLS = 2_000_000  # tests worked on at once; bounds memory


class Grid:
    """Lines at origin + step·(i, j), 0 ≤ i < nx, 0 ≤ j < ny, covering the box; off any round number, so
    that no line meets an edge exactly."""

    def __init__(self, low, high, step, most_lines=2_000_000):
        width = np.maximum(np.asarray(high)[:2] - np.asarray(low)[:2], 1e-6)
        self.step = max(step, float(np.sqrt(width[0] * width[1] / most_lines)))
        self.origin = np.asarray(low)[:2] - self.step * np.array([0.3819660113, 0.2360679775])
        self.nx, self.ny = (int(n) for n in np.ceil(width / self.step) + 2)

    def crossings(self, corners):
        """Where lines meet triangles: (line, z, triangle), unsorted. Vertical triangles meet none."""
        found = [self._chunk(corners, rows) for rows in self._chunks(corners)]
        if not found:
            return np.zeros(0, dtype=int), np.zeros(0), np.zeros(0, dtype=int)
        return tuple(np.concatenate(column) for column in zip(*found))

    def _ranges(self, corners):
        low = np.ceil((corners[:, :, :2].min(axis=1) - self.origin) / self.step).astype(int)
        high = np.floor((corners[:, :, :2].max(axis=1) - self.origin) / self.step).astype(int)
        low = np.clip(low, 0, [self.nx, self.ny])
        return low, np.maximum(np.clip(high, -1, [self.nx - 1, self.ny - 1]) - low + 1, 0)

    def _chunks(self, corners):
        _, size = self._ranges(corners)
        cells = size[:, 0] * size[:, 1]
        rows = np.flatnonzero(cells)
        groups = np.cumsum(cells[rows]) // _CELLS
        return np.split(rows, np.flatnonzero(np.diff(groups)) + 1) if len(rows) else []

    def _chunk(self, corners, rows):
        low, size = self._ranges(corners[rows])
        cells = size[:, 0] * size[:, 1]
        which = np.repeat(np.arange(len(rows)), cells)
        within = np.arange(len(which)) - np.repeat(np.cumsum(cells) - cells, cells)
        i = low[which, 0] + within % size[which, 0]
        j = low[which, 1] + within // size[which, 0]
        x, y = self.origin[0] + i * self.step, self.origin[1] + j * self.step
        chosen = corners[rows][which]
        weights = projected_weights(x, y, chosen)
        area = weights.sum(axis=1)
        sign = np.sign(area)
        inside = (sign != 0) & (weights * sign[:, None] > 0).all(axis=1)
        z = np.einsum("ki,ki->k", weights[inside], chosen[inside][:, :, 2]) / area[inside]
        return (j * self.nx + i)[inside], z, rows[which[inside]]


def intervals(grid, corners):
    """One closed mesh: (line, bottom, top, triangle of the bottom) of its matter, sorted by line and
    bottom; and how many lines did not alternate between entering and leaving (they are left out)."""
    line, z, row = grid.crossings(corners)
    up = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[row, 2] > 0
    order = np.lexsort((up, z, line))
    line, z, row, up = line[order], z[order], row[order], up[order]
    starts = np.flatnonzero(np.diff(line, prepend=-1))
    counts = np.diff(np.append(starts, len(line)))
    place = np.arange(len(line)) - np.repeat(starts, counts)
    wrong = (up != (place % 2 == 1)) | (np.repeat(counts, counts) % 2 == 1)
    bad_lines = np.unique(line[wrong])
    good = ~np.isin(line, bad_lines)
    line, z, row = line[good], z[good], row[good]
    return (line[0::2], z[0::2], z[1::2], row[0::2]), len(bad_lines), len(starts)
