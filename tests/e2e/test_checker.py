#!/usr/bin/python3
"""The checker's own tests: a good job folder passes, and every broken promise is found by the check meant for it."""
import hashlib
import pathlib
import sys
import tempfile
import types
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import synthetic
from breaks import BREAKS, change_part, path_of_first, set_at
from check_job import check
from checker import figures, meshes, removal, separation, solids, triangles
from checker.assembly import check_coverage, filled_crevice
from checker.columns import Grid, intervals
from checker.outside import Matter, MatterByAngle, bounds_by_angle, outer_sheets, winding_by_angle
from checker.report import Report
from checker.tree import Tree
from shapes import sphere


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


class OverlappingBodies(unittest.TestCase):
    """The same job of a model of two boxes that overlap at 18 < x < 22: the sheets between them bound nothing."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="packmerger-check-")
        self.addCleanup(self.folder.cleanup)
        self.job, self.model = synthetic.write_job(self.folder.name)
        boxes = [synthetic.polycube(xs, [0, 30], [0, 20], lambda i, j, k: True) for xs in ([0, 22], [18, 40])]
        meshes.write_binary_stl(self.model, np.concatenate(boxes))
        set_at("inputs", 0, "sha256", value=hashlib.sha256(self.model.read_bytes()).hexdigest())(self.job)

    def failures(self):
        return [row["check"] for row in check(self.job, [self.model]).failures()]

    def test_a_good_job_passes(self):
        self.assertEqual(self.failures(), [])

    def test_finds_a_slot_along_a_sheet_that_bounds_nothing(self):
        """In the floor of part 1 at x = 18, which is 23 on the tray."""
        xs = [5, 8, 22.96, 23.04, 25]
        slotted = synthetic.polycube(xs, [5, 8, 32, 35], [0, 3, 17, 20], lambda i, j, k: not (
            i >= 1 and j == 1 and k == 1 or i == 2 and j == 1 and k == 0))
        change_part(1, lambda _: slotted)(self.job)
        self.assertIn("input 0: the parts' outer surface lies on the model", self.failures())

    def test_finds_what_is_missing(self):
        for name in ("a part too small", "a part missing from the assembly", "a transform off by 0.2 mm"):
            with self.subTest(name):
                self.setUp()
                BREAKS[name][0](self.job)
                self.assertTrue(any(BREAKS[name][1] in line for line in self.failures()))


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

    def test_outer_sheets_are_those_of_the_united_bodies(self):
        first = synthetic.polycube([0, 10], [0, 10], [0, 10], lambda i, j, k: True)
        within = synthetic.polycube([2, 4], [2, 4], [2, 4], lambda i, j, k: True)
        pin = synthetic.polycube([4.7, 5.3], [4.6, 5.4], [5, 13], lambda i, j, k: True)  # through a face's middle
        cavity = synthetic.polycube([6, 9], [6, 9], [6, 9], lambda i, j, k: True)[:, ::-1]
        for is_open in (False, True):
            outer = outer_sheets(np.concatenate([first, within, pin, cavity]), is_open)
            self.assertAlmostEqual(meshes.volume(outer), 1000 + 0.6 * 0.8 * 3 - 27, delta=0.5)
            self.assertAlmostEqual(meshes.areas_and_normals(outer)[0].sum(), 600 + 2 * (0.6 + 0.8) * 3 + 54, delta=0.5)

    def test_what_closes_a_hole_bounds_matter(self):
        box = synthetic.polycube([0, 10], [0, 10], [0, 10], lambda i, j, k: True)
        bowl = box[box[:, :, 2].min(axis=1) < 9]  # without its lid
        points = np.array([[5.1, 5.2, 10], [5.1, 5.2, 7], [5.1, 5.2, 14], [0, 5, 5]])
        up = np.array([[0, 0, 1.0], [0, 0, 1.0], [0, 0, 1.0], [-1, 0, 0]])
        self.assertEqual(bounds_by_angle(points, up, bowl).tolist(), [True, False, False, True])
        self.assertEqual(bounds_by_angle(points[3:], -up[3:], bowl).tolist(), [False])
        self.assertAlmostEqual(winding_by_angle(points[1:2], box)[0], 1, places=6)

    def test_only_a_filled_and_narrow_crevice_need_not_be_covered(self):
        block = synthetic.polycube([0, 10], [0, 10], [0, 10], lambda i, j, k: True)
        points, normals = np.array([[5.0, 5.1, 7.3]]), np.array([[1.0, 0.0, 0.0]])
        for width_mm, is_narrow in ((0.01, True), (0.04, True), (0.12, False)):
            halves = synthetic.polycube([0, 5, 5 + width_mm, 10], [0, 10], [0, 10], lambda i, j, k: i != 1)
            matter = Matter(halves, is_open=False)
            self.assertEqual(filled_crevice(matter, block, points, normals, 0.1).tolist(), [is_narrow])
            self.assertEqual(filled_crevice(matter, block, points, normals, 0.3).tolist(), [is_narrow])
            self.assertFalse(filled_crevice(matter, block + [0, 0, 8], points, normals, 0.1).any())
            lidless = halves[halves[:, :, 2].min(axis=1) < 9]
            self.assertEqual(filled_crevice(MatterByAngle(lidless), block, points - [0, 0, 4], normals, 0.1).tolist(),
                             [is_narrow])

    def test_a_model_of_filled_crevices_is_not_covered(self):
        block = synthetic.polycube([0, 10], [0, 10], [0, 10], lambda i, j, k: True)
        parts = types.SimpleNamespace(all_corners=lambda: block)
        for size_mm, failed in ((0.5, []), (6.0, ["covered by the parts", "few points"])):
            slit = synthetic.polycube([0, 5, 5.02, 10], [0, 10 - size_mm, 10], [0, 10 - size_mm, 10],
                                      lambda i, j, k: (i, j, k) != (1, 1, 1))
            ends = (slit[:, :, 1:] == 10 - size_mm).all(axis=1).any(axis=1)  # faced by nothing near
            slit = slit[~ends]
            report = Report()
            check_coverage(parts, slit, Matter(slit, is_open=False), 0.1, 0, report)
            self.assertEqual(len(report.failures()), len(failed))
            for row, name in zip(report.failures(), failed):
                self.assertIn(name, row["check"])

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

    def test_support_of_a_sphere_by_angle(self):
        """Standing on the tray, only the cap steeper than the angle counts; its volume is known."""
        radius, corners = 20.0, sphere(20.0, 120, 180)

        class OneSphere:
            triangles = {1: corners}

            def parts_of_tray(self, _):
                return [{"id": 1}]
        for angle in (0, 30, 45, 60):
            cosine = np.sin(np.radians(angle))  # of the cap's polar angle
            under = np.pi * radius ** 3 * (1 - cosine ** 2) - 2 / 3 * np.pi * radius ** 3 * (1 - cosine ** 3)
            least, most = figures.tray_support(OneSphere(), 1, angle)
            self.assertLess(abs(least / under - 1), 0.03, angle)
            self.assertLess(abs(most / under - 1), 0.03, angle)

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
