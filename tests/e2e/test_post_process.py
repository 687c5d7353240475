#!/usr/bin/python3
"""No program is run that a model, a program or a setting names."""
import json
import pathlib
import sys
import unittest
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
import test_programs


class RunsNoPrograms(test_programs.Prepared):
    """A slicer runs what `post_process` names: nothing that somebody gives may bring one there."""

    def setUp(self):
        super().setUp()
        self.mark = self.folder / "it-ran"
        self.touch = f"/usr/bin/touch {self.mark}"
        self.cube = self.folder / "cube.3mf"
        corners = [(x, y, z) for z in (0, 20) for y in (0, 20) for x in (0, 20)]
        faces = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6),
                 (0, 6, 2), (1, 3, 7), (1, 7, 5)]
        mesh = "".join([*(f'<vertex x="{x}" y="{y}" z="{z}"/>' for x, y, z in corners), "</vertices><triangles>",
                        *(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)])
        with zipfile.ZipFile(self.cube, "w") as archive:
            archive.writestr("3D/3dmodel.model", f'<model><resources><object id="1"><mesh><vertices>{mesh}</triangles>'
                             '</mesh></object></resources><build><item objectid="1"/></build></model>')
            archive.writestr("Metadata/Slic3r_PE.config", f"; post_process = {self.touch}\n; perimeters = 3\n")
            archive.writestr("Metadata/project_settings.config", json.dumps({"post_process": [self.touch]}))

    def run_on_cube(self, verb, profile, *options):
        out = ("--out", self.folder / "job") if verb == "prepare" else ()
        return program.run(verb, self.cube, "--profile", profile, "--no-split", *out, *options)

    def test_in_a_program_it_is_a_comment(self):
        data = test_programs.gcode(f"; post_process = {self.touch}", f"; post_process = \"{self.touch}\"")
        result = self.prepare(data, "marlin", "--json")
        self.assertEqual(result.code, 0, str(result))
        self.assertEqual((self.folder / "job/program.gcode").read_bytes(), data)
        self.assertEqual(json.loads(result.out)["warnings"], [])
        self.assertFalse(self.mark.exists())

    def test_settings_that_name_one_are_refused(self):
        option = ("--set", f"slicer.options.post_process={self.touch}")
        own = self.folder / "own.toml"
        own.write_text(f'base = "marlin"\nname = "Own"\n[slicer.options]\npost_process = "{self.touch}"\n')
        for verb, profile, options in (("prepare", "marlin", option), ("compare", "replicator", option),
                                       ("prepare", own, ())):
            result = self.run_on_cube(verb, profile, *options)
            self.assertNotEqual(result.code, 0, f"{verb} {profile}: {result}")
            self.assertIn("slicer.options.post_process would run other programs", result.err)
            self.assertFalse(self.mark.exists() or (self.folder / "job").exists())

    def test_what_a_3mf_says_never_reaches_the_slicer(self):
        result = self.run_on_cube("prepare", "marlin", "--variant", "solid")
        self.assertEqual(result.code, 0, str(result))
        written = (self.folder / "job/program.gcode").read_text()
        self.assertIn(written.split("; post_process = ")[1].split("\n")[0], ("", '""'))
        self.assertNotIn(str(self.mark), written)
        self.assertFalse(self.mark.exists())


if __name__ == "__main__":
    unittest.main()
