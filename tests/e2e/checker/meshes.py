"""Readers of triangle meshes: everything becomes N×3×3 corners. Polygons are cut into fans."""
import pathlib
import struct

import numpy as np

_STL_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_PLY_TYPES = {"char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
              "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
              "float": "f4", "float32": "f4", "double": "f8", "float64": "f8"}


def read_binary_stl(path):
    """N×3×3 float32, exactly as stored. ValueError when length and count disagree."""
    data = pathlib.Path(path).read_bytes()
    if len(data) < 84:
        raise ValueError(f"{path}: too short for a binary STL")
    count = struct.unpack_from("<I", data, 80)[0]
    if len(data) != 84 + 50 * count:
        raise ValueError(f"{path}: {count} triangles promised, {len(data)} bytes found")
    return np.frombuffer(data, _STL_TRIANGLE, count, 84)["corners"].copy()


def write_binary_stl(path, corners):
    rows = np.zeros(len(corners), _STL_TRIANGLE)
    rows["corners"] = corners
    header = b"a mesh".ljust(80)
    pathlib.Path(path).write_bytes(header + struct.pack("<I", len(rows)) + rows.tobytes())


def read_model(path):
    """N×3×3 double, in the file's units. Formats by suffix: .stl .obj .ply .off"""
    suffix = pathlib.Path(path).suffix.lower()
    readers = {".stl": _read_stl, ".obj": _read_obj, ".ply": _read_ply, ".off": _read_off}
    if suffix not in readers:
        raise ValueError(f"{path}: not an STL, OBJ, PLY or OFF file")
    return np.asarray(readers[suffix](path), dtype=np.float64)


def weld(corners):
    """Equal positions become one vertex: (V×3 points, N×3 indices). -0 equals 0."""
    flat = corners.reshape(-1, 3) + 0.0
    points, index = np.unique(flat, axis=0, return_inverse=True)
    return points, index.reshape(-1, 3)


def areas_and_normals(corners):
    """Areas (N) and unit normals (N×3; zero for a degenerate triangle)."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(cross, axis=1)
    return length / 2, cross / np.where(length > 0, length, 1)[:, None]


def volume(corners):
    """Signed volume enclosed; summed about the mesh's middle for precision."""
    shifted = corners - corners.reshape(-1, 3).mean(axis=0)
    return float(np.einsum("ij,ij->", shifted[:, 0], np.cross(shifted[:, 1], shifted[:, 2])) / 6)


def _fans(points, polygons):
    points = np.asarray(points, dtype=np.float64)
    triangles = [(p[0], p[i], p[i + 1]) for p in polygons for i in range(1, len(p) - 1)]
    return points[np.array(triangles, dtype=np.int64).reshape(-1, 3)]


def _read_stl(path):
    try:
        return read_binary_stl(path)
    except ValueError:
        words = pathlib.Path(path).read_text(errors="replace").split()
        at = [i for i, word in enumerate(words) if word.lower() == "vertex"]
        return np.array([[float(w) for w in words[i + 1:i + 4]] for i in at]).reshape(-1, 3, 3)


def _read_obj(path):
    points, polygons = [], []
    for line in pathlib.Path(path).read_text(errors="replace").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            indices = [int(w.split("/")[0]) for w in words[1:]]
            polygons.append([i - 1 if i > 0 else len(points) + i for i in indices])
    return _fans(points, polygons)


def _read_off(path):
    lines = [line.split("#")[0] for line in pathlib.Path(path).read_text().splitlines()]
    words = " ".join(lines).split()
    vertex_count, face_count = int(words[1]), int(words[2])
    at = 4
    points = np.array(words[at:at + 3 * vertex_count], dtype=np.float64).reshape(-1, 3)
    at += 3 * vertex_count
    polygons = []
    for line in [line for line in lines if line.strip()][2 + vertex_count:2 + vertex_count + face_count]:
        numbers = line.split()
        polygons.append([int(w) for w in numbers[1:1 + int(numbers[0])]])
    return _fans(points, polygons)


def _read_ply(path):
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header")
    body = data.index(b"\n", end) + 1
    form, elements = "ascii", []
    for line in data[:end].decode("ascii", "replace").splitlines():
        words = line.split()
        if words[:1] == ["format"]:
            form = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    take = _ascii_taker(data[body:]) if form == "ascii" else _binary_taker(data, body, form)
    points, polygons = [], []
    for name, count, properties in elements:
        for _ in range(count):
            row = {p[-1]: take(p) for p in properties}
            if name == "vertex":
                points.append([row["x"], row["y"], row["z"]])
            elif name == "face":
                polygons.append(row.get("vertex_indices", row.get("vertex_index")))
    return _fans(points, polygons)


def _ascii_taker(body):
    words = iter(body.split())

    def take(declared):
        if declared[0] == "list":
            return [int(next(words)) for _ in range(int(next(words)))]
        return float(next(words))
    return take


def _binary_taker(data, start, form):
    order = "<" if form == "binary_little_endian" else ">"
    at = [start]

    def one(name):
        kind = np.dtype(order + _PLY_TYPES[name])
        value = np.frombuffer(data, kind, 1, at[0])[0]
        at[0] += kind.itemsize
        return value

    def take(declared):
        if declared[0] == "list":
            return [int(one(declared[2])) for _ in range(int(one(declared[1])))]
        return float(one(declared[0]))
    return take
