#!/usr/bin/python3
"""A job prepared for a USB printer and sent to one that umockdev plays, as a user does it."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import stl
from shapes import sphere

BED = pathlib.Path(program.binary()).parent / "usb-bed"
ADDRESS = "usb:0525:a4a8:B-1"
PATIENCE_S = 60


class UsbPrinter(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="packmerger-usb-")
        cls.folder = pathlib.Path(cls.temporary.name)
        model = cls.folder / "ball.stl"
        model.write_bytes(stl(sphere()))
        cls.job = cls.folder / "job"
        result = program.run("prepare", model, "--profile", "objet30", "--no-split", "--no-hollow", "--out", cls.job,
                             "--set", "dialect=usb", "--set", "document=tray_3mf", "--set", "link.usb_ids=0525:a4a8",
                             "--set", "link.machine=print bridge", "--set", "link.timeout_s=5")
        assert result.code == 0, result
        cls.document = (cls.job / "tray.3mf").read_bytes()

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def beside_a_printer(self, *command, faults=()):
        """The finished process, the bytes that the printer was given, and what else happened to it."""
        record = self.folder / "record"
        result = subprocess.run(["umockdev-wrapper", BED, "--record", record, *faults, "--", *command],
                                capture_output=True, text=True, timeout=60, stdin=subprocess.DEVNULL)
        return result, record.read_bytes(), pathlib.Path(f"{record}.events").read_text().splitlines()

    def send(self, *arguments, faults=()):
        return self.beside_a_printer(program.binary(), "send", self.job, *arguments, faults=faults)

    def test_sends_the_document_to_the_one_printer_that_is_there(self):
        result, received, events = self.send("--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(json.loads(result.stdout), {"state": "done", "tray": 1, "trays": 1, "port": ADDRESS})
        self.assertEqual(received, self.document)
        self.assertEqual(events[-1], "attach usblp", "the kernel's driver is back")

    def test_a_printer_without_a_serial_number(self):
        result, received, _ = self.send("--json", faults=["--serial", ""])
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual((json.loads(result.stdout)["port"], received), ("usb:0525:a4a8", self.document))

    def test_faults_that_pass_cost_no_byte(self):
        for faults in (["--stall-at", "700"], ["--silent-at", "1"], ["--empty-for", "3"]):
            result, received, _ = self.send("--port", ADDRESS, faults=faults)
            self.assertEqual(result.returncode, 0, (faults, result.stderr))
            self.assertEqual(received, self.document, faults)

    def test_unplugged(self):
        result, received, _ = self.send(faults=["--unplug-at", "700"])
        self.assertEqual(result.returncode, 74, result.stderr)
        self.assertIn("is gone", result.stderr)
        self.assertEqual(received, self.document[:700])

    def test_busy_absent_and_never_ready(self):
        for faults, code, cause in ((["--busy"], 75, "held by another program"), (["--starts-unplugged"], 69, "is there"),
                                    (["--empty-for", "1000"], 69, "out of paper or material")):
            result, received, _ = self.send(faults=faults)
            self.assertEqual((result.returncode, received), (code, b""), (faults, result.stderr))
            self.assertIn(cause, result.stderr)
        result, received, _ = self.send("--port", "usb:0525:a4a8:other")
        self.assertEqual((result.returncode, received), (69, b""), result.stderr)

    def test_devices_marks_it(self):
        result, _, _ = self.beside_a_printer(program.binary(), "devices", "--json", "--socket", self.folder / "none")
        [device] = json.loads(result.stdout)["usb"]
        self.assertEqual((device["address"], device["serial_number"], device["is_printer"]), (ADDRESS, "B-1", True))
        result, _, _ = self.beside_a_printer(program.binary(), "devices", "--socket", self.folder / "none")
        self.assertIn(f"1-1 stays {ADDRESS}\n", result.stdout)


class Daemon(unittest.TestCase):
    """packmergerd, beside a printer that comes and goes."""

    CONFIG = """state = "state"
retry_s = 20
[watch]
still_s = 0.1
[printer.bridge]
profile = "objet30"
set = ["dialect=usb", "link.machine=Acme"]
port = "usb:0525:a4a8:B-1"
simulated = true
split = false
hollow = false
variant = "solid"
"""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="packmerger-usb-")
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "d.toml").write_text(self.CONFIG)

    def start(self, *faults):
        self.log = open(self.folder / "log", "wb")
        self.addCleanup(self.log.close)
        self.bed = subprocess.Popen(
            ["umockdev-wrapper", BED, "--record", self.folder / "record", *faults, "--",
             program.binary("packmergerd"), "--config", self.folder / "d.toml"],
            stdin=subprocess.PIPE, stdout=self.log, stderr=self.log)
        self.addCleanup(self.bed.stdin.close)
        self.addCleanup(self.bed.wait, timeout=60)
        self.addCleanup(self.order, "end")

    def order(self, word):
        if self.bed.poll() is None:
            self.bed.stdin.write(f"{word}\n".encode())
            self.bed.stdin.flush()

    def ask(self, *arguments):
        result = program.run(*arguments, "--json", "--socket", self.folder / "state" / "packmergerd.sock")
        return json.loads(result.out) if result.code == 0 else None

    def connected(self):
        printers = self.ask("printers", "list")
        return printers and printers[0]["connected"]

    def job(self, number):
        return self.ask("jobs", "show", number) or {"state": "none", "waits_for": None}

    def wait_until(self, holds):
        end = time.monotonic() + PATIENCE_S
        while not holds():
            self.assertLess(time.monotonic(), end, (self.folder / "log").read_text())
            time.sleep(0.3)

    def drop(self, name):
        whole = self.folder / "state" / "folders" / "bridge" / name
        partial = whole.with_name(name + ".part")
        partial.write_bytes(stl(sphere()))
        os.rename(partial, whole)

    def approve(self, number):
        self.wait_until(lambda: self.job(number)["state"] == "ready")
        self.ask("jobs", "approve", number)

    def finish(self):
        """What the printer was given in all, once the daemon has ended."""
        self.order("end")
        self.assertEqual(self.bed.wait(timeout=60), 0, (self.folder / "log").read_text())
        return (self.folder / "record").read_bytes()

    def document(self, number):
        return (pathlib.Path(self.job(number)["folder"]) / "tray.stl").read_bytes()

    def test_a_job_starts_when_its_printer_is_connected(self):
        self.start("--starts-unplugged")
        self.wait_until(lambda: self.connected() is False)
        self.drop("ball.stl")
        self.approve(1)
        self.wait_until(lambda: self.job(1)["waits_for"] == "not_connected")
        self.order("plug")
        self.wait_until(lambda: self.job(1)["state"] == "done")
        self.assertIs(self.connected(), True)
        self.order("unplug")
        self.wait_until(lambda: self.connected() is False)
        document = self.document(1)
        self.assertEqual(self.finish(), document)

    def test_unplugged_in_a_job_the_next_one_runs_when_it_is_back(self):
        self.start("--unplug-at", "700")
        self.wait_until(self.connected)
        self.drop("lost.stl")
        self.approve(1)
        self.wait_until(lambda: self.job(1)["state"] == "failed")
        self.assertIn("is gone", self.job(1)["reason"])
        self.order("unplug")
        self.wait_until(lambda: self.connected() is False)
        self.drop("next.stl")
        self.approve(2)
        self.wait_until(lambda: self.job(2)["waits_for"] == "not_connected")
        self.order("plug")
        self.wait_until(lambda: self.job(2)["state"] == "done")
        document = self.document(2)
        self.assertEqual(self.finish(), document[:700] + document)


if __name__ == "__main__":
    unittest.main()
