"""PNG and GLB."""
import json
import struct
import zlib

import numpy as np

_CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}


def read_png(path):
    """H×W×C bytes of an 8-bit, non-interlaced, non-palette PNG. ValueError otherwise."""
    data = path.read_bytes()
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        raise ValueError("not a PNG")
    at, packed, header = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if zlib.crc32(kind + body) != struct.unpack_from(">I", data, at + 8 + length)[0]:
            raise ValueError(f"chunk {kind!r} is damaged")
        header = struct.unpack(">IIBBBBB", body) if kind == b"IHDR" else header
        packed += body if kind == b"IDAT" else b""
        at += 12 + length
    width, height, depth, colour, _, _, interlaced = header
    if depth != 8 or colour not in _CHANNELS or interlaced:
        raise ValueError(f"depth {depth}, colour type {colour}, interlace {interlaced}")
    channels = _CHANNELS[colour]
    rows = np.frombuffer(zlib.decompress(packed), np.uint8).reshape(height, 1 + width * channels)
    return _unfilter(rows[:, 0], rows[:, 1:].reshape(height, width, channels))


def _unfilter(filters, filtered):
    """Undoes the five row filters along anti-diagonals: every pixel needs only its left and upper ones."""
    height, width, channels = filtered.shape
    image = np.zeros((height + 1, width + 1, channels), dtype=np.int32)
    for diagonal in range(height + width - 1):
        row = np.arange(max(0, diagonal - width + 1), min(height, diagonal + 1))
        column = diagonal - row
        left, up, corner = image[row + 1, column], image[row, column + 1], image[row, column]
        distances = np.abs(np.stack([up - corner, left - corner, left + up - 2 * corner]))
        nearest = np.choose(distances.argmin(axis=0), [left, up, corner])
        kind = filters[row][:, None]
        guess = np.select([kind == 1, kind == 2, kind == 3, kind == 4], [left, up, (left + up) // 2, nearest], 0)
        image[row + 1, column + 1] = (filtered[row, column] + guess) & 255
    return image[1:, 1:].astype(np.uint8)


def check_png(job, report):
    try:
        image = read_png(job.folder / "preview.png")
    except (OSError, ValueError, TypeError, struct.error, zlib.error) as error:
        report.check("preview.png is a PNG", False, error)
        return
    height, width, _ = image.shape
    report.check("preview.png is a PNG", True, f"{width}×{height}")
    report.check("preview.png has a sensible size", 320 <= width <= 8192 and 200 <= height <= 8192, f"{width}×{height}")
    colours = image[:, :, :3].astype(np.int32)
    halves = []
    for side in (colours[:, :width // 2], colours[:, width // 2:]):
        background = np.median(side.reshape(-1, side.shape[2]), axis=0)
        halves.append(float((np.abs(side - background).max(axis=2) > 24).mean()))
    shades = len(np.unique(colours.reshape(-1, colours.shape[2]), axis=0))
    report.check("preview.png shows something on both sides", min(halves) > 0.01 and shades > 30,
                 f"{halves[0]:.1%} and {halves[1]:.1%} drawn, {shades} shades")


def read_glb(path):
    """The JSON chunk of a glTF 2.0 binary whose lengths agree."""
    data = path.read_bytes()
    magic, version, length = struct.unpack_from("<4sII", data)
    if magic != b"glTF" or version != 2 or length != len(data):
        raise ValueError(f"magic {magic!r}, version {version}, {length} bytes promised and {len(data)} found")
    chunk, kind = struct.unpack_from("<I4s", data, 12)
    if kind != b"JSON":
        raise ValueError("the first chunk is not JSON")
    scene = json.loads(data[20:20 + chunk])
    binary = len(data) - 28 - chunk
    if sum(buffer["byteLength"] for buffer in scene.get("buffers", [])) > max(0, binary):
        raise ValueError("buffers longer than the binary chunk")
    return scene


def _node_matrix(node):
    if "matrix" in node:
        return np.array(node["matrix"], dtype=np.float64).reshape(4, 4).T
    matrix = np.eye(4)
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])
    matrix[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)))
    matrix[:3, 3] = node.get("translation", (0, 0, 0))
    return matrix


def mesh_boxes(scene):
    """Diagonals of the boxes (from the accessors' min and max) of every node with a mesh, in metres."""
    boxes = []

    def visit(number, above):
        node = scene["nodes"][number]
        here = above @ _node_matrix(node)
        for primitive in scene["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            accessor = scene["accessors"][primitive["attributes"]["POSITION"]]
            ends = np.array([accessor["min"], accessor["max"]])
            corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2], 1] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
            placed = (corners @ here.T)[:, :3]
            triangles = primitive.get("mode", 4) == 4
            boxes.append((triangles, np.sort(placed.max(axis=0) - placed.min(axis=0))))
        for child in node.get("children", []):
            visit(child, here)
    for root in scene["scenes"][scene.get("scene", 0)]["nodes"]:
        visit(root, np.eye(4))
    return boxes


def check_glb(job, name, place, report):
    """place: part → N×3×3 mm where the scene shows it, up to turns by right angles and shifts."""
    try:
        boxes = mesh_boxes(read_glb(job.folder / name))
    except (OSError, ValueError, KeyError, IndexError, TypeError, struct.error) as error:
        report.check(f"{name} is a glTF 2.0 binary", False, f"{type(error).__name__}: {error}")
        return
    report.check(f"{name} is a glTF 2.0 binary", True, f"{len(boxes)} primitives")
    sizes = [size for triangles, size in boxes if triangles]
    lost = []
    for part in job.readable_parts():
        corners = place(part).reshape(-1, 3)
        expected = np.sort(corners.max(axis=0) - corners.min(axis=0)) / 1000
        if not any(np.abs(size - expected).max() <= 1e-4 for size in sizes):
            lost.append(part["id"])
    report.check(f"{name} shows every part, in metres", not lost and len(sizes) >= len(job.parts()),
                 f"parts {lost} not found" if lost else f"{len(sizes)} meshes, {len(job.parts())} parts")
