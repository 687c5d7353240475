"""The gap: the least Euclidean distance between parts on one tray, exactly, triangle by triangle."""
import numpy as np

from . import triangles as exact
from .tree import Tree, box_distance

GAP_TOLERANCE_MM = 1e-3


def surface_distance(first, second, reach):
    """Least distance between two trees' triangles if it is below reach, otherwise reach."""
    best = [reach]

    def keep(low_a, high_a, low_b, high_b):
        return box_distance(low_a, high_a, low_b, high_b) < best[0]

    for rows, others in first.near_pairs(second, keep):
        a, b = first.corners[rows], second.corners[others]
        bound = exact.plane_gap(a, b)
        order = np.argsort(bound)
        for at in range(0, len(order), 50_000):
            chosen = order[at:at + 50_000]
            chosen = chosen[bound[chosen] < best[0]]
            if len(chosen) == 0:
                break
            best[0] = min(best[0], float(exact.triangle_triangle(a[chosen], b[chosen]).min()))
    return best[0]


def inside_matter(inner, outer):
    """Whether a point of inner's surface lies in outer's matter. Their surfaces do not meet."""
    point = inner.corners[:1].mean(axis=1) + 1e-6
    return bool(outer.winding(point)[0] != 0)


def check_gap(job, report):
    gap = job.data["packing"]["gap_mm"]
    reach = max(1.5 * gap, gap + 0.5)
    trees = {part["id"]: Tree(job.triangles[part["id"]]) for part in job.readable_parts()}
    for tray in job.trays():
        ids = [part["id"] for part in job.parts_of_tray(tray)]
        least, where, close, swallowed = np.inf, "", [], []
        for at, first in enumerate(ids):
            for second in ids[at + 1:]:
                a, b = trees[first], trees[second]
                distance = surface_distance(a, b, reach)
                if distance < least:
                    least, where = distance, f"parts {first} and {second}"
                if distance < gap - GAP_TOLERANCE_MM:
                    close.append(f"{first} and {second} {distance:.4f} mm")
                if inside_matter(a, b) or inside_matter(b, a):
                    swallowed.append(f"{first} and {second}")
        told = f"{least:.4f} mm least, {where}" if least < reach else f"more than {reach} mm"
        figures = f"{told}; {gap} mm promised" if len(ids) > 1 else "one part"
        report.check(f"tray {tray}: parts keep gap_mm", not close, "; ".join(close[:6]) or figures)
        report.check(f"tray {tray}: no part inside another", not swallowed, "; ".join(swallowed[:6]))
    return trees
