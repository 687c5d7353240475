"""The surface of a model's matter, where its bodies overlap or lie in each other: as slicers unite them, what has
matter on both sides bounds nothing."""
import numpy as np

from . import meshes
from . import triangles as exact
from .tree import Tree

PROBE_MM = 1e-3      # how far outside a sheet it is asked whether there is matter
COARSEST_MM = 2.0    # sheets that cross others are cut at least so small
FINEST_MM = 0.05     # and no smaller where they enter matter
BESIDE_MM = 0.1      # on either side of what closes a hole it is asked whether there is matter
ROWS = 100_000       # of points and triangles that are worked on at once
ROUNDING_MM = 1e-9   # of the plane a triangle lies in
# A triangle's probes, by its corners' weights: near the corners, near the middles of the edges, the middle; off any
# symmetry, so that no line through them meets an edge.
_PROBES = np.array([[.9807, .0112, .0081], [.0093, .9804, .0103], [.0117, .0096, .9787], [.4923, .4871, .0206],
                    [.0197, .4889, .4914], [.4907, .0211, .4882], [.3371, .3289, .3340]])


class Matter:
    """Tells whether points lie in the matter that corners bound: two lines of three have to say so, or four of six
    where the surface is open."""

    def __init__(self, corners, is_open):
        # x, y and z take turns as the way up; a point reflection looks down, and turns every triangle over
        views = [(shift, sign) for sign in ((1, -1) if is_open else (1,)) for shift in range(3)]
        self.views = [(shift, sign, Tree(np.roll(corners, shift, axis=2)[:, ::sign] * sign)) for shift, sign in views]

    def holds(self, points):
        votes = sum((tree.winding(np.roll(points, shift, axis=1) * sign) > 0).astype(int)
                    for shift, sign, tree in self.views)
        return votes * 3 >= len(self.views) * 2


def winding_by_angle(points, corners):
    """The same for a surface with holes, which need no line to miss them: a fraction, about 1/2 across a hole."""
    found = np.zeros(len(points))
    step = max(1, ROWS // len(corners))
    for at in range(0, len(points), step):
        a, b, c = (corners[None, :, k] - points[at:at + step, None] for k in range(3))
        la, lb, lc = (np.sqrt(np.einsum("...i,...i", arm, arm)) for arm in (a, b, c))
        volume = np.einsum("...i,...i", a, np.cross(b, c))
        dots = [np.einsum("...i,...i", p, q) for p, q in ((a, b), (b, c), (c, a))]
        angles = np.arctan2(volume, la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb)
        found[at:at + step] = angles.sum(axis=1) / (2 * np.pi)
    return found


class MatterByAngle:
    """Matter of a surface with holes: slow, but no line has to miss them."""

    def __init__(self, corners):
        self.corners = corners

    def holds(self, points):
        return winding_by_angle(points, self.corners) > 0.5


def bounds_by_angle(points, normals, corners):
    """Whether the matter of a surface with holes, where it goes round more than half, ends at the points."""
    by = BESIDE_MM * normals
    return (winding_by_angle(points - by, corners) > 0.5) & (winding_by_angle(points + by, corners) < 0.5)


def crossing(corners):
    """Which triangles meet another one that shares no corner with them."""
    _, index = meshes.weld(corners)
    tree = Tree(corners)
    named = index[tree.index]
    found = np.zeros(len(corners), dtype=bool)

    def overlap(low_a, high_a, low_b, high_b):
        return ((low_a <= high_b) & (low_b <= high_a)).all(axis=-1)
    for a, b in tree.near_pairs(tree, overlap):
        apart = (a < b) & ~(named[a][:, :, None] == named[b][:, None, :]).any(axis=(1, 2))
        a, b = a[apart], b[apart]
        near = exact.plane_gap(tree.corners[a], tree.corners[b]) <= ROUNDING_MM
        a, b = a[near], b[near]
        meet = exact.triangle_triangle(tree.corners[a], tree.corners[b]) <= 0
        found[tree.index[a[meet]]] = found[tree.index[b[meet]]] = True
    return found


def quartered(corners):
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    return np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])


def longest_edges(corners):
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0)


def outer_sheets(corners, is_open):
    """Those triangles, or pieces of them, outside of which there is no matter."""
    matter = Matter(corners, is_open)

    def inner(pieces, weights):
        points = np.einsum("k,nkx->nx", weights, pieces)
        return matter.holds(points + PROBE_MM * meshes.areas_and_normals(pieces)[1])
    crosses = crossing(corners)
    whole = corners[~crosses]
    kept = [whole[~inner(whole, _PROBES[-1])]]
    pieces = corners[crosses]
    while len(pieces):
        size = longest_edges(pieces)
        probes = np.stack([inner(pieces, weights) for weights in _PROBES], axis=1)
        mixed = ((probes != probes[:, :1]).any(axis=1) & (size > FINEST_MM)) | (size > COARSEST_MM)
        kept.append(pieces[~mixed & ~probes[:, -1]])
        pieces = quartered(pieces[mixed])
    outer = np.concatenate(kept)
    return outer if len(outer) else corners
