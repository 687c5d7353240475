"""V_bp, height, V_s and the cost, measured anew."""
import numpy as np

from .columns import Grid, intervals

BOX_TOLERANCE = 1e-3
SUPPORT_TOLERANCE = 0.03
SUPPORT_FLOOR_MM3 = 5.0    # differences below this are noise of the columns
COST_TOLERANCE = 5e-3
COLUMN_MM = 0.2


def tray_box(job, tray):
    """Size of the contents' box, z from the tray up."""
    corners = np.concatenate([job.triangles[part["id"]] for part in job.parts_of_tray(tray)]).reshape(-1, 3)
    low, high = corners.min(axis=0), corners.max(axis=0)
    return np.array([high[0] - low[0], high[1] - low[1], high[2]])


def tray_support(job, tray, angle_deg):
    """(least, most) V_s: facets within a float's rounding of the support angle may count or not."""
    parts = [job.triangles[part["id"]] for part in job.parts_of_tray(tray)]
    every = np.concatenate(parts).reshape(-1, 3)
    grid = Grid(every.min(axis=0), every.max(axis=0), COLUMN_MM)
    line, bottom, top, down, lost, total = [], [], [], [], 0, 0
    for corners in parts:
        (at, low, high, row), bad, lines = intervals(grid, corners)
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[row]
        line.append(at)
        bottom.append(low)
        top.append(high)
        down.append(-cross[:, 2] / np.linalg.norm(cross, axis=1))
        lost, total = lost + bad, total + lines
    line, bottom, top, down = (np.concatenate(column) for column in (line, bottom, top, down))
    order = np.lexsort((bottom, line))
    line, bottom, top, down = line[order], bottom[order], top[order], down[order]
    below = np.where(np.diff(line, prepend=-1) == 0, np.roll(top, 1), 0)
    empty = np.maximum(bottom - below, 0)
    threshold = np.sin(np.radians(angle_deg))
    scale = grid.step ** 2 * total / max(1, total - lost)
    return (float(empty[down > threshold + 1e-4].sum() * scale), float(empty[down > threshold - 1e-4].sum() * scale))


def check_figures(job, report):
    packing = job.data["packing"]
    trays = [tray for tray in job.trays() if job.parts_of_tray(tray)]
    boxes = [tray_box(job, tray) for tray in trays]
    box = sum(float(size.prod()) for size in boxes)
    report.check("packing.bbox_mm3", abs(box - packing["bbox_mm3"]) <= BOX_TOLERANCE * box,
                 f"{box:.1f} measured, {packing['bbox_mm3']:.1f} told")
    height = max(float(size[2]) for size in boxes)
    report.check("packing.height_mm", abs(height - packing["height_mm"]) <= 1e-3 + BOX_TOLERANCE * 0.1 * height,
                 f"{height:.4f} measured, {packing['height_mm']:.4f} told")
    angle = job.data["printer"]["support_angle_deg"]
    bounds = np.array([tray_support(job, tray, angle) for tray in trays]).sum(axis=0)
    told = packing["support_mm3"]
    slack = SUPPORT_TOLERANCE * bounds[1] + SUPPORT_FLOOR_MM3
    report.check("packing.support_mm3", bounds[0] - slack <= told <= bounds[1] + slack,
                 f"{bounds[0]:.1f} to {bounds[1]:.1f} measured, {told:.1f} told"
                 f" ({100 * (told / max(bounds[1], 1e-9) - 1):+.2f} %)")
    if job.setting("objective") == "paper":
        weight = packing["weight"]
        cost = weight * packing["bbox_mm3"] + (1 - weight) * told
        report.check("packing.cost is w·V_bp + (1-w)·V_s", abs(cost - packing["cost"]) <= COST_TOLERANCE * cost,
                     f"{cost:.1f} by the formula, {packing['cost']:.1f} told")
    if job.setting("objective") == "height":
        total = sum(float(size[2]) for size in boxes)
        report.note("packing.cost for the height objective", f"{packing['cost']} told, heights sum to {total:.3f}")
