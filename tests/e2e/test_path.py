#!/usr/bin/python3
"""The whole path with the real programs: a file dropped in a watched folder ends as a recorded print; `send`
without the daemon; the variants; and tray.3mf in somebody else's program."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import stl
from check_job import check
from shapes import sphere

FAST = ("--set", "tabu_patience=1", "--set", "tabu_samples=2")
PATIENCE_S = 400
BOX = ("min_x", "min_y", "min_z", "max_x", "max_y", "max_z")


class Path(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-path-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.ball = self.folder / "ball.stl"
        self.ball.write_bytes(stl(sphere(radius=12)))

    def simulated(self, profile):
        """A simulated printer's port and the file of what it executes."""
        record = self.folder / f"{profile}.txt"
        printer = program.Background(self, "packmerger", "simulate", profile, "--speed", "inf", "--record", record,
                                     log=self.folder / "simulator.log")
        return printer.child.stdout.readline().strip(), record

    def wait_for(self, holds):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if holds():
                return
            time.sleep(0.2)
        self.fail("it did not happen")

    def prepare(self, *arguments, out="job"):
        result = program.run("prepare", self.ball, "--out", self.folder / out, *FAST, *arguments)
        self.assertEqual(result.code, 0, str(result))
        return self.told(out)

    def told(self, out):
        return json.loads((self.folder / out / "job.json").read_text())

    def test_from_a_watched_folder_to_a_recorded_print(self):
        port, record = self.simulated("replicator")
        config = self.folder / "packmergerd.toml"
        config.write_text(f"""
state = "state"
[printer.maker]
profile = "replicator"
port = "{port}"
folder = "drop"
simulated = true
approve = "ask"
set = ["tabu_patience=1", "tabu_samples=2"]
""")
        (self.folder / "drop").mkdir()
        daemon = program.Background(self, "packmergerd", "--config", config, log=self.folder / "daemon.log")
        socket = ("--socket", self.folder / "state" / "packmergerd.sock")
        self.wait_for(lambda: program.run("printers", "list", *socket).code == 0)
        (self.folder / "drop" / "ball.stl").write_bytes(self.ball.read_bytes())

        def job():
            told = program.run("jobs", "show", "1", "--json", *socket)
            return json.loads(told.out) if told.code == 0 else {"state": "none"}

        def reached(state):
            now = job()
            self.assertNotIn(now["state"], ("failed", "cancelled"), now.get("reason"))
            return now["state"] == state

        self.wait_for(lambda: reached("ready"))
        prepared = pathlib.Path(job()["folder"])
        self.assertEqual(check(prepared, [self.ball]).failures(), [])
        self.assertEqual(program.run("jobs", "approve", "1", *socket).code, 0)
        self.wait_for(lambda: reached("done"))
        self.assertEqual(pathlib.Path(job()["filed"]).read_bytes(), self.ball.read_bytes(), "the model is kept")
        self.assertEqual(program.files_below(self.folder / "drop" / "failed"), [])
        # one executed action a line, in hex
        self.wait_for(lambda: re.search("^9a", record.read_text(), re.MULTILINE))
        self.assertEqual(bytes.fromhex(record.read_text()), (prepared / "program.x3g").read_bytes())
        self.assertEqual(daemon.end(), 0, "SIGTERM ends it cleanly")

    def test_send_without_the_daemon(self):
        port, record = self.simulated("marlin")
        self.prepare("--profile", "marlin", "--no-split", "--variant", "solid")
        result = program.run("send", self.folder / "job", "--port", port)
        self.assertEqual(result.code, 0, str(result))
        lines = (self.folder / "job" / "program.gcode").read_text().splitlines()
        meant = [text for text in (line.split(";")[0].strip() for line in lines) if text]
        executed = record.read_text().splitlines()
        start = executed.index(meant[0])
        own = {"M105", "M115", "M110", "M114", "M155", "M27", "M400"}  # what a link asks by itself
        self.assertEqual([line for line in executed[start:] if line.split()[0] not in own],
                         [line for line in meant if line.split()[0] not in own])

    def test_variants(self):
        for variant in ("solid", "hollow", "cheapest"):
            told = self.prepare("--profile", "objet30", "--variant", variant, out=variant)
            self.assertEqual(check(self.folder / variant, [self.ball]).failures(), [], variant)
            costs = {way: told["estimates"][way]["cost"] for way in ("packed", "hollow", "solid")}
            if variant == "cheapest":
                self.assertEqual(costs[told["variant"]], min(costs.values()))
            else:
                self.assertEqual((told["variant"], len(told["parts"])), (variant, 1))
                codes = [warning["code"] for warning in told["warnings"]]
                self.assertEqual("sealed_cavity" in codes, variant == "hollow", "only a hollow ball in one piece traps support")

        # a known comparison is not made again, and nothing of the folder is another for that
        for variant, known, more in (("solid", "hollow", ()), ("hollow", "solid", ()),
                                     ("packed", "whole", ("--no-split",))):
            if more:
                for name, way in (("whole", "solid"), ("packed", "packed")):
                    self.prepare("--profile", "objet30", "--variant", way, *more, out=name)
            again = self.prepare("--profile", "objet30", "--variant", variant, *more,
                                 "--compared", self.folder / known, out=f"{variant}-again")
            self.assertIn("arrange", again["timings_s"], "it was compared once more")
            self.assertEqual(self.content(variant), self.content(f"{variant}-again"), variant)

    def test_another_build_compares_anew(self):
        here = self.folder / "bin"
        here.mkdir()
        for name in ("packmerger", "packmerger-tetgen"):
            shutil.copy(program.binary(name), here)
        profile = ("--profile", program.SOURCE / "profiles" / "objet30.toml", "--no-split", "--variant", "solid")
        with unittest.mock.patch.dict(os.environ, PACKMERGER_BIN=str(here)):
            self.prepare(*profile, out="first")
            self.prepare(*profile, "--compared", self.folder / "first", out="same")
            with open(here / "packmerger-tetgen", "ab") as helper:
                helper.write(b"another build")
            self.prepare(*profile, "--compared", self.folder / "same", out="helped")
            with open(here / "packmerger", "ab") as own:
                own.write(b"another build")
            self.prepare(*profile, "--compared", self.folder / "helped", out="own")
        stages = {out: [stage for stage in ("arrange", "estimate") if stage in self.told(out)["timings_s"]]
                  for out in ("same", "helped", "own")}
        self.assertEqual(stages, {"same": ["arrange"], "helped": ["estimate"], "own": ["estimate"]})

    def content(self, out):
        """The bytes of a job folder's files, times left out."""
        content = {path.relative_to(self.folder / out): path.read_bytes()
                   for path in (self.folder / out).rglob("*") if path.is_file()}
        told = json.loads(content.pop(pathlib.Path("job.json")))
        self.assertGreater(len(told.pop("timings_s")), 2)
        return content, told

    def test_another_program_finds_the_parts_in_place(self):
        told = self.prepare("--profile", "objet30")
        self.assertGreater(len(told["parts"]), 1, "or there is nothing to be put in place")
        self.assertNotIn("sealed_cavity", [warning["code"] for warning in told["warnings"]], "it is cut open")
        shown = {}
        for name in ("tray.3mf", "tray.stl"):
            done = subprocess.run(["prusa-slicer", "--info", self.folder / "job" / name], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(set(re.findall(r"^manifold = (\S+)$", done.stdout, re.MULTILINE)), {"yes"})
            # one section an object
            figures = {key: [float(value) for value in re.findall(rf"^{key} = (\S+)$", done.stdout, re.MULTILINE)]
                       for key in ("volume", *BOX)}
            shown[name] = {key: min(values) if key in BOX[:3] else max(values) if key in BOX else sum(values)
                           for key, values in figures.items()}
            if name == "tray.3mf":
                self.assertEqual(len(figures["volume"]), len(told["parts"]))
        for key, value in shown["tray.stl"].items():
            self.assertAlmostEqual(shown["tray.3mf"][key], value, delta=1e-3 * max(1, abs(value)), msg=key)


if __name__ == "__main__":
    unittest.main()
