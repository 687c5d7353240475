"""Exact distances, many at once. Points are K×3, triangles K×3×3; row k goes with row k."""
import numpy as np

_EDGES = ((0, 1), (1, 2), (2, 0))


def _dot(a, b):
    return np.einsum("...i,...i->...", a, b)


def point_segment(points, start, end):
    """Squared distance."""
    along = end - start
    length = _dot(along, along)
    t = np.clip(_dot(points - start, along) / np.where(length > 0, length, 1), 0, 1)
    offset = points - start - t[..., None] * along
    return _dot(offset, offset)


def point_triangle(points, triangles):
    """Squared distance."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    best = np.minimum(point_segment(points, a, b), point_segment(points, b, c))
    best = np.minimum(best, point_segment(points, c, a))
    normal = np.cross(b - a, c - a)
    square = _dot(normal, normal)
    inside = square > 0
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= _dot(np.cross(end - start, points - start), normal) >= 0
    height = _dot(points - a, normal)
    return np.where(inside, height * height / np.where(square > 0, square, 1), best)


def segment_segment(p, q, r, s):
    """Squared distance between pq and rs."""
    d1, d2, w = q - p, s - r, p - r
    a, e, f = _dot(d1, d1), _dot(d2, d2), _dot(d2, w)
    b, c = _dot(d1, d2), _dot(d1, w)
    denominator = a * e - b * b
    t = np.clip((b * f - c * e) / np.where(denominator > 0, denominator, 1), 0, 1)
    t = np.where(denominator > 0, t, 0)
    u = np.clip((b * t + f) / np.where(e > 0, e, 1), 0, 1)
    t = np.clip((b * u - c) / np.where(a > 0, a, 1), 0, 1)
    offset = w + t[..., None] * d1 - u[..., None] * d2
    # near-parallel segments: the formula loses digits there, and an end point is then among the closest
    best = _dot(offset, offset)
    for point, start, end in ((p, r, s), (q, r, s), (r, p, q), (s, p, q)):
        best = np.minimum(best, point_segment(point, start, end))
    return best


def _pierces(start, end, triangles):
    """Whether the segment crosses the triangle's inside."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    from_start, from_end = _dot(start - a, normal), _dot(end - a, normal)
    crosses = from_start * from_end < 0
    span = from_start - from_end
    point = start + (from_start / np.where(span != 0, span, 1))[:, None] * (end - start)
    for first, second in ((a, b), (b, c), (c, a)):
        crosses &= _dot(np.cross(second - first, point - first), normal) > 0
    return crosses


def triangle_triangle(first, second):
    """Distance (not squared); 0 where they intersect."""
    best = np.full(len(first), np.inf)
    for corner in range(3):
        best = np.minimum(best, point_triangle(first[:, corner], second))
        best = np.minimum(best, point_triangle(second[:, corner], first))
    crossing = np.zeros(len(first), dtype=bool)
    for i, j in _EDGES:
        for k, l in _EDGES:
            best = np.minimum(best, segment_segment(first[:, i], first[:, j], second[:, k], second[:, l]))
        crossing |= _pierces(first[:, i], first[:, j], second) | _pierces(second[:, i], second[:, j], first)
    return np.where(crossing, 0.0, np.sqrt(best))


def plane_gap(first, second):
    """A lower bound of triangle_triangle: how far each lies wholly to one side of the other's plane."""
    bound = np.zeros(len(first))
    for plane, other in ((first, second), (second, first)):
        normal = np.cross(plane[:, 1] - plane[:, 0], plane[:, 2] - plane[:, 0])
        length = np.linalg.norm(normal, axis=1)
        height = _dot(other - plane[:, :1], (normal / np.where(length > 0, length, 1)[:, None])[:, None])
        bound = np.maximum(bound, np.maximum(height.min(axis=1), -height.max(axis=1)))
    return bound


def projected_weights(x, y, triangles):
    """Unnormalised barycentric weights of (x, y) in the triangles seen from above, K×3; their sum is twice
    the signed area: positive where the triangle looks up."""
    def cross(p, q):
        return (q[:, 0] - p[:, 0]) * (y - p[:, 1]) - (q[:, 1] - p[:, 1]) * (x - p[:, 0])
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    return np.stack([cross(b, c), cross(c, a), cross(a, b)], axis=1)


def below(points, triangles):
    """+1 where the point lies straight below a triangle that looks up, -1 below one that looks down, else 0."""
    weights = projected_weights(points[:, 0], points[:, 1], triangles)
    area = weights.sum(axis=1)
    sign = np.sign(area)
    height = _dot(weights, triangles[:, :, 2]) - points[:, 2] * area
    inside = (sign != 0) & (weights * sign[:, None] > 0).all(axis=1) & (height * sign > 0)
    return np.where(inside, sign, 0).astype(int)
