"""Each part by itself: a closed 2-manifold of one piece of matter, outward, where and as big as promised."""
import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from . import meshes
from .tree import Tree
from .walls import Walls

BUILD_TOLERANCE_MM = 1e-4  # a float of 300 mm is stored to 3e-5
VOLUME_TOLERANCE = 1e-4    # of the part


def directed_edges(index):
    """(from, to, face) of all 3N half-edges."""
    start = index.ravel()
    end = np.roll(index, -1, axis=1).ravel()
    return start, end, np.repeat(np.arange(len(index)), 3)


def topology_faults(index, vertex_count):
    """What keeps welded triangles from being a closed, consistently oriented 2-manifold; counts by name."""
    start, end, face = directed_edges(index)
    degenerate = int((start == end).reshape(-1, 3).any(axis=1).sum())
    forward = start.astype(np.int64) * vertex_count + end
    backward = end.astype(np.int64) * vertex_count + start
    keys, counts = np.unique(forward, return_counts=True)
    undirected, uses = np.unique(np.minimum(forward, backward), return_counts=True)
    faults = {"degenerate triangles": degenerate, "open edges": int((uses == 1).sum()),
              "edges of more than two triangles": int((uses > 2).sum()),
              "edges whose two triangles run the same way": int((counts > 1).sum())}
    if not any(faults.values()):
        faults["vertices of more than one fan"] = _split_vertices(start, end, face, forward, backward, vertex_count)
    return {name: count for name, count in faults.items() if count}


def _split_vertices(start, end, face, forward, backward, vertex_count):
    order = np.argsort(forward)
    twin = order[np.searchsorted(forward[order], backward)]
    # a corner is a half-edge's start; crossing an edge leads to the corner of the same vertex in the next face
    corner = np.arange(len(start))
    following = corner.reshape(-1, 3)[:, [1, 2, 0]].ravel()
    links = coo_matrix((np.ones(len(corner)), (corner, following[twin])), shape=(len(corner), len(corner)))
    fans, _ = connected_components(links, directed=False)
    return fans - len(np.unique(start))


def pieces(index):
    """Which connected piece of surface each triangle belongs to."""
    start, end, face = directed_edges(index)
    vertices = int(index.max()) + 1
    links = coo_matrix((np.ones(len(start)), (start, end)), shape=(vertices, vertices))
    _, label = connected_components(links, directed=False)
    return np.unique(label[index[:, 0]], return_inverse=True)[1]


def matter_faults(corners, index):
    """Empty where the surface bounds one connected piece of matter: one outer surface, cavities inside it."""
    label = pieces(index)
    parts = [corners[label == k] for k in range(label.max() + 1)]
    volumes = [meshes.volume(part) for part in parts]
    outer = [part for part, volume in zip(parts, volumes) if volume > 0]
    cavities = [part for part, volume in zip(parts, volumes) if volume <= 0]
    if len(outer) != 1:
        return f"{len(outer)} separate pieces of matter"
    tree = Tree(outer[0])
    for cavity in cavities:
        if tree.winding(cavity[:1].mean(axis=1) + 1e-6)[0] != 1:
            return "an inward surface outside the matter"
    return ""


def check_solids(job, report):
    build = np.array(job.data["printer"]["build_mm"])
    gap = job.data["settings"]["gap_mm"]
    walls = Walls(job.data["printer"])
    for part in job.readable_parts():
        name, corners = part["file"], job.triangles[part["id"]]
        points, index = meshes.weld(corners)
        faults = topology_faults(index, len(points))
        closed = report.check(f"{name} is a closed 2-manifold", not faults,
                              ", ".join(f"{count} {fault}" for fault, count in faults.items()))
        if closed:
            fault = matter_faults(corners, index)
            report.check(f"{name} is one piece of matter", not fault, fault)
        volume, areas = meshes.volume(corners), meshes.areas_and_normals(corners)[0]
        report.check(f"{name} is outward", volume > 0, f"{volume:.2f} mm³")
        allowed = VOLUME_TOLERANCE * part["volume_mm3"] + 3e-5 * float(areas.sum())
        report.check(f"{name} has its volume_mm3", abs(volume - part["volume_mm3"]) <= allowed,
                     f"{volume:.3f} measured, {part['volume_mm3']:.3f} promised")
        low, high = corners.reshape(-1, 3).min(axis=0), corners.reshape(-1, 3).max(axis=0)
        inside = (low >= -BUILD_TOLERANCE_MM).all() and (high <= build + BUILD_TOLERANCE_MM).all()
        report.check(f"{name} is inside build_mm", inside, f"{np.round(low, 3).tolist()} to {np.round(high, 3).tolist()}")
        if job.data["settings"].get("technology") == "powder":
            apart = min(low.min(), (build - high).min())
            report.check(f"{name} keeps gap_mm to the walls of the bed", apart >= gap - BUILD_TOLERANCE_MM,
                         f"{apart:.4f} mm")
        fault = walls.fault(corners[:, :, :2])
        report.check(f"{name} stands on the plate and over no kept-out area", not fault, fault)
        pose = np.array(part["transform"]).reshape(4, 4)
        turn = pose[:3, :3]
        rigid = (np.abs(turn @ turn.T - np.eye(3)).max() < 1e-6 and abs(np.linalg.det(turn) - 1) < 1e-6
                 and np.array_equal(pose[3], [0, 0, 0, 1]))
        report.check(f"part {part['id']} has a rigid transform", rigid, f"determinant {np.linalg.det(turn):.9f}")
