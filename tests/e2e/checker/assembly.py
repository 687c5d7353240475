"""The parts, moved back by the inverse of their transforms, are the model.

Every point of the parts' surface is one of four: on a cut (another part's surface faces it there), on the
model's surface, on a cavity's wall (inside the model, about a wall away from its surface), or wrong. The model's
surface is that of the matter: sheets within it are nobody's (outside.py), nor need a few crevices narrower than
WIDEST_CREVICE_MM stay open.
"""
import hashlib
import pathlib

import numpy as np

from . import meshes
from .columns import Grid, intervals
from .outside import Matter, MatterByAngle, bounds_by_angle, outer_sheets
from .report import first_few
from .tree import Tree

SURFACE_TOLERANCE_MM = 0.1
CUT_TOLERANCE_MM = 0.01
OVERLAP_TOLERANCE_MM = 0.05
SHELL_TOLERANCE = 1e-3
GLUE_TOLERANCE = 0.02
WIDEST_CREVICE_MM = 0.05  # that may be filled, nor wider than half the tolerance
CREVICE_SHARES = (0.1, 0.3, 1.0)  # of that: where a crevice's other side is looked for
MOST_FILLED = 0.01        # of the points of the model's surface may lie in filled crevices
LEAST_GLUE_MM2 = 1.0      # neighbours that touch less need not be listed
CAVITY_FRACTION = 0.4     # of wall_mm: a cavity's wall is at least so deep below the model's surface
SOLID_FRACTION = 0.995    # parts that hold this much of the model's volume have no cavity
SAMPLE_MM2 = 0.5          # a sample for so much area, at least one a triangle
MOST_SAMPLES = 400_000
MOST_DOUBTFUL = 2000      # points of a model with holes whose place is found the slow way; more are wrong


def sample_surface(corners):
    """(points, rows): every triangle's centroid, and more spread evenly over large triangles."""
    areas, _ = meshes.areas_and_normals(corners)
    spacing = max(SAMPLE_MM2, float(areas.sum()) / MOST_SAMPLES)
    extra = np.floor(areas / spacing).astype(int)
    rows = np.repeat(np.arange(len(corners)), extra)
    random = np.random.default_rng(7)
    u, v = random.random((2, len(rows)))
    flip = u + v > 1
    u, v = np.where(flip, 1 - u, u), np.where(flip, 1 - v, v)
    c = corners[rows]
    points = c[:, 0] + u[:, None] * (c[:, 1] - c[:, 0]) + v[:, None] * (c[:, 2] - c[:, 0])
    return np.concatenate([corners.mean(axis=1), points]), np.concatenate([np.arange(len(corners)), rows])


class Assembled:
    """The parts of one input back in model coordinates."""

    def __init__(self, job, model):
        self.parts = [part for part in job.readable_parts() if part["model"] == model]
        self.corners = {part["id"]: job.in_model(part) for part in self.parts}
        self.trees = {part_id: Tree(corners) for part_id, corners in self.corners.items()}

    def all_corners(self):
        return np.concatenate(list(self.corners.values()))

    def facing_other(self, part_id, points, normals):
        """{other part: rows of points that lie on its surface, which faces the other way}"""
        low, high = points.min(axis=0) - 1e-3, points.max(axis=0) + 1e-3
        found = {}
        for other, tree in self.trees.items():
            apart = (tree.node_low[0] > high).any() or (tree.node_high[0] < low).any()
            if other == part_id or apart:
                continue
            _, row = tree.closest(points, CUT_TOLERANCE_MM)
            touching = np.flatnonzero(row >= 0)
            other_normals = meshes.areas_and_normals(self.corners[other][row[touching]])[1]
            opposite = np.einsum("ij,ij->i", normals[touching], other_normals) < 0
            found[other] = touching[opposite]
        return found


def check_assembly(job, model_files, report):
    volumes = sum(part["volume_mm3"] for part in job.parts())
    shell = job.data["shell"]["volume_mm3"]
    report.check("parts' volumes sum to shell.volume_mm3", abs(volumes - shell) <= SHELL_TOLERANCE * shell,
                 f"{volumes:.2f} and {shell:.2f} mm³, {100 * (volumes / shell - 1):+.4f} %")
    for number, entry in enumerate(job.data["inputs"]):
        assembled = Assembled(job, number)
        if not report.check(f"input {number} has parts", len(assembled.parts) > 0, entry["file"]):
            continue
        _check_overlap(assembled, number, report)
        _check_glue(assembled, number, report)
        path = model_of(entry, model_files)
        if not model_files:
            report.skip(f"input {number}: parts put back lie on the model", "no --model given")
        elif report.check(f"input {number}: a given model has the sha256 of inputs", path is not None, entry["file"]):
            corners = meshes.read_model(path) * entry["scale"]
            _check_surface(job, assembled, corners, number, report)


def model_of(entry, files):
    for path in files:
        if hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest() == entry["sha256"]:
            return path
    return None


def _check_overlap(assembled, number, report):
    corners = assembled.all_corners().reshape(-1, 3)
    grid = Grid(corners.min(axis=0), corners.max(axis=0), 0.5)
    spans, owners, bad, lines = [], [], 0, 0
    for part_id, triangles in assembled.corners.items():
        (line, bottom, top, _), wrong, total = intervals(grid, triangles)
        spans.append(np.stack([line, bottom, top]))
        owners.append(np.full(len(line), part_id))
        bad, lines = bad + wrong, lines + total
    line, bottom, top = np.concatenate(spans, axis=1)
    owner = np.concatenate(owners)
    order = np.lexsort((bottom, line))
    line, bottom, top, owner = line[order], bottom[order], top[order], owner[order]
    excess = np.where(line[1:] == line[:-1], np.minimum(top[:-1], top[1:]) - bottom[1:], 0)
    worst = np.flatnonzero(excess > OVERLAP_TOLERANCE_MM)
    pairs = sorted({f"{min(owner[k], owner[k + 1])} and {max(owner[k], owner[k + 1])}" for k in worst})
    report.check(f"input {number}: parts put back do not overlap", len(worst) == 0,
                 f"{first_few(pairs)}: {len(worst)} lines, {excess.max():.3f} mm at most" if len(worst) else
                 f"{max(0.0, excess.max(initial=0)):.5f} mm at most on {lines} lines")
    report.check(f"input {number}: lines through parts enter and leave", bad <= 1e-3 * lines, f"all but {bad} of {lines}")


def _check_glue(assembled, number, report):
    """Compares glue_area_mm2 with the area of the triangles that face each other; centroids stand for them."""
    wrong, area_of, total = [], {}, 0
    for part in assembled.parts:
        areas, normals = meshes.areas_and_normals(assembled.corners[part["id"]])
        centres = assembled.corners[part["id"]].mean(axis=1)
        for other, rows in assembled.facing_other(part["id"], centres, normals).items():
            area_of[part["id"], other] = float(areas[rows].sum())
    for part in assembled.parts:
        told = {n["id"]: n["glue_area_mm2"] for n in part["neighbours"]}
        total += len(told)
        for other in {key[1] for key in area_of if key[0] == part["id"]} | set(told):
            # one side's triangles may be coarser than the contact; the better of the two sides counts
            measured = [area_of.get(key, 0.0) for key in ((part["id"], other), (other, part["id"]))]
            off = min(abs(value - told.get(other, 0.0)) for value in measured)
            allowed = GLUE_TOLERANCE * told.get(other, 0.0) + LEAST_GLUE_MM2
            if off > allowed and part["id"] < other:
                wrong.append(f"{part['id']}-{other} {told.get(other, 'unlisted')} told, {measured[0]:.2f} measured")
    report.check(f"input {number}: neighbours share their glue_area_mm2", not wrong,
                 first_few(wrong) or f"{total // 2} joints")


def _check_surface(job, assembled, model, number, report):
    tolerance = max(SURFACE_TOLERANCE_MM, job.data.get("resample_tolerance_mm") or 0)
    wall = job.data["shell"]["wall_mm"]
    volume = sum(meshes.volume(corners) for corners in assembled.corners.values())
    rim = open_rim(model)
    matter = Matter(model, is_open=rim is not None)
    outside = outer_sheets(model, is_open=rim is not None)
    outside_tree = Tree(outside)
    hollow = wall > 0 and volume < SOLID_FRACTION * meshes.volume(outside)
    kinds = {"model": 0, "cut": 0, "cavity": 0, "hole": 0}
    furthest, wrong, shallowest = 0.0, [], np.inf
    for part in assembled.parts:
        corners = assembled.corners[part["id"]]
        points, rows = sample_surface(corners)
        normals = meshes.areas_and_normals(corners)[1][rows]
        cut = np.zeros(len(points), dtype=bool)
        for touching in assembled.facing_other(part["id"], points, normals).values():
            cut[touching] = True
        points = points[~cut]
        distance, _ = outside_tree.closest(points)
        off = distance > tolerance
        inside = np.zeros(len(points), dtype=bool)
        inside[off] = matter.holds(points[off])
        cavity = off & inside & (distance >= CAVITY_FRACTION * wall) & hollow
        hole = off & ~cavity & _nearest_is(rim, points, distance)
        doubtful = np.flatnonzero(off & ~cavity & ~hole)[:MOST_DOUBTFUL if rim else 0]
        hole[doubtful] = bounds_by_angle(points[doubtful], normals[~cut][doubtful], model)
        bad = off & ~cavity & ~hole
        kinds["cut"] += int(cut.sum())
        kinds["model"] += int((~off).sum())
        kinds["cavity"] += int(cavity.sum())
        kinds["hole"] += int(hole.sum())
        furthest = max(furthest, float(distance[~cavity & ~hole].max(initial=0)))
        shallowest = min(shallowest, float(distance[cavity].min(initial=np.inf)))
        if bad.any():
            worst = int(np.flatnonzero(bad)[distance[bad].argmax()])
            wrong.append(f"part {part['id']}: {bad.sum()} of {len(distance)} points, "
                         f"{distance[worst]:.4f} mm at {np.round(points[worst], 2).tolist()}")
    counts = ", ".join(f"{count} {kind}" for kind, count in kinds.items())
    report.check(f"input {number}: the parts' outer surface lies on the model", not wrong,
                 first_few(wrong, 3) or f"{furthest:.5f} mm at most, {tolerance} mm allowed ({counts} points)")
    if kinds["cavity"]:
        report.note(f"input {number}: cavity walls below the model's surface", f"{shallowest:.3f} mm least, wall_mm {wall}")
    check_coverage(assembled, outside, MatterByAngle(model) if rim else matter, tolerance, number, report)


def filled_crevice(matter, parts, points, normals, tolerance):
    """Which points lie in the parts' matter, and face more of the model's a crevice's width away."""
    width = min(tolerance / 2, WIDEST_CREVICE_MM)
    filled = np.zeros(len(points), dtype=bool)
    if not len(points):
        return filled
    left = np.flatnonzero(Matter(parts, is_open=False).holds(points))
    for share in CREVICE_SHARES:
        filled[left] = matter.holds(points[left] + share * width * normals[left])
        left = left[~filled[left]]
    return filled


def check_coverage(assembled, outside, matter, tolerance, number, report):
    """From the model to the parts."""
    points, rows = sample_surface(outside)
    parts = assembled.all_corners()
    distance, _ = Tree(parts).closest(points)
    off = np.flatnonzero(distance > tolerance)
    may_be_filled = off[:int(MOST_FILLED * len(points)) + 1]  # more are too many
    normals = meshes.areas_and_normals(outside[rows[may_be_filled]])[1]
    filled = may_be_filled[filled_crevice(matter, parts, points[may_be_filled], normals, tolerance)]
    distance[filled] = 0
    bad = np.flatnonzero(distance > tolerance)
    figures = f"{distance.max(initial=0):.5f} mm at most, {len(points)} points"
    if len(bad):
        worst = distance.argmax()
        figures = f"{len(bad)} of {len(points)} points off, {distance[worst]:.4f} mm at {np.round(points[worst], 2).tolist()}"
    report.check(f"input {number}: the model's surface is covered by the parts", len(bad) == 0, figures)
    report.check(f"input {number}: few points of the model lie in filled crevices", len(filled) <= MOST_FILLED * len(points),
                 f"{len(filled)} of {len(points)} points")


def open_rim(corners):
    """The model's open edges as a tree of flat triangles; None where it is closed."""
    points, index = meshes.weld(corners)
    start, end = index.ravel(), np.roll(index, -1, axis=1).ravel()
    keys = np.stack([np.minimum(start, end), np.maximum(start, end)], axis=1)
    edges, uses = np.unique(keys, axis=0, return_counts=True)
    edges = edges[uses == 1]
    return Tree(points[np.concatenate([edges, edges[:, 1:]], axis=1)]) if len(edges) else None


def _nearest_is(rim, points, distance):
    """Whether the model's nearest point lies on its rim: such a point of the parts closes a hole."""
    if rim is None:
        return np.zeros(len(points), dtype=bool)
    to_rim, _ = rim.closest(points)
    return to_rim <= distance + 0.02
