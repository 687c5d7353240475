#!/usr/bin/python3
"""The checker's own tests: a good job folder passes, and every broken promise is found by the check meant for it."""
import json
import pathlib
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import synthetic
from check_job import check
from checker import meshes, removal, separation, solids, triangles
from checker.columns import Grid, intervals
from checker.tree import Tree


def rewrite(path, change):
    """Edits job.json in place."""
    data = json.loads(path.read_text())
    change(data)
    path.write_text(json.dumps(data))


def edit_stl(path, change):
    meshes.write_binary_stl(path, change(meshes.read_binary_stl(path).astype(np.float64)))


def set_at(*keys, value):
    """A change of job.json: data[keys…] = value."""
    def change(data):
        for key in keys[:-1]:
            data = data[key]
        data[keys[-1]] = value
    return lambda job: rewrite(job / "job.json", change)


def drop(*keys):
    def change(data):
        for key in keys[:-1]:
            data = data[key]
        del data[keys[-1]]
    return lambda job: rewrite(job / "job.json", change)


def change_part(number, change):
    """Edits a part's triangles, and tray.stl with it, as a wrong program would."""
    def apply(job):
        edit_stl(job / "parts" / f"{number:02d}.stl", change)
        both = [meshes.read_binary_stl(job / "parts" / name) for name in ("01.stl", "02.stl")]
        meshes.write_binary_stl(job / "tray.stl", np.concatenate(both))
    return apply


def move_part(number, shift, with_transform=True):
    """The part and its transform move together: only promises about the tray break."""
    def apply(job):
        change_part(number, lambda corners: corners + shift)(job)

        def change(data):
            for axis in range(3):
                data["parts"][number - 1]["transform"][4 * axis + 3] += shift[axis]
        if with_transform:
            rewrite(job / "job.json", change)
    return apply


def add_box(low, high, flipped=False):
    def change(corners):
        box = synthetic.polycube(*zip(low, high), lambda i, j, k: True)
        return np.concatenate([corners, box[:, ::-1] if flipped else box])
    return change


def mirror(job):
    change_part(2, lambda corners: (corners * [1, -1, 1] + [0, 36, 0])[:, ::-1])(job)

    def change(data):
        pose = np.array(data["parts"][1]["transform"]).reshape(4, 4)
        data["parts"][1]["transform"] = (np.diag([1, -1, 1, 1]) @ pose + [[0] * 4, [0, 0, 0, 36], [0] * 4, [0] * 4]).ravel().tolist()
    rewrite(job / "job.json", change)


def shrink_in_model(job):
    """The part printed 2 % too small: closed and in its place, but not the model's."""
    change_part(1, lambda corners: (corners - [15, 20, 0]) * 0.98 + [15, 20, 0])(job)


def swell_in_model(job):
    """Only the cut moves: part 1 reaches 0.5 mm into part 2."""
    change_part(1, lambda corners: corners + np.where(corners[:, :, :1] > 24.9, [0.5, 0, 0], 0))(job)


def write(name, data):
    return lambda job: (job / name).write_bytes(data)


def three_mf(**options):
    def apply(job):
        placed = [meshes.read_binary_stl(job / "parts" / name).astype(float) for name in ("01.stl", "02.stl")]
        synthetic.write_3mf(job / "tray.3mf", placed[:options.pop("count", 2)], **options)
    return apply


def path_of_first(*steps):
    def change(data):
        data["removal_order"] = [1, 2]
        data["removal_path"] = {"1": [list(step) for step in steps]}
    return lambda job: rewrite(job / "job.json", change)


NOT_FITTING = {"fits": False, "time_s": 5.0}
BREAKS = {
    "a key is missing": (drop("packing", "bbox_mm3"), "every key with its type"),
    "a setting is missing": (drop("settings", "tabu_memory"), "every key with its type"),
    "a number is a text": (set_at("seed", value="1"), "every key with its type"),
    "a transform is short": (set_at("parts", 0, "transform", value=[1.0] * 12), "every key with its type"),
    "a number is not finite": (set_at("packing", "cost", value=float("nan")), "JSON of finite numbers"),
    "job.json is cut short": (write("job.json", b'{"version": 1'), "JSON of finite numbers"),
    "a file is missing": (lambda job: (job / "assembly.glb").unlink(), "every promised file is there"),
    "a part's file is missing": (lambda job: (job / "parts/02.stl").unlink(), "every promised file is there"),
    "a part too many": (write("parts/03.stl", b"x"), "no tray, program or part that job.json does not know"),
    "a tray too many": (write("tray-2.stl", b"x"), "no tray, program or part that job.json does not know"),
    "an empty file": (write("preview.glb", b""), "no promised file is empty"),
    "neighbours one-sided": (set_at("parts", 0, "neighbours", value=[]), "neighbours are mutual"),
    "a wrong glue area": (lambda job: [set_at("parts", k, "neighbours", 0, "glue_area_mm2", value=300.0)(job)
                                       for k in (0, 1)], "neighbours share their glue_area_mm2"),
    "a joint left out": (lambda job: [set_at("parts", k, "neighbours", value=[])(job) for k in (0, 1)],
                         "neighbours share their glue_area_mm2"),
    "gap differs from the settings": (set_at("packing", "gap_mm", value=0.5), "repeat the settings"),
    "a truncated STL": (lambda job: write("parts/01.stl", (job / "parts/01.stl").read_bytes()[:-7])(job),
                        "binary STL of finite numbers"),
    "a hole": (change_part(1, lambda c: c[1:]), "closed 2-manifold"),
    "a doubled triangle": (change_part(1, lambda c: np.concatenate([c, c[:1]])), "closed 2-manifold"),
    "one triangle turned": (change_part(1, lambda c: np.concatenate([c[:1, ::-1], c[1:]])), "closed 2-manifold"),
    "inside out": (change_part(1, lambda c: c[:, ::-1]), "is outward"),
    "a touching edge": (change_part(1, add_box((25, 35, 5), (30, 40, 20))), "closed 2-manifold"),
    "a touching vertex": (change_part(1, add_box((25, 35, 20), (30, 40, 25))), "closed 2-manifold"),
    "two pieces of matter": (change_part(1, add_box((60, 60, 0), (62, 62, 2))), "one piece of matter"),
    "matter inside a cavity's air": (change_part(1, add_box((60, 60, 0), (62, 62, 2), flipped=True)),
                                     "one piece of matter"),
    "a wrong volume": (set_at("parts", 0, "volume_mm3", value=6300.0), "has its volume_mm3"),
    "outside the build volume": (move_part(1, [0, 0, -0.01]), "inside build_mm"),
    "above the build volume": (set_at("printer", "build_mm", value=[100, 80, 41]), "inside build_mm"),
    "a mirrored part": (mirror, "rigid transform"),
    "a scaled transform": (set_at("parts", 0, "transform", 0, value=1.001), "rigid transform"),
    "too close": (move_part(2, [0, 0, -0.51]), "parts keep gap_mm"),
    "parts intersect": (move_part(2, [0, 0, -3]), "parts keep gap_mm"),
    "a part inside another": (change_part(2, lambda c: (c - [20, 18, 31.5]) * 0.05 + [6.5, 20, 10]),
                              "no part inside another"),
    "a part listed twice": (set_at("removal_order", value=[2, 2]), "lists every part once"),
    "a part not listed": (set_at("removal_order", value=[2]), "lists every part once"),
    "the wrong order": (set_at("removal_order", value=[1, 2]), "comes out freely"),
    "a path through a part": (path_of_first((0, 0, 30)), "comes out freely"),
    "a path that ends below a part": (path_of_first((0, 5, 0)), "comes out freely"),
    "a path of nobody": (set_at("removal_path", value={"9": [[1, 0, 0]]}), "removal_path belongs to parts"),
    "a wrong box": (set_at("packing", "bbox_mm3", value=37000.0), "packing.bbox_mm3"),
    "a wrong height": (set_at("packing", "height_mm", value=41.0), "packing.height_mm"),
    "a wrong support": (set_at("packing", "support_mm3", value=15700.0), "packing.support_mm3"),
    "a wrong cost": (set_at("packing", "cost", value=31000.0), "packing.cost"),
    "a wrong shell": (set_at("shell", "volume_mm3", value=12600.0), "sum to shell.volume_mm3"),
    "a transform off by 0.2 mm": (move_part(2, [0, 0.2, 0], with_transform=False), "outer surface lies on the model"),
    "a part too small": (shrink_in_model, "outer surface lies on the model"),
    "a part missing from the assembly": (lambda job: [drop("parts", 1)(job), (job / "parts/02.stl").unlink()],
                                         "model's surface is covered"),
    "parts overlap put back": (swell_in_model, "do not overlap"),
    "another model's sum": (set_at("inputs", 0, "sha256", value="a" * 64), "has the sha256"),
    "a wrong scale": (set_at("inputs", 0, "scale", value=1.01), "model's surface is covered"),
    "tray.stl lacks a triangle": (lambda job: edit_stl(job / "tray.stl", lambda c: c[:-1]), "tray.stl holds"),
    "tray.stl is moved": (lambda job: edit_stl(job / "tray.stl", lambda c: c + [0.01, 0, 0]), "tray.stl holds"),
    "3MF in inches": (three_mf(unit="inch"), "in millimetres"),
    "3MF items misplaced": (three_mf(shift=(0, 0, 1)), "tray.3mf holds exactly"),
    "3MF lacks a part": (three_mf(count=1), "one object and one build item"),
    "3MF is no archive": (write("tray.3mf", b"PK nothing"), "is a core 3MF"),
    "profile.toml is broken": (write("profile.toml", b"a = "), "profile.toml parses"),
    "profile.toml of another job": (write("profile.toml", b"gap_mm = 2.0"), "agrees with settings"),
    "no program": (write("profile.toml", b'dialect = "gcode"'), "every promised file is there"),
    "an empty program": (lambda job: [write("profile.toml", b'dialect = "gcode"')(job),
                                      write("program.gcode", b"; nothing")(job)], "holds a program"),
    "a blank picture": (lambda job: synthetic.write_png(job / "preview.png", np.full((240, 400, 3), 200, np.uint8)),
                        "shows something"),
    "half a picture": (lambda job: write("preview.png", (job / "preview.png").read_bytes()[:5000])(job),
                       "preview.png is a PNG"),
    "a tiny picture": (lambda job: synthetic.write_png(job / "preview.png", np.zeros((8, 8, 3), np.uint8)),
                       "sensible size"),
    "a GLB lacks a part": (lambda job: synthetic.write_glb(job / "preview.glb", [synthetic.part_corners(1)]),
                           "preview.glb shows every part"),
    "a GLB in millimetres": (lambda job: synthetic.write_glb(
        job / "assembly.glb", [1000 * synthetic.part_corners(1), 1000 * synthetic.part_corners(2)]),
        "assembly.glb shows every part"),
    "a GLB is cut short": (lambda job: write("preview.glb", (job / "preview.glb").read_bytes()[:-4])(job),
                           "preview.glb is a glTF"),
    "an estimate lacks a figure": (drop("estimates", "solid", "cost"), "estimates are complete"),
    "figures though it does not fit": (set_at("estimates", "as_is", value=NOT_FITTING), "estimates are complete"),
    "an unknown source": (set_at("estimates", "packed", "source", value="guess"), "estimates are complete"),
    "packed counts other parts": (set_at("estimates", "packed", "parts", value=7), "counts the parts"),
}


class Promises(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="packmerger-check-")
        self.addCleanup(self.folder.cleanup)
        self.job, self.model = synthetic.write_job(self.folder.name)

    def failures(self):
        return [row["check"] + ": " + row["figures"] for row in check(self.job, [self.model]).failures()]

    def test_a_good_job_passes(self):
        self.assertEqual(self.failures(), [])

    def test_a_path_that_leads_out_passes(self):
        path_of_first((0, 0.4, 0), (40, 0, 0))(self.job)
        self.assertEqual(self.failures(), [])


def _add_break(name, apply, expected):
    def test(self):
        apply(self.job)
        failures = self.failures()
        self.assertTrue(any(expected in line for line in failures), f"not found: {name}; failures: {failures}")
    setattr(Promises, "test_finds_" + name.replace(" ", "_"), test)


for _name, (_apply, _expected) in BREAKS.items():
    _add_break(_name, _apply, _expected)


def random_triangles(random, count, size=1.0):
    return random.random((count, 1, 3)) * 10 + random.normal(size=(count, 3, 3)) * size


class Geometry(unittest.TestCase):
    """The checker's measures against slow or closed-form ones."""

    def test_triangle_distance_is_the_least_over_dense_samples(self):
        random = np.random.default_rng(3)
        first, second = random_triangles(random, 60), random_triangles(random, 60)
        exact = triangles.triangle_triangle(first, second)
        steps = [(i / 24, j / 24) for i in range(25) for j in range(25 - i)]
        for k in range(60):
            clouds = [np.array([t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]) for u, v in steps])
                      for t in (first[k], second[k])]
            sampled = np.linalg.norm(clouds[0][:, None] - clouds[1][None], axis=2).min()
            self.assertLessEqual(exact[k], sampled + 1e-9)
            self.assertGreater(exact[k], sampled - 0.3)
        self.assertTrue((triangles.plane_gap(first, second) <= exact + 1e-9).all())

    def test_triangle_distance_of_known_pairs(self):
        flat = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0]], dtype=float)
        cases = [(flat + [0, 0, 2], 2.0), (flat[:, [2, 0, 1]] + [1, 1, -1], 0.0), (flat + [-5, 0, 0], 1.0),
                 (flat * [1, 1, 0] + [4, 4, 0], np.sqrt(8)), (flat + [1, 1, 0], 0.0)]
        for other, expected in cases:
            self.assertAlmostEqual(triangles.triangle_triangle(flat[None], other[None])[0], expected, places=9)

    def test_closest_equals_brute_force(self):
        random = np.random.default_rng(5)
        corners = random_triangles(random, 300)
        points = random.random((200, 3)) * 14 - 2
        distance, row = Tree(corners).closest(points)
        for point, found, where in zip(points, distance, row):
            every = np.sqrt(triangles.point_triangle(np.repeat(point[None], 300, axis=0), corners))
            self.assertAlmostEqual(found, every.min(), places=9)
            self.assertAlmostEqual(every[where], found, places=9)

    def test_surface_distance_equals_brute_force(self):
        random = np.random.default_rng(6)
        for shift in (0.0, 3.0, 12.0, 14.0):
            first, second = random_triangles(random, 90, 0.4), random_triangles(random, 70, 0.4) + [shift, 0, 0]
            pairs = np.indices((90, 70)).reshape(2, -1)
            brute = triangles.triangle_triangle(first[pairs[0]], second[pairs[1]]).min()
            self.assertAlmostEqual(separation.surface_distance(Tree(first), Tree(second), 100.0), brute, places=9)

    def test_winding_of_a_hollow_box(self):
        corners = synthetic.polycube([0, 3, 37, 40], [0, 3, 27, 30], [0, 3, 17, 20],
                                     lambda i, j, k: (i, j, k) != (1, 1, 1))
        points = np.array([[1.1, 5.3, 5.7], [20.1, 15.3, 10.7], [-1, 3, 3], [20.2, 15.3, 18.1]])
        self.assertEqual(Tree(corners).winding(points).tolist(), [1, 0, 0, 1])

    def test_topology_of_a_part_is_clean(self):
        corners = synthetic.part_corners(1)
        points, index = meshes.weld(corners)
        self.assertEqual(solids.topology_faults(index, len(points)), {})

    def test_columns_measure_a_volume(self):
        corners = synthetic.part_corners(1)
        turn = np.linalg.qr(np.random.default_rng(9).normal(size=(3, 3)))[0]
        corners = corners @ (turn * np.linalg.det(turn)).T
        flat = corners.reshape(-1, 3)
        grid = Grid(flat.min(axis=0), flat.max(axis=0), 0.1)
        (_, bottom, top, _), bad, lines = intervals(grid, corners)
        self.assertLess(abs((top - bottom).sum() * grid.step ** 2 / meshes.volume(corners) - 1), 2e-3)
        self.assertLess(bad, 1e-3 * lines)

    def test_parts_that_only_touch_seen_from_above_lift_freely(self):
        low, high = ([0, 10], [0, 10], [0, 10]), ([10, 20], [0, 10], [5, 30])
        boxes = [Tree(synthetic.polycube(*axes, lambda i, j, k: True)) for axes in (low, high)]
        self.assertEqual(removal.blocked_by(boxes[0], boxes[1]), 0.0)
        self.assertAlmostEqual(removal.blocked_by(boxes[0], boxes[1].moved(np.array([-0.1, 0, 0]))), 30.0)

    def test_a_hook_blocks_both_ways(self):
        """A part whose arm reaches over another's foot cannot be under it as well."""
        hook = synthetic.polycube([0, 2, 8], [0, 5], [0, 8, 10], lambda i, j, k: i == 0 or k == 1)
        foot = synthetic.polycube([3, 7], [0, 5], [0, 5], lambda i, j, k: True)
        self.assertAlmostEqual(removal.blocked_by(Tree(foot), Tree(hook)), 10.0)
        self.assertEqual(removal.blocked_by(Tree(hook), Tree(foot)), 0.0)


class Readers(unittest.TestCase):
    def test_every_format_gives_the_same_box(self):
        corners = synthetic.model_corners()
        points, index = meshes.weld(corners)
        vertex_lines = "\n".join(" ".join(map(str, p)) for p in points)
        face_lines = "\n".join("3 " + " ".join(map(str, t)) for t in index)
        count = f"{len(points)} {len(index)}"
        header = (f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n"
                  f"property float z\nelement face {len(index)}\nproperty list uchar int vertex_indices\nend_header\n")
        binary = (header.replace("ascii", "binary_little_endian").encode() + points.astype("<f4").tobytes()
                  + b"".join(b"\x03" + t.astype("<i4").tobytes() for t in index))
        texts = {
            "a.off": f"OFF\n{count} 0\n{vertex_lines}\n{face_lines}\n",
            "a.obj": "\n".join("v " + line for line in vertex_lines.split("\n")) + "\n"
                     + "\n".join("f " + " ".join(f"{v + 1}/1" for v in t) for t in index),
            "a.ply": header + vertex_lines + "\n" + face_lines + "\n",
            "a.stl": "solid a\n" + "\n".join("facet normal 0 0 0\nouter loop\n" + "\n".join(
                "vertex " + " ".join(map(str, p)) for p in t) + "\nendloop\nendfacet" for t in corners)}
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "b.ply").write_bytes(binary)
            meshes.write_binary_stl(folder / "b.stl", corners)
            for name, text in texts.items():
                (folder / name).write_text(text)
            for path in sorted(folder.iterdir()):
                with self.subTest(path.name):
                    read = meshes.read_model(path)
                    self.assertEqual(len(read), 12 * 2 - 4)
                    self.assertAlmostEqual(meshes.volume(read), 24000.0, places=6)


if __name__ == "__main__":
    unittest.main()
