#!/usr/bin/python3
"""Round plates and kept-out areas, from the setting to the program that is sliced for them."""
import json
import math
import re
import unittest

from test_command_line import FAST, CommandLine

from check_job import check

RADIUS_MM = 30
CLIP = [(0, 24), (10, 24), (10, 36), (0, 36)]
# Without the profile's priming line and its end beyond this plate.
START = "slicer.start_gcode=G28\nM104 S200\nM140 S60\nM190 S60\nM109 S200\nG92 E0"
END = "slicer.end_gcode=M104 S0\nM140 S0\nM84"
BEYOND_A_CORNER_MM = 0.05  # three digits, and chords instead of arcs


def points(corners):
    return ",".join(f"{x:.4f}x{y:.4f}" for x, y in corners)


def disc(corners=60):
    turns = [2 * math.pi * i / corners for i in range(corners)]
    return [(RADIUS_MM * (1 + math.cos(turn)), RADIUS_MM * (1 + math.sin(turn))) for turn in turns]


def extruded_to(gcode):
    """Where moves with filament end, x and y; E is relative or grows."""
    at, filament, relative = {"X": None, "Y": None}, 0.0, False
    for line in gcode.splitlines():
        code = line.split(";")[0].split()
        if not code:
            continue
        relative = {"M83": True, "M82": False}.get(code[0], relative)
        words = {word[0]: float(word[1:]) for word in code[1:] if re.fullmatch(r"[XYE]-?[\d.]+", word)}
        if code[0] == "G92":
            filament = words.get("E", filament)
        if code[0] not in ("G0", "G1"):
            continue
        moved = "X" in words or "Y" in words
        at.update({axis: words[axis] for axis in "XY" if axis in words})
        grows = "E" in words and (words["E"] > 0 if relative else words["E"] > filament)
        if "E" in words:
            filament = words["E"]
        if moved and grows:
            yield at["X"], at["Y"]


class Plates(CommandLine):
    def test_a_round_plate_with_a_clip_is_obeyed_to_the_program(self):
        result = self.prepare(
            self.torus, "--copies", "3", "--size", "18", "--no-split", "--no-hollow", "--profile", "marlin",
            "--set", f"build_mm={2 * RADIUS_MM},{2 * RADIUS_MM},80", "--set", "plate_mm=" + points(disc()),
            "--set", "keep_out_mm=" + points(CLIP), "--set", START, "--set", END, "--set", "layer_mm=0.3", *FAST)
        self.assertEqual(result.code, 0, str(result))
        job = self.folder / "job"
        self.assertEqual(check(job, [self.torus]).failures(), [])
        printer = json.loads((job / "job.json").read_text())["printer"]
        self.assertEqual((len(printer["plate_mm"]), len(printer["keep_out_mm"])), (60, 1))
        programs = sorted(job.glob("program*.gcode"))
        self.assertTrue(programs)
        for program in programs:
            gcode = program.read_text()
            bed = re.search(r"^; bed_shape = (.*)$", gcode, re.MULTILINE).group(1).split(",")
            self.assertEqual(len(bed), 60)
            places = list(extruded_to(gcode))
            self.assertGreater(len(places), 1000)
            for x, y in places:
                self.assertLess(math.hypot(x - RADIUS_MM, y - RADIUS_MM), RADIUS_MM + BEYOND_A_CORNER_MM)
                self.assertFalse(x < 10 - BEYOND_A_CORNER_MM and 24 < y < 36, (x, y))


del CommandLine  # its tests are run by its own file

if __name__ == "__main__":
    unittest.main()
