"""Taking the parts out, in the order given: straight up, or by the path given and then straight up.

Straight up is decided exactly. A part collides when, on some vertical line, another part's upward surface
lies above its downward surface; over the overlap of two triangles seen from above the difference in height
is linear, so its greatest value stands at a corner of that overlap.
A path is followed by conservative advancement: where the nearest remaining part is d away, the part may move
by d.
"""
import numpy as np

from . import triangles as exact
from .report import first_few
from .separation import surface_distance
from .tree import Tree

TOUCH_MM = 1e-3       # overlaps thinner than this, seen from above, count as touching
LEAST_STEP_MM = 0.02  # of the advancement; nearer than this counts as a collision


def _facing(tree, up):
    """The tree of the triangles that look up (or down); None where there are none."""
    c = tree.corners
    area = (c[:, 1, 0] - c[:, 0, 0]) * (c[:, 2, 1] - c[:, 0, 1]) - (c[:, 1, 1] - c[:, 0, 1]) * (c[:, 2, 0] - c[:, 0, 0])
    chosen = c[area > 0] if up else c[area < 0]
    return Tree(chosen) if len(chosen) else None


def _overlap_depth(first, second):
    """How deep two triangles overlap, seen from above (separating axes); at most 0: apart."""
    depth = np.full(len(first), np.inf)
    for axis_of in (first, second):
        for i, j in ((0, 1), (1, 2), (2, 0)):
            edge = axis_of[:, j, :2] - axis_of[:, i, :2]
            length = np.linalg.norm(edge, axis=1)
            normal = np.stack([-edge[:, 1], edge[:, 0]], axis=1) / np.where(length > 0, length, 1)[:, None]
            a = np.einsum("kci,ki->kc", first[:, :, :2], normal)
            b = np.einsum("kci,ki->kc", second[:, :, :2], normal)
            overlap = np.minimum(a.max(axis=1), b.max(axis=1)) - np.maximum(a.min(axis=1), b.min(axis=1))
            depth = np.minimum(depth, np.where(length > 0, overlap, 0))
    return depth


def _height(x, y, triangles):
    """(inside seen from above, height of the triangle's plane there)"""
    weights = exact.projected_weights(x, y, triangles)
    area = weights.sum(axis=1)
    sign = np.sign(area)[:, None]
    return (weights * sign >= 0).all(axis=1), np.einsum("ki,ki->k", weights, triangles[:, :, 2]) / area


def greatest_rise(lower, upper):
    """For every pair: the greatest height of upper above lower over their overlap; -inf where there is none."""
    rise = np.full(len(lower), -np.inf)
    overlapping = np.flatnonzero(_overlap_depth(lower, upper) > TOUCH_MM)
    a, b = lower[overlapping], upper[overlapping]
    best = np.full(len(a), -np.inf)

    def consider(x, y, valid):
        inside_a, height_a = _height(x, y, a)
        inside_b, height_b = _height(x, y, b)
        use = valid(inside_a, inside_b)
        np.maximum(best, np.where(use, height_b - height_a, -np.inf), out=best)

    for k in range(3):
        consider(a[:, k, 0], a[:, k, 1], lambda _, in_b: in_b)
        consider(b[:, k, 0], b[:, k, 1], lambda in_a, _: in_a)
    for i, j in ((0, 1), (1, 2), (2, 0)):
        for k, l in ((0, 1), (1, 2), (2, 0)):
            d, e = a[:, j, :2] - a[:, i, :2], b[:, l, :2] - b[:, k, :2]
            w = b[:, k, :2] - a[:, i, :2]
            cross = d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0]
            safe = np.where(cross != 0, cross, 1)
            t = (w[:, 0] * e[:, 1] - w[:, 1] * e[:, 0]) / safe
            u = (w[:, 0] * d[:, 1] - w[:, 1] * d[:, 0]) / safe
            meets = (cross != 0) & (t >= 0) & (t <= 1) & (u >= 0) & (u <= 1)
            point = a[:, i, :2] + t[:, None] * d
            consider(point[:, 0], point[:, 1], lambda _a, _b: meets)
    rise[overlapping] = best
    return rise


def blocked_by(tree, other):
    """How far (mm) other's matter stands above tree's on a common vertical line; 0: tree lifts freely."""
    bottom, top = _facing(tree, up=False), _facing(other, up=True)
    if bottom is None or top is None:
        return 0.0

    def keep(low_a, high_a, low_b, high_b):
        across = (low_a[:, :2] <= high_b[:, :2]) & (low_b[:, :2] <= high_a[:, :2])
        return across.all(axis=1) & (high_b[:, 2] > low_a[:, 2])

    worst = 0.0
    for rows, others in bottom.near_pairs(top, keep):
        for at in range(0, len(rows), 50_000):
            a, b = bottom.corners[rows[at:at + 50_000]], top.corners[others[at:at + 50_000]]
            worst = max(worst, float(greatest_rise(a, b).max(initial=0)))
    return worst if worst > TOUCH_MM else 0.0


def follow(tree, others, path):
    """(where the path ends, what it met): conservative advancement against the trees of others."""
    place = np.zeros(3)
    for step in path:
        length = float(np.linalg.norm(step))
        gone = 0.0
        while gone < length:
            here = tree.moved(place + np.array(step) * (gone / length))
            room = min([surface_distance(here, other, length - gone + LEAST_STEP_MM) for other in others.values()],
                       default=np.inf)
            if room < LEAST_STEP_MM:
                return place, f"meets another part after {gone:.2f} mm of the step {step}"
            gone += room
        place = place + np.array(step)
    return place, ""


def check_removal(job, trees, report):
    order = job.data["removal_order"]
    ids = sorted(part["id"] for part in job.parts())
    if not report.check("removal_order lists every part once", sorted(order) == ids, first_few(order, 30)):
        return
    paths = job.data.get("removal_path") or {}
    known = [key for key in paths if not key.isdigit() or int(key) not in ids]
    report.check("removal_path belongs to parts", not known, first_few(known))
    collisions = []
    tray_of = {part["id"]: part["tray"] for part in job.parts()}
    for at, part_id in enumerate(order):
        others = {i: trees[i] for i in order[at + 1:] if i in trees and tray_of[i] == tray_of[part_id]}
        if part_id not in trees:
            continue
        tree = trees[part_id]
        if str(part_id) in paths:
            place, met = follow(tree, others, paths[str(part_id)])
            tree = tree.moved(place)
            if met:
                collisions.append(f"part {part_id} {met}")
        for other_id, other in others.items():
            rise = blocked_by(tree, other)
            if rise:
                collisions.append(f"part {part_id} under part {other_id} by {rise:.3f} mm")
    report.check("removal_order: every part comes out freely", not collisions,
                 first_few(collisions) or f"{len(order)} parts, {len(paths)} by a path")
