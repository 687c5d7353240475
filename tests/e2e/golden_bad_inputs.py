#!/usr/bin/python3
"""Broken, empty, truncated, non-finite and huge inputs: the right exit code, an error and a hint, nothing left
behind, and no unbounded memory."""
import os
import pathlib
import pwd
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import BAD, CASES, NONE, stl
from shapes import sphere

PEAK_BYTES = 3 << 29


class BadInputs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-bad-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.out = self.folder / "out"
        self.temporary = self.folder / "tmp"
        self.out.mkdir()
        self.temporary.mkdir()

    def refuse(self, model, codes, *options, profile="objet30", out=None, prefix=()):
        """Prepares, and expects an orderly refusal."""
        result = program.run("prepare", model, "--profile", profile, "--out", out or self.out / "job", *options,
                             limited=True, timeout=110, temporary=self.temporary, prefix=prefix)
        self.assertIn(result.code, codes, str(result))
        lines = result.err.splitlines()
        errors = [line for line in lines if line.startswith("error: ")]
        hints = [line for line in lines if line.startswith("hint: ")]
        self.assertEqual((len(errors), len(hints)), (1, 1), str(result))
        self.assertGreater(len(hints[0]), len("hint: ") + 5, str(result))
        self.assertEqual(result.out, "", "data on stdout though it failed")
        self.assertEqual(program.files_below(self.out), [], "left beside the job folder")
        self.assertEqual(program.files_below(self.temporary), [], "left among the temporary files")
        if not os.environ.get("PACKMERGER_SANITIZED"):
            self.assertLess(result.peak_bytes, PEAK_BYTES, str(result))
        return result

    def sphere(self):
        path = self.folder / "sphere.stl"
        path.write_bytes(stl(sphere()))
        return path

    def test_missing_file(self):
        result = self.refuse(self.folder / "nothing.stl", NONE)
        self.assertIn("nothing.stl", result.err)

    def test_directory(self):
        (self.folder / "folder.stl").mkdir()
        self.refuse(self.folder / "folder.stl", BAD | NONE)

    def test_device_without_end(self):
        self.refuse("/dev/zero", BAD | NONE)

    def test_pipe_without_writer(self):
        os.mkfifo(self.folder / "pipe.stl")
        self.refuse(self.folder / "pipe.stl", BAD | NONE)

    def test_unreadable_file(self):
        path = self.sphere()
        path.chmod(0)
        prefix = ()
        if os.geteuid() == 0:  # root reads everything
            nobody = pwd.getpwnam("nobody")
            prefix = ("setpriv", f"--reuid={nobody.pw_uid}", f"--regid={nobody.pw_gid}", "--clear-groups")
            for folder in (self.folder, self.out, self.temporary):
                os.chown(folder, nobody.pw_uid, nobody.pw_gid)
            if program.run("--version", prefix=prefix).code != 0:
                self.skipTest("the program lies where only root can run it")
        self.refuse(path, {66, 74}, prefix=prefix)

    def test_one_bad_model_of_two(self):
        (self.folder / "bad.stl").write_bytes(b"")
        result = program.run("prepare", self.sphere(), self.folder / "bad.stl", "--profile", "objet30", "--out",
                             self.out / "job", limited=True)
        self.assertEqual(result.code, 65, str(result))
        self.assertIn("bad.stl", result.err)
        self.assertEqual(program.files_below(self.out), [])

    def test_nothing_fits_any_tray(self):
        self.refuse(self.sphere(), BAD, "--no-split", "--set", "build_mm=5,5,5")

    def test_out_cannot_be_made(self):
        self.refuse(self.sphere(), {73}, "--no-split", out="/proc/packmerger/job")

    def test_out_is_there_already(self):
        (self.folder / "kept").mkdir()
        (self.folder / "kept" / "mine.txt").write_text("mine")
        self.refuse(self.sphere(), {2, 73}, "--no-split", out=self.folder / "kept")
        self.assertEqual(program.files_below(self.folder / "kept"), ["mine.txt"])


def _add_case(name, file, data, codes):
    def test(self):
        path = self.folder / file
        path.write_bytes(data() if callable(data) else data)
        self.refuse(path, codes)
    setattr(BadInputs, "test_" + name.replace(" ", "_"), test)


for _name, (_file, _data, _codes) in CASES.items():
    _add_case(_name, _file, _data, _codes)

if __name__ == "__main__":
    unittest.main()
