"""The job folder in memory."""
import json
import pathlib

import numpy as np

from . import meshes


def _refuse_constant(text):
    raise ValueError(f"{text} is not a number of JSON")


class Job:
    """data is job.json; triangles[id] the part's N×3×3 corners in tray coordinates, mm, as stored."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        text = (self.folder / "job.json").read_text(encoding="utf-8")
        self.data = json.loads(text, parse_constant=_refuse_constant)
        self.triangles = {}

    def read_parts(self, report):
        """Fills triangles; a part that cannot be read is reported and left out."""
        for part in self.parts():
            try:
                corners = meshes.read_binary_stl(self.folder / part["file"])
                holds = len(corners) > 0 and bool(np.isfinite(corners).all())
                if holds:
                    self.triangles[part["id"]] = corners.astype(np.float64)
                report.check(f"{part['file']} is a binary STL of finite numbers", holds, f"{len(corners)} triangles")
            except (OSError, ValueError) as error:
                report.check(f"{part['file']} is a binary STL of finite numbers", False, error)

    def parts(self):
        return self.data["parts"]

    def part(self, part_id):
        return next(part for part in self.parts() if part["id"] == part_id)

    def readable_parts(self):
        return [part for part in self.parts() if part["id"] in self.triangles]

    def trays(self):
        """Tray numbers, sorted."""
        return sorted({part["tray"] for part in self.parts()})

    def parts_of_tray(self, tray):
        return [part for part in self.readable_parts() if part["tray"] == tray]

    def in_model(self, part):
        """The part's triangles in model coordinates, mm."""
        pose = np.array(part["transform"], dtype=np.float64).reshape(4, 4)
        back = np.linalg.inv(pose)
        return self.triangles[part["id"]] @ back[:3, :3].T + back[:3, 3]

    def setting(self, key, otherwise=None):
        return self.data.get("settings", {}).get(key, otherwise)


def tray_file(tray, suffix):
    """tray.stl, tray-2.stl, …"""
    return f"tray{suffix}" if tray == 1 else f"tray-{tray}{suffix}"


def program_file(tray, suffix):
    return f"program{suffix}" if tray == 1 else f"program-{tray}{suffix}"
