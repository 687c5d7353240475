"""Files that no model can be made of, each with the exit codes that are right for it."""
import io
import random
import struct
import zipfile
import zlib

import numpy as np

from checker import meshes
from shapes import sphere

BAD, NONE = {65}, {66}
MAX = 0xFFFFFFFF


def stl(corners, count=None):
    data = io.BytesIO()
    data.write(b"a mesh".ljust(80) + struct.pack("<I", len(corners) if count is None else count))
    for triangle in np.asarray(corners):
        data.write(np.concatenate([np.zeros(3), triangle.ravel()]).astype("<f4").tobytes() + b"\0\0")
    return data.getvalue()


def _points_and_faces():
    return meshes.weld(sphere(rings=6, sectors=8))


def obj(replace=None):
    points, index = _points_and_faces()
    lines = ["v " + " ".join(map(str, p)) for p in points] + ["f " + " ".join(str(i + 1) for i in t) for t in index]
    return "\n".join(replace(lines) if replace else lines).encode()


def off(head=None, first=None):
    points, index = _points_and_faces()
    rows = [" ".join(map(str, p)) for p in points]
    rows[0] = first or rows[0]
    rows += ["3 " + " ".join(map(str, t)) for t in index]
    return ("OFF\n" + (head or f"{len(points)} {len(index)} 0") + "\n" + "\n".join(rows)).encode()


def ply(vertices=None, faces=None, form="ascii", first=None):
    points, index = _points_and_faces()
    head = (f"ply\nformat {form} 1.0\nelement vertex {vertices or len(points)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {faces or len(index)}\nproperty list uchar int vertex_indices\nend_header\n")
    if form == "ascii":
        rows = [" ".join(map(str, p)) for p in points]
        rows[0] = first or rows[0]
        return (head + "\n".join(rows + ["3 " + " ".join(map(str, t)) for t in index])).encode()
    return head.encode() + points.astype("<f4").tobytes() + b"".join(b"\x03" + t.astype("<i4").tobytes() for t in index)


def three_mf(model, name="3D/3dmodel.model", ballast=b""):
    package = "http://schemas.openxmlformats.org/package/2006"
    kind = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("[Content_Types].xml", f'<Types xmlns="{package}/content-types"/>')
        archive.writestr("_rels/.rels", f'<Relationships xmlns="{package}/relationships"><Relationship Id="r" '
                         f'Type="{kind}" Target="/3D/3dmodel.model"/></Relationships>')
        archive.writestr(name, model)
        archive.writestr("ballast", ballast, zipfile.ZIP_STORED)  # makes what is inflated look plausible
    return data.getvalue()


def model_xml(resources, build='<item objectid="1"/>'):
    return ('<?xml version="1.0"?><model unit="millimeter" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">'
            f"<resources>{resources}</resources><build>{build}</build></model>")


def mesh_xml(vertices, triangles):
    points = "".join(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in vertices)
    faces = "".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in triangles)
    return f'<object id="1"><mesh><vertices>{points}</vertices><triangles>{faces}</triangles></mesh></object>'


def zip_bomb(told_size):
    """A 3MF whose model inflates to 3.9 GiB of spaces from 4 MiB, and says it is told_size long. A flushed deflate
    block does not look back, so one of 64 MiB is written over and over."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(b" " * (64 << 20)) + packer.flush(zlib.Z_FULL_FLUSH)
    packed = block * 62 + packer.flush(zlib.Z_FINISH)
    plain = zipfile.ZipFile(io.BytesIO(three_mf("", "3D/unused.model")))
    entries = [(info.filename, plain.read(info), None) for info in plain.infolist()[:2]]
    entries.append(("3D/3dmodel.model", packed, told_size))
    body, directory = b"", b""
    for name, data, size in entries:
        method = 0 if size is None else 8
        crc = zlib.crc32(data) if size is None else 0
        fields = struct.pack("<HHHHHIIIHH", 20, 0, method, 0, 0, crc, len(data),
                             len(data) if size is None else size, len(name), 0)
        directory += (b"PK\x01\x02\x14\0" + fields + struct.pack("<HHHII", 0, 0, 0, 0, len(body)) + name.encode())
        body += b"PK\x03\x04" + fields + name.encode() + data
    end = struct.pack("<4sHHHHIIH", b"PK\x05\x06", 0, 0, len(entries), len(entries), len(directory), len(body), 0)
    return body + directory + end


def _with_coordinate(value):
    corners = sphere(rings=6, sectors=8)
    corners[corners == corners.max()] = value
    return corners


SPHERE = sphere(rings=6, sectors=8)
TETRAHEDRON = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]

# name: (file name, bytes or a function that makes them, right exit codes)
CASES = {
    "empty STL": ("a.stl", b"", BAD),
    "empty OBJ": ("a.obj", b"", BAD),
    "empty PLY": ("a.ply", b"", BAD),
    "empty OFF": ("a.off", b"", BAD),
    "empty 3MF": ("a.3mf", b"", BAD),
    "unknown kind of file": ("a.txt", b"hello", BAD),
    "garbage STL": ("a.stl", bytes(range(256)) * 40, BAD),
    "garbage OBJ": ("a.obj", bytes(range(256)) * 40, BAD),
    "garbage PLY": ("a.ply", bytes(range(256)) * 40, BAD),
    "garbage OFF": ("a.off", bytes(range(256)) * 40, BAD),
    "garbage 3MF": ("a.3mf", bytes(range(256)) * 40, BAD),
    "header only STL": ("a.stl", stl([]), BAD),
    "ASCII STL without facets": ("a.stl", b"solid a\nendsolid a\n", BAD),
    "truncated STL": ("a.stl", stl(SPHERE)[:-500], BAD),
    "truncated OFF": ("a.off", off()[:-300], BAD),
    "truncated ascii PLY": ("a.ply", ply()[:-300], BAD),
    "truncated binary PLY": ("a.ply", ply(form="binary_little_endian")[:-300], BAD),
    "truncated 3MF": ("a.3mf", three_mf(model_xml(mesh_xml(TETRAHEDRON, FACES)))[:-100], BAD),
    "STL of many triangles told": ("a.stl", stl(SPHERE, MAX), BAD),
    "STL of more triangles told": ("a.stl", stl(SPHERE, len(SPHERE) + 1), BAD),
    "OFF of many vertices told": ("a.off", off(head="4000000000 4 0"), BAD),
    "OFF of many faces told": ("a.off", off(head="8 4000000000 0"), BAD),
    "OFF of a negative count": ("a.off", off(head="-5 4 0"), BAD),
    "OFF of a large face": ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n", BAD),
    "PLY of many vertices told": ("a.ply", ply(vertices=4000000000), BAD),
    "binary PLY of many vertices told": ("a.ply", ply(vertices=4000000000, form="binary_little_endian"), BAD),
    "binary PLY of many faces told": ("a.ply", ply(faces=4000000000, form="binary_little_endian"), BAD),
    "PLY without end of header": ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 3\n", BAD),
    "PLY of an unknown form": ("a.ply", ply().replace(b"ascii", b"morse"), BAD),
    "NaN in STL": ("a.stl", stl(_with_coordinate(np.nan)), BAD),
    "infinity in STL": ("a.stl", stl(_with_coordinate(np.inf)), BAD),
    "NaN in OBJ": ("a.obj", obj(lambda lines: ["v nan 0 0"] + lines[1:]), BAD),
    "infinity in OBJ": ("a.obj", obj(lambda lines: ["v 1e999 0 0"] + lines[1:]), BAD),
    "NaN in PLY": ("a.ply", ply(first="nan 0 0"), BAD),
    "infinity in PLY": ("a.ply", ply(first="inf 0 0"), BAD),
    "NaN in OFF": ("a.off", off(first="nan 0 0"), BAD),
    "infinity in OFF": ("a.off", off(first="-inf 0 0"), BAD),
    "NaN in 3MF": ("a.3mf", three_mf(model_xml(mesh_xml([("nan", 0, 0)] + TETRAHEDRON[1:], FACES))), BAD),
    "OBJ index too large": ("a.obj", obj(lambda lines: lines + ["f 1 2 999999999"]), BAD),
    "OBJ index zero": ("a.obj", obj(lambda lines: lines + ["f 0 1 2"]), BAD),
    "OBJ index too negative": ("a.obj", obj(lambda lines: lines + ["f -999999 1 2"]), BAD),
    "OBJ index past all integers": ("a.obj", obj(lambda lines: lines + ["f 1 2 99999999999999999999"]), BAD),
    "OBJ of points": ("a.obj", obj(lambda lines: [line for line in lines if line[0] == "v"]), BAD),
    "OFF index too large": ("a.off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", BAD),
    "a single triangle": ("a.stl", stl(SPHERE[:1]), BAD),
    "all triangles degenerate": ("a.stl", stl(np.repeat(SPHERE[:, :1], 3, axis=1)), BAD),
    "a flat mesh": ("a.stl", stl(SPHERE * [1, 1, 0]), BAD),
    "a mesh of 1e30 mm": ("a.stl", stl(SPHERE * 1e30), BAD),
    "a mesh of a kilometre": ("a.stl", stl(SPHERE * 25e3), BAD),
    "3MF without a model": ("a.3mf", three_mf("", "3D/other.model"), BAD),
    "3MF of broken XML": ("a.3mf", three_mf("<model><resources>"), BAD),
    "3MF without objects": ("a.3mf", three_mf(model_xml("", "")), BAD),
    "3MF index too large": ("a.3mf", three_mf(model_xml(mesh_xml(TETRAHEDRON, [(0, 1, 9)]))), BAD),
    "3MF index negative": ("a.3mf", three_mf(model_xml(mesh_xml(TETRAHEDRON, [(0, 1, -1)]))), BAD),
    "3MF object that holds itself": ("a.3mf", three_mf(model_xml(
        '<object id="1"><components><component objectid="1"/></components></object>')), BAD),
    "3MF of exploding components": ("a.3mf", lambda: three_mf(model_xml(
        mesh_xml(TETRAHEDRON, FACES) + "".join(
            f'<object id="{n}"><components>' + f'<component objectid="{n - 1}"/>' * 10 + "</components></object>"
            for n in range(2, 14)), '<item objectid="13"/>')), BAD),
    "3MF of an unknown unit": ("a.3mf", three_mf(model_xml(mesh_xml(TETRAHEDRON, FACES)).replace(
        "millimeter", "furlong")), BAD),
    "3MF of a missing object": ("a.3mf", three_mf(model_xml(mesh_xml(TETRAHEDRON, FACES),
                                                           '<item objectid="7"/>')), BAD),
    "3MF with entities": ("a.3mf", three_mf('<!DOCTYPE a [<!ENTITY b "' + "x" * 999 + '">' + "".join(
        f'<!ENTITY {chr(98 + n)} "{("&" + chr(97 + n) + ";") * 50}">' for n in range(1, 9)) + "]><model>&j;</model>"), BAD),
    "3MF of countless elements": ("a.3mf", lambda: three_mf(
        "<model>" + "<a/>" * (48 << 20) + "</model>", ballast=random.Random(1).randbytes(1 << 20)), BAD),
    "zip bomb": ("a.3mf", lambda: zip_bomb(62 * (64 << 20)), BAD),
    "zip bomb that tells a small size": ("a.3mf", lambda: zip_bomb(1000), BAD),
}
