"""Closed procedural models, N×3×3 mm, for the end-to-end tests."""
import numpy as np


def sphere(radius=20.0, rings=24, sectors=36):
    """A sphere standing on z = 0, outward."""
    polar = np.linspace(0, np.pi, rings + 1)
    turn = np.linspace(0, 2 * np.pi, sectors, endpoint=False)
    grid = np.stack([np.outer(np.sin(polar), np.cos(turn)), np.outer(np.sin(polar), np.sin(turn)),
                     np.repeat(np.cos(polar)[:, None], sectors, axis=1)], axis=2)
    grid[0], grid[-1] = [0, 0, 1], [0, 0, -1]
    grid = radius * (grid + [0, 0, 1])
    triangles = []
    for i in range(rings):
        for j in range(sectors):
            a, b = grid[i, j], grid[i + 1, j]
            c, d = grid[i + 1, (j + 1) % sectors], grid[i, (j + 1) % sectors]
            if i < rings - 1:
                triangles.append([a, b, c])
            if i > 0:
                triangles.append([a, c, d])
    return np.array(triangles)


def torus(ring=15.0, tube=5.0, sectors=48, sides=24):
    """A torus lying on z = 0, outward."""
    u = np.linspace(0, 2 * np.pi, sectors, endpoint=False)
    v = np.linspace(0, 2 * np.pi, sides, endpoint=False)
    reach = ring + tube * np.cos(v)
    grid = np.stack([np.outer(np.cos(u), reach), np.outer(np.sin(u), reach),
                     np.repeat((tube + tube * np.sin(v))[None], sectors, axis=0)], axis=2)
    triangles = []
    for i in range(sectors):
        for j in range(sides):
            a, b = grid[i, j], grid[(i + 1) % sectors, j]
            c, d = grid[(i + 1) % sectors, (j + 1) % sides], grid[i, (j + 1) % sides]
            triangles += [[a, b, c], [a, c, d]]
    return np.array(triangles)


def crossed_bars(count):
    """Bars of 60 x 2 x 5 mm on z = 0, turned around one axis: bodies that overlap, with tops in one plane."""
    sides = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
             (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]
    corners = np.array([(x, y, z) for z in (0, 5) for y in (-1, 1) for x in (-30, 30)], dtype=float)
    bars = []
    for angle in np.pi * np.arange(count) / count:
        turn = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        bars.append((corners @ turn)[np.array(sides)])
    return np.concatenate(bars)
