"""Where a tray's parts may stand, seen from above: the plate's outline and kept-out areas (docs/PROFILES)."""
import numpy as np

TOLERANCE_MM = 2e-4  # what single precision in the files may take, both ways


def inside(polygon, points):
    """Which points lie within a polygon, by counting the sides to their right."""
    found = np.zeros(len(points), bool)
    x, y = points[:, 0], points[:, 1]
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0)):
        if ay == by:
            continue
        crosses = ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
        found ^= crosses
    return found


def to_border(polygon, points):
    """The distance of points to a polygon's border."""
    least = np.full(len(points), np.inf)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        side = b - a
        along = np.clip((points - a) @ side / (side @ side), 0, 1)
        least = np.minimum(least, np.linalg.norm(points - a - along[:, None] * side, axis=1))
    return least


def cut_shares(polygon, start, end):
    """Where a stretch meets the polygon's sides, as shares of the stretch, its ends among them."""
    way = end - start
    shares = [0.0, 1.0]
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0)):
        side = b - a
        across = way[0] * side[1] - way[1] * side[0]
        if across == 0:
            continue
        to = a - start
        along, on_side = (to[0] * side[1] - to[1] * side[0]) / across, (to[0] * way[1] - to[1] * way[0]) / across
        if 0 < along < 1 and 0 <= on_side <= 1:
            shares.append(along)
    return sorted(shares)


class Walls:
    def __init__(self, printer):
        self.outline = np.array(printer.get("plate_mm", []), float).reshape(-1, 2)
        self.kept_out = [np.array(area, float) for area in printer.get("keep_out_mm", [])]

    def fault(self, triangles):
        """Why a part, as its triangles seen from above, may not stand where it does; empty where it may."""
        if len(self.outline) and not self._near(self.outline, triangles, everywhere=True):
            return "it stands out over the edge of the plate"
        for number, area in enumerate(self.kept_out, 1):
            if self._near(area, triangles, everywhere=False):
                return f"it stands over kept-out area {number}"
        return ""

    @staticmethod
    def _near(polygon, triangles, everywhere):
        """Whether all of the triangles lie within the polygon (everywhere), or any of them does."""
        sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        low, high = polygon.min(axis=0), polygon.max(axis=0)
        touches = ((sides.min(axis=1) <= high) & (sides.max(axis=1) >= low)).all(axis=1)
        if everywhere:
            points = triangles.reshape(-1, 2)
            out = ~inside(polygon, points)
            if (to_border(polygon, points[out]) > TOLERANCE_MM).any():
                return False
        # Stretches between the border's crossings lie within as a whole or not at all. Far from the border nothing
        # changes: only sides nearer to it than they are long are cut.
        middles = sides.mean(axis=1)
        reach = np.linalg.norm(sides[:, 1] - sides[:, 0], axis=1) / 2
        close = touches & (to_border(polygon, middles) <= reach + TOLERANCE_MM)
        looked_at = [middles[touches & ~close]]
        for start, end in np.unique(sides[close].round(9), axis=0):
            shares = cut_shares(polygon, start, end)
            at = (np.array(shares[:-1]) + shares[1:]) / 2
            looked_at.append(start + at[:, None] * (end - start))
        points = np.concatenate(looked_at)
        within, depth = inside(polygon, points), to_border(polygon, points)
        if everywhere:
            return not (~within & (depth > TOLERANCE_MM)).any()
        if (within & (depth > TOLERANCE_MM)).any():
            return True
        # No side enters it: a triangle covers all of it, or none does.
        heart = Walls._inner_point(polygon)
        return any(inside(triangle, heart[None])[0] for triangle in triangles)

    @staticmethod
    def _inner_point(polygon):
        low, high = polygon.min(axis=0), polygon.max(axis=0)
        lines = np.meshgrid(*(np.linspace(low[axis], high[axis], 41) for axis in (0, 1)))
        lattice = np.stack(lines, axis=-1).reshape(-1, 2)
        return lattice[np.where(inside(polygon, lattice), to_border(polygon, lattice), -1).argmax()]
