#!/usr/bin/python3
"""A share whose server is gone hangs whoever touches it: the daemon answers, prints, cancels and ends all the same, and
nothing that lay there is lost or taken twice once it is back."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from workshop import SETTINGS, Workshop, gcode

ENDS_S = 3 + 2  # the patience with a folder, and the end of a print; a test allows tenfold
HANDS_OVER = """
[printer.objet]
profile = "objet30"
handoff_folder = "{share}"
approve = "auto"
"""


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class Case(unittest.TestCase):
    """m0's folder and the hand-over folder lie on shares; m1's does not."""

    ONLY = ""  # the one call that hangs

    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="packmerger-hanging-")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.when, self.told = self.folder / "when", self.folder / "told"
        self.share = self.folder / "share"
        self.share.mkdir()
        self.port = free_port()
        shares = [self.folder / "state/folders/m0", self.share]
        self.shop = Workshop(self, self.folder, speed="20", settings=SETTINGS + f"[web]\nport = {self.port}\n"
                             + HANDS_OVER.format(share=self.share), environment={
            "LD_PRELOAD": program.binary("libhanging_disk.so"), "HANGING_DISK": ":".join(map(str, shares)),
            "HANGING_DISK_WHEN": str(self.when), "HANGING_DISK_TOLD": str(self.told),
            "HANGING_DISK_ONLY": self.ONLY})
        self.addCleanup(lambda: self.when.unlink(missing_ok=True))

    def hang(self):
        self.when.write_text("")
        self.shop.wait_for(lambda: self.told.exists() and self.told.stat().st_size > 0)

    def web(self, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=60) as reply:
            return json.load(reply)

    def state_of(self, mark):
        return {job["name"]: job["state"] for job in self.shop.jobs()}.get(f"{mark}.gcode")

    def check_that_a_hand_over_keeps_nobody(self):
        """While objet's cube is being handed over, and hangs."""
        shop = self.shop
        shop.drop("m1", "next.gcode", gcode("next"))
        shop.wait_for(lambda: self.state_of("next") == "done")
        shop.daemon.send_signal(signal.SIGTERM)
        self.assertEqual(shop.daemon.wait(timeout=10 * ENDS_S), 0, shop.log())
        self.when.unlink()
        shop.start()
        shop.wait_for(lambda: [job["state"] for job in shop.jobs() if job["name"] == "cube.stl"] == ["handed_over"])
        self.assertEqual(len(list(self.share.glob("cube-*/job.json"))), 1)
        self.assertEqual(shop.end(), 0)


class HangingDisk(Case):
    def test_others_go_on(self):
        shop = self.shop
        shop.start()
        shop.drop("m1", "running.gcode", running := gcode("running", moves=100000))
        shop.wait_for(lambda: self.state_of("running") == "sending")
        self.hang()
        shop.drop("m0", "lost.gcode", lost := gcode("lost"))
        self.assertEqual(self.web("/api/v1/jobs")[0]["state"], "sending", "the web answers")
        number = shop.jobs()[0]["id"]
        shop.ask("jobs.cancel", id=number)
        shop.wait_for(lambda: self.state_of("running") == "cancelled")
        shop.drop("m1", "next.gcode", after := gcode("next"))
        shop.wait_for(lambda: self.state_of("next") == "done")
        shop.wait_for(lambda: all(job["filed"] for job in shop.jobs()), told=shop.jobs)
        self.assertIsNone(self.state_of("lost"))
        shop.wait_for(lambda: "does not answer" in (shop.ask("printers.list")[0]["trouble"] or ""))
        self.assertEqual(shop.log().count("does not answer"), 1, "one line in the log")
        self.when.unlink()
        shop.wait_for(lambda: self.state_of("lost") == "done")
        shop.wait_until_all_ended(3)
        shop.check({"running": running, "lost": lost, "next": after})
        self.assertIsNone(shop.ask("printers.list")[0]["trouble"])
        self.assertEqual(shop.end(), 0)

    def test_the_end_waits_for_no_share(self):
        shop = self.shop
        shop.start()
        shop.drop("m1", "running.gcode", running := gcode("running", moves=100000))
        shop.wait_for(lambda: self.state_of("running") == "sending" and shop.jobs()[0]["progress"]["done"] > 2)
        self.hang()
        shop.drop("m0", "lost.gcode", lost := gcode("lost"))
        begun = time.monotonic()
        shop.daemon.send_signal(signal.SIGTERM)
        self.assertEqual(shop.daemon.wait(timeout=10 * ENDS_S), 0, shop.log())
        self.assertLess(time.monotonic() - begun, 10 * ENDS_S)
        self.assertIn("M104 S0", shop.record("m1").read_text(), "the print was cancelled in the printer's own way")
        self.assertIn("does not answer", shop.log())
        shop.start()  # while it hangs still
        self.assertIn("the daemon was stopped while printing", shop.jobs()[0]["reason"])
        self.when.unlink()
        shop.wait_until_all_ended(2)
        jobs = shop.check({"running": running, "lost": lost})
        self.assertEqual(jobs["lost"]["state"], "done")
        self.assertEqual(shop.end(), 0)

    def test_a_hand_over_folder_keeps_nobody(self):
        shop = self.shop
        shop.start()
        self.hang()
        shop.drop("objet", "cube.stl", CUBE)
        shop.wait_for(lambda: any(job["state"] == "sending" for job in shop.jobs()))
        self.check_that_a_hand_over_keeps_nobody()


class HangsInTheMiddle(Case):
    """The server dies once the hand-over has looked at its folder."""

    ONLY = "mkdir"

    def test_a_hand_over_folder_keeps_nobody(self):
        shop = self.shop
        shop.start()
        shop.wait_for(lambda: (self.folder / "state/folders/m0").is_dir())
        self.when.write_text("")
        shop.drop("objet", "cube.stl", CUBE)
        shop.wait_for(lambda: self.told.exists() and self.told.stat().st_size > 0)
        objet = lambda: next(one for one in shop.ask("printers.list") if one["name"] == "objet")
        shop.wait_for(lambda: any(one["about"] == "handoff_folder" for one in objet()["troubles"]), told=objet)
        self.assertIn("its hand-over folder does not answer", objet()["trouble"])
        self.assertLess(abs(time.time() - objet()["troubles"][0]["since_s"]), 120)
        self.assertEqual(shop.log().count("hand-over folder does not answer"), 1, "one line in the log")
        self.check_that_a_hand_over_keeps_nobody()


def cube():
    """Twelve triangles, 10 mm a side."""
    corner = lambda i: f"{10 * (i & 1)} {5 * (i & 2)} {2.5 * (i & 4)}"
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    facets = [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]
    lines = [f"facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {corner(i)}\n" for i in t) + "endloop\nendfacet"
             for t in facets]
    return "\n".join(["solid cube", *lines, "endsolid cube", ""])


CUBE = cube()


class Stopped(unittest.TestCase):
    """Whatever verb reads a model from there: a stop is obeyed, although the read never returns."""

    def test_every_verb_that_computes_obeys(self):
        with tempfile.TemporaryDirectory(prefix="packmerger-hanging-") as holder:
            folder = pathlib.Path(holder)
            share, when, temporary = folder / "share", folder / "when", folder / "temporary"
            for each in (share, temporary):
                each.mkdir()
            (share / "cube.stl").write_text(CUBE)
            when.write_text("")
            for verb in (["prepare", share / "cube.stl", "--profile", "objet30", "--out", folder / "job"],
                         ["compare", share / "cube.stl", "--profile", "objet30"],
                         ["calibrate", "objet30", "--print", share / "cube.stl", "--took", "1h"]):
                with self.subTest(verb[0]):
                    told = folder / f"told-{verb[0]}"
                    child = subprocess.Popen(
                        [program.binary(), *verb], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                        start_new_session=True,
                        env={**os.environ, "TMPDIR": str(temporary), "LD_PRELOAD": program.binary("libhanging_disk.so"),
                             "HANGING_DISK": str(share), "HANGING_DISK_WHEN": str(when), "HANGING_DISK_TOLD": str(told),
                             "HANGING_DISK_ONLY": "read"})
                    self.addCleanup(child.kill)
                    while not (told.exists() and told.stat().st_size > 0):
                        self.assertIsNone(child.poll(), "it reads the model")
                        time.sleep(0.05)
                    started = time.monotonic()
                    child.terminate()
                    out, err = child.communicate(timeout=60)
                    self.assertLess(time.monotonic() - started, 10)
                    self.assertEqual((child.returncode, out), (130, ""), err)
                    self.assertIn("Interrupted", err)
                    self.assertFalse((folder / "job").exists())
                    self.assertEqual(list(temporary.iterdir()), [])
                    with self.assertRaises(ProcessLookupError, msg="a child still runs"):
                        os.killpg(child.pid, 0)


if __name__ == "__main__":
    unittest.main()
