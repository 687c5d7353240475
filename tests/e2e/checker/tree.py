"""A box tree over triangles. It is complete, so a node is a number and a whole front of nodes is one array."""
import copy

import numpy as np
from scipy.spatial import cKDTree

from . import triangles as exact

_LEAF = 6
_FRONT = 400_000  # rows worked on at once; bounds memory


def box_distance(low_a, high_a, low_b, high_b):
    """Euclidean distance between boxes, row by row."""
    return np.linalg.norm(np.maximum(0, np.maximum(low_a - high_b, low_b - high_a)), axis=-1)


class Tree:
    """corners: N×3×3, N ≥ 1. self.corners is the same, reordered; self.index tells the original row."""

    def __init__(self, corners):
        count = len(corners)
        self.depth = max(0, int(np.floor(np.log2(max(1, count / _LEAF)))))
        centres = corners.mean(axis=1)
        order = np.arange(count)
        for level in range(self.depth):
            bounds = np.linspace(0, count, 2 ** level + 1).astype(int)
            segment = np.repeat(np.arange(2 ** level), np.diff(bounds))
            middle = centres[order]
            extent = np.maximum.reduceat(middle, bounds[:-1]) - np.minimum.reduceat(middle, bounds[:-1])
            axis = extent.argmax(axis=1)[segment]
            order = order[np.lexsort((middle[np.arange(count), axis], segment))]
        self.index = order
        self.corners = corners[order]
        self.low, self.high = self.corners.min(axis=1), self.corners.max(axis=1)
        self.bounds = np.linspace(0, count, 2 ** self.depth + 1).astype(int)
        low = [np.minimum.reduceat(self.low, self.bounds[:-1])]
        high = [np.maximum.reduceat(self.high, self.bounds[:-1])]
        while len(low[0]) > 1:
            low.insert(0, np.minimum(low[0][0::2], low[0][1::2]))
            high.insert(0, np.maximum(high[0][0::2], high[0][1::2]))
        self.node_low, self.node_high = np.concatenate(low), np.concatenate(high)
        self.first_leaf = 2 ** self.depth - 1
        self._samples = None

    def moved(self, offset):
        """The same triangles, shifted."""
        other = copy.copy(self)
        for name in ("corners", "low", "high", "node_low", "node_high"):
            setattr(other, name, getattr(self, name) + offset)
        other._samples = None
        return other

    def near_pairs(self, other, keep):
        """Yields arrays (rows here, rows there) of triangles whose boxes keep(low_a, high_a, low_b, high_b)
        accepts; keep must accept a box whenever it accepts one inside it."""
        stack = [(np.zeros(1, dtype=int), np.zeros(1, dtype=int))]
        while stack:
            a, b = stack.pop()
            kept = keep(self.node_low[a], self.node_high[a], other.node_low[b], other.node_high[b])
            a, b = a[kept], b[kept]
            open_a, open_b = a < self.first_leaf, b < other.first_leaf
            done = ~open_a & ~open_b
            yield from self._leaf_pairs(other, a[done], b[done], keep)
            a, b, open_a, open_b = a[~done], b[~done], open_a[~done], open_b[~done]
            fronts = []
            for da in (1, 2):
                for db in (1, 2):
                    take = (open_a | (da == 1)) & (open_b | (db == 1))
                    fronts.append((np.where(open_a, 2 * a + da, a)[take], np.where(open_b, 2 * b + db, b)[take]))
            next_a, next_b = (np.concatenate(side) for side in zip(*fronts))
            for at in range(0, len(next_a), _FRONT):
                stack.append((next_a[at:at + _FRONT], next_b[at:at + _FRONT]))

    def _leaf_pairs(self, other, a, b, keep):
        a, b = a - self.first_leaf, b - other.first_leaf
        step = max(1, _FRONT // (2 * _LEAF) ** 2)
        for at in range(0, len(a), step):
            pair, rows = _expand(self.bounds, a[at:at + step])
            inner, others = _expand(other.bounds, b[at:at + step][pair])
            rows = rows[inner]
            kept = keep(self.low[rows], self.high[rows], other.low[others], other.high[others])
            yield rows[kept], others[kept]

    def closest(self, points, limit=np.inf):
        """(distance, original row of the closest triangle) for every point; beyond limit: (inf, -1)."""
        if self._samples is None:
            self._samples = cKDTree(np.concatenate([self.corners.reshape(-1, 3), self.corners.mean(axis=1)]))
        distance, row = np.full(len(points), np.inf), np.full(len(points), -1)
        for at in range(0, len(points), 20_000):
            batch = points[at:at + 20_000]
            reach = np.minimum(self._samples.query(batch)[0] * (1 + 1e-9) + 1e-9, limit)
            found, where = self._closest(batch, reach)
            distance[at:at + 20_000], row[at:at + 20_000] = found, where
        return distance, row

    def _near_rows(self, points, keep):
        """(point, row) wherever keep(point numbers, low, high) accepts the boxes down to the triangle's."""
        point, node = np.arange(len(points)), np.zeros(len(points), dtype=int)
        for level in range(self.depth + 1):
            kept = keep(point, self.node_low[node], self.node_high[node])
            point, node = point[kept], node[kept]
            if level < self.depth:
                point, node = np.repeat(point, 2), np.stack([2 * node + 1, 2 * node + 2], axis=1).ravel()
        pair, rows = _expand(self.bounds, node - self.first_leaf)
        kept = keep(point[pair], self.low[rows], self.high[rows])
        return point[pair][kept], rows[kept]

    def winding(self, points):
        """How often the surface goes round each point, by the surfaces above it: 1 inside a closed outward
        mesh, 0 outside."""
        count = np.zeros(len(points), dtype=int)
        for at in range(0, len(points), 20_000):
            batch = points[at:at + 20_000]
            who, row = self._near_rows(batch, lambda p, low, high: (
                (batch[p, :2] >= low[:, :2]) & (batch[p, :2] <= high[:, :2])).all(axis=1) & (batch[p, 2] <= high[:, 2]))
            sign = exact.below(batch[who], self.corners[row])
            np.add.at(count, at + who, sign)
        return count

    def _closest(self, points, reach):
        point, rows = self._near_rows(points, lambda p, low, high: (
            box_distance(points[p], points[p], low, high) <= reach[p]))
        square = exact.point_triangle(points[point], self.corners[rows])
        order = np.lexsort((square, point))
        first, where = np.unique(point[order], return_index=True)
        distance, row = np.full(len(points), np.inf), np.full(len(points), -1)
        distance[first] = np.sqrt(square[order][where])
        row[first] = self.index[rows[order][where]]
        far = distance > reach + 1e-12
        distance[far], row[far] = np.inf, -1
        return distance, row


def _expand(bounds, leaves):
    """(which leaf of the list, triangle row) for every triangle of every leaf."""
    counts = bounds[leaves + 1] - bounds[leaves]
    which = np.repeat(np.arange(len(leaves)), counts)
    within = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    return which, bounds[leaves][which] + within
