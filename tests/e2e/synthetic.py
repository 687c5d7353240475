"""Job folders made without PackMerger, for the checker's own tests.

A hollow box of 40×30×20 mm with walls of 3 mm, cut in two at x = 20. Part 1 lies on the tray; part 2 is
turned by 90° and stands above it with a gap of 1.5 mm, so that there is support below it and an order to take
them out in.
"""
import hashlib
import json
import pathlib
import struct
import zipfile
import zlib

import numpy as np

from checker import meshes

XS, YS, ZS = [0, 3, 20, 37, 40], [0, 3, 27, 30], [0, 3, 17, 20]
GAP_MM = 1.5
PROFILE = b'dialect = "handoff"\ntechnology = "polyjet"\ngap_mm = 1.0\n'
CUT_MM2 = 30 * 20 - 24 * 14


def polycube(xs, ys, zs, filled):
    """The closed surface of the cells (i, j, k) of a grid for which filled(i, j, k); N×3×3."""
    axes = (xs, ys, zs)
    counts = [len(axis) - 1 for axis in axes]

    def solid(cell):
        return all(0 <= c < n for c, n in zip(cell, counts)) and filled(*cell)
    triangles = []
    for cell in np.ndindex(*counts):
        for axis in range(3):
            for side in (0, 1):
                beyond = list(cell)
                beyond[axis] += 2 * side - 1
                if solid(cell) and not solid(beyond):
                    triangles += _square(axes, cell, axis, side)
    return np.array(triangles, dtype=np.float64)


def _square(axes, cell, axis, side):
    u, v = (axis + 1) % 3, (axis + 2) % 3
    corners = []
    for du, dv in ((0, 0), (1, 0), (1, 1), (0, 1)):
        at = list(cell)
        at[axis] += side
        at[u] += du
        at[v] += dv
        corners.append([axes[k][at[k]] for k in range(3)])
    if not side:
        corners.reverse()
    return [[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]]


def _shell(i, j, k):
    return not (1 <= i <= 2 and j == 1 and k == 1)


def model_corners():
    return polycube([0, 20, 40], [0, 30], [0, 20], lambda i, j, k: True)


def part_corners(number):
    keep = (0, 1) if number == 1 else (2, 3)
    return polycube(XS, YS, ZS, lambda i, j, k: i in keep and _shell(i, j, k))


def _pose(turn, shift):
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn, shift
    return pose


def poses():
    quarter = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    return [_pose(np.eye(3), [5, 5, 0]), _pose(quarter, [35, -12, 20 + GAP_MM])]


def write_png(path, image):
    height, width, _ = image.shape
    rows = b"".join(b"\0" + row.tobytes() for row in image)

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows))
                     + chunk(b"IEND", b""))


def write_glb(path, meshes_mm):
    """One node and one mesh for each; only what the checker reads."""
    accessors, binary = [], b""
    for corners in meshes_mm:
        points = (corners.reshape(-1, 3) / 1000).astype("<f4")
        accessors.append({"componentType": 5126, "type": "VEC3", "count": len(points),
                          "min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()})
        binary += points.tobytes()
    count = len(meshes_mm)
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(count))}],
             "nodes": [{"mesh": k} for k in range(count)], "accessors": accessors,
             "meshes": [{"primitives": [{"attributes": {"POSITION": k}}]} for k in range(count)],
             "buffers": [{"byteLength": len(binary)}]}
    text = json.dumps(scene).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)


def write_3mf(path, placed, unit="millimeter", shift=(0, 0, 0)):
    """Objects lie at the origin; the build items carry them to their place (and by shift beside it)."""
    objects, items = "", ""
    for number, corners in enumerate(placed, 1):
        low = corners.reshape(-1, 3).min(axis=0)
        points, index = meshes.weld(corners - low)
        vertices = "".join(f'<vertex x="{x:.9g}" y="{y:.9g}" z="{z:.9g}"/>' for x, y, z in points)
        faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in index)
        objects += (f'<object id="{number}" type="model"><mesh><vertices>{vertices}</vertices>'
                    f'<triangles>{faces}</triangles></mesh></object>')
        place = " ".join(f"{value:.9g}" for value in low + np.array(shift))
        items += f'<item objectid="{number}" transform="1 0 0 0 1 0 0 0 1 {place}"/>'
    core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
    model = (f'<model unit="{unit}" xmlns="{core}"><resources>{objects}</resources>'
             f'<build>{items}</build></model>')
    package = "http://schemas.openxmlformats.org/package/2006"
    relation = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("[Content_Types].xml", f'<Types xmlns="{package}/content-types"/>')
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{package}/relationships"><Relationship Id="r" '
                         f'Type="{relation}" Target="/3D/3dmodel.model"/></Relationships>')
        archive.writestr("3D/3dmodel.model", model)


def support_mm3():
    """By hand: the roof over part 1's and part 2's cavity, and part 2's floor over part 1 and over the tray.
    Part 1 covers x 5..25, y 5..35 and part 2 covers x 5..35, y 8..28 of the tray."""
    roof = 17 * 24 * 14
    over_first = 20 * 20 * GAP_MM
    over_tray = 10 * 20 * (20 + GAP_MM)
    return 2 * roof + over_first + over_tray


def _estimate(**changes):
    estimate = {"fits": True, "time_s": 3600.0, "model_mm3": 9000.0, "model_g": 10.0, "support_mm3": 100.0,
                "support_g": 0.1, "cost": 5.0, "material_cost": 1.0, "machine_cost": 1.5, "hands_cost": 2.5, "currency": "EUR", "parts": 1, "trays": 1, "assembly_min": 0.0,
                "source": "model"}
    return estimate | changes


def _unfit():
    return {key: None for key in _estimate()} | {"fits": False}


def write_job(folder):
    """A whole job folder that keeps every promise, and its model; returns (folder, model path)."""
    folder = pathlib.Path(folder)
    (folder / "job" / "parts").mkdir(parents=True)
    model = folder / "box.stl"
    meshes.write_binary_stl(model, model_corners())
    job = folder / "job"
    placed = []
    for number, pose in enumerate(poses(), 1):
        corners = part_corners(number) @ pose[:3, :3].T + pose[:3, 3]
        placed.append(corners)
        meshes.write_binary_stl(job / "parts" / f"{number:02d}.stl", corners)
    meshes.write_binary_stl(job / "tray.stl", np.concatenate(placed))
    write_3mf(job / "tray.3mf", placed)
    write_glb(job / "preview.glb", placed)
    write_glb(job / "assembly.glb", [part_corners(1), part_corners(2)])
    noise = np.random.default_rng(1).integers(0, 256, (200, 320, 3), dtype=np.uint8)
    write_png(job / "preview.png", noise)
    (job / "profile.toml").write_bytes(PROFILE)
    data = job_data(hashlib.sha256(model.read_bytes()).hexdigest())
    (job / "job.json").write_text(json.dumps(data))
    return job, model


def job_data(sha256):
    box = 30.0 * 30 * (40 + GAP_MM)
    support = float(support_mm3())
    volume = meshes.volume(part_corners(1))
    settings = {"technology": "polyjet", "build_mm": [100, 80, 60], "layer_mm": 0.03, "support_angle_deg": 0,
                "gap_mm": 1.0, "grid_mm": 1.0, "rotation_step_deg": 30, "objective": "paper", "weight": 0.75,
                "wall_mm": 3, "voxel_mm": 0.75, "segmentation": "paper", "clusters": 100,
                "min_glue_area_mm2": 10, "min_volume_fraction": 0.05, "tabu_memory": 3, "tabu_patience": 10}
    parts = [{"id": n, "model": 0, "tray": 1, "file": f"parts/{n:02d}.stl", "volume_mm3": volume,
              "transform": pose.ravel().tolist(), "neighbours": [{"id": 3 - n, "glue_area_mm2": CUT_MM2}]}
             for n, pose in enumerate(poses(), 1)]
    return {"version": 1, "inputs": [{"file": "box.stl", "sha256": sha256, "scale": 1}],
            "profile": {"id": "objet30", "sha256": hashlib.sha256(PROFILE).hexdigest()}, "seed": 1, "settings": settings,
            "printer": {"build_mm": [100, 80, 60], "support_angle_deg": 0},
            "shell": {"volume_mm3": 2 * volume, "wall_mm": 3},
            "segments": {"tetrahedra": 100, "clusters": 10, "after_premerge": 4, "final": 2},
            "packing": {"weight": 0.75, "cost": 0.75 * box + 0.25 * support, "bbox_mm3": box, "support_mm3": support,
                        "height_mm": 40 + GAP_MM, "gap_mm": 1.0, "grid_mm": 1.0},
            "parts": parts, "removal_order": [2, 1],
            "estimates": {"as_is": _estimate(), "solid": _estimate(), "hollow": _unfit(),
                          "packed": _estimate(parts=2)},
            "timings_s": {"pack": 1.0}, "warnings": []}
