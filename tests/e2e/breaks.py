"""Ways to break a good job folder, each with the check that has to find it."""
import json

import numpy as np

import synthetic
from checker import meshes


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
    "off the plate": (set_at("printer", "plate_mm", value=[[0, 0], [100, 0], [0, 30]]), "stands on the plate"),
    "over a kept-out area": (set_at("printer", "keep_out_mm", value=[[[0, 22], [100, 22], [100, 23]]]),
                             "over no kept-out area"),
    "over an area inside one triangle": (set_at("printer", "keep_out_mm",
                                                value=[[[20, 20], [20.1, 20], [20.1, 20.1], [20, 20.1]]]),
                                         "over no kept-out area"),
    "on the floor of a bed of powder": (set_at("settings", "technology", value="powder"), "to the walls of the bed"),
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
    "profile.toml is not the one used": (set_at("profile", "sha256", value="b" * 64), "sha256 of profile"),
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
