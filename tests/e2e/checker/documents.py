"""What the tray's files hold: exactly the parts."""
import hashlib
import re
import tomllib
import zipfile
from xml.etree import ElementTree

import numpy as np
from scipy.spatial import cKDTree

from . import meshes
from .contract import DIALECT_SUFFIX
from .job import program_file, tray_file
from .report import first_few

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
RELATION = "{http://schemas.openxmlformats.org/package/2006/relationships}Relationship"
MODEL_RELATION = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
PLACE_TOLERANCE_MM = 1e-3


def read_profile(job, report):
    """profile.toml as a dict; empty where it cannot be read."""
    try:
        profile = tomllib.loads((job.folder / "profile.toml").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        report.check("profile.toml parses", False, error)
        return {}
    report.check("profile.toml parses", True, f"{len(profile)} keys")
    digest = hashlib.sha256((job.folder / "profile.toml").read_bytes()).hexdigest()
    report.check("profile.toml has the sha256 of profile", digest == job.data["profile"]["sha256"], digest[:12])
    settings = job.data["settings"]
    differing = [key for key, value in settings.items() if key in profile and not _same(profile[key], value)]
    report.check("profile.toml agrees with settings", not differing, first_few(differing))
    return profile


def _same(first, second):
    try:
        return bool(np.allclose(first, second, rtol=1e-9, atol=1e-12))
    except (TypeError, ValueError):
        return first == second


def _features(corners):
    """Six numbers a triangle that do not depend on which corner comes first: centre and area vector."""
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    return np.concatenate([corners.mean(axis=1), cross], axis=1)


def same_triangles(first, second, tolerance=PLACE_TOLERANCE_MM):
    """Empty where both hold the same triangles, in any order; otherwise what differs."""
    if len(first) != len(second):
        return f"{len(first)} triangles, not {len(second)}"
    here, there = _features(first), _features(second)
    scale = np.array([1, 1, 1, 0.1, 0.1, 0.1])  # area vectors of long triangles are less exact
    distance, match = cKDTree(there * scale).query(here * scale, p=np.inf)
    if distance.max() > tolerance:
        return f"a triangle is {distance.max():.4f} mm away"
    unmatched = len(second) - len(np.unique(match))
    return f"{unmatched} triangles are missing" if unmatched > 0.001 * len(second) else ""


def check_tray_stl(job, tray, report):
    name = tray_file(tray, ".stl")
    try:
        corners = meshes.read_binary_stl(job.folder / name)
    except (OSError, ValueError) as error:
        report.check(f"{name} holds exactly the parts", False, error)
        return
    parts = [job.triangles[part["id"]] for part in job.parts_of_tray(tray)]
    rows = corners.reshape(len(corners), 9).astype(np.float64)
    expected = np.concatenate(parts).reshape(-1, 9)
    order = [np.lexsort(table.T) for table in (rows, expected)]
    equal = rows.shape == expected.shape and np.array_equal(rows[order[0]], expected[order[1]])
    report.check(f"{name} holds exactly the parts", equal, "" if equal else
                 same_triangles(corners.astype(np.float64), np.concatenate(parts)) or "not to the last bit")


def _placed(corners, words):
    """3MF transforms are 4×3, points are rows."""
    if not words:
        return corners
    matrix = np.array(words.split(), dtype=np.float64).reshape(4, 3)
    return corners @ matrix[:3] + matrix[3]


def read_3mf(path):
    """(unit, [(object name, placed N×3×3)]) of the build items. ValueError where it is no core 3MF."""
    with zipfile.ZipFile(path) as archive:
        if archive.testzip() is not None:
            raise ValueError("a damaged archive")
        if "[Content_Types].xml" not in archive.namelist():
            raise ValueError("no [Content_Types].xml")
        ElementTree.fromstring(archive.read("[Content_Types].xml"))
        relations = ElementTree.fromstring(archive.read("_rels/.rels"))
        targets = [r.get("Target") for r in relations.iter(RELATION) if r.get("Type") == MODEL_RELATION]
        if len(targets) != 1:
            raise ValueError(f"{len(targets)} relationships to a 3D model")
        root = ElementTree.fromstring(archive.read(targets[0].lstrip("/")))
    if root.tag != CORE + "model":
        raise ValueError(f"the root is {root.tag}")
    objects = {}
    for element in root.find(CORE + "resources").findall(CORE + "object"):
        if element.get("id") in objects or element.get("type", "model") != "model":
            raise ValueError(f"object {element.get('id')} twice, or not a model")
        objects[element.get("id")] = (element.get("name"), _object_mesh(element))
    items = root.find(CORE + "build").findall(CORE + "item")
    placed = [(objects[i.get("objectid")][0], _placed(objects[i.get("objectid")][1], i.get("transform"))) for i in items]
    return root.get("unit", "millimeter"), len(objects), placed


def _object_mesh(element):
    mesh = element.find(CORE + "mesh")
    if mesh is None:
        raise ValueError("an object without a mesh")
    vertices = np.array([[float(v.get(axis)) for axis in "xyz"] for v in mesh.iter(CORE + "vertex")])
    index = np.array([[int(t.get(corner)) for corner in ("v1", "v2", "v3")] for t in mesh.iter(CORE + "triangle")])
    if index.min() < 0 or index.max() >= len(vertices):
        raise ValueError("a triangle names a vertex that is not there")
    if len(np.unique(index)) != len(vertices):
        raise ValueError("vertices that no triangle uses")
    return vertices[index]


def check_3mf(job, tray, report):
    name = tray_file(tray, ".3mf")
    try:
        unit, objects, items = read_3mf(job.folder / name)
    except (OSError, ValueError, KeyError, AttributeError, TypeError, zipfile.BadZipFile,
            ElementTree.ParseError) as error:
        report.check(f"{name} is a core 3MF", False, f"{type(error).__name__}: {error}")
        return
    parts = job.parts_of_tray(tray)
    report.check(f"{name} is a core 3MF", True, f"{objects} objects")
    report.check(f"{name} is in millimetres", unit == "millimeter", unit)
    report.check(f"{name} has one object and one build item a part", objects == len(parts) == len(items),
                 f"{objects} objects, {len(items)} items, {len(parts)} parts")
    lost = []
    for part in parts:
        differences = [same_triangles(corners, job.triangles[part["id"]]) for _, corners in items]
        if differences.count("") != 1:
            lost.append(f"part {part['id']} ({min(differences, key=len, default='no item')})")
    report.check(f"{name} holds exactly the parts, in place", not lost, first_few(lost))


def check_program(job, tray, dialect, report):
    if dialect not in DIALECT_SUFFIX:
        return
    name = program_file(tray, DIALECT_SUFFIX[dialect])
    try:
        data = (job.folder / name).read_bytes()
    except OSError as error:
        report.check(f"{name} holds a program", False, error)
        return
    if dialect == "gcode":
        moves = len(re.findall(rb"^G[01] ", data, re.MULTILINE))
        report.check(f"{name} holds a program", moves > 10 and b"\0" not in data, f"{moves} moves")
    else:
        report.check(f"{name} holds a program", len(data) > 100, f"{len(data)} bytes")
