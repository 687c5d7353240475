#!/usr/bin/python3
"""A job prepared for a USB printer and sent to one that umockdev plays, as a user does it."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import stl
from shapes import sphere

BED = pathlib.Path(program.binary()).parent / "usb-bed"
ADDRESS = "usb:0525:a4a8:B-1"


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
                             "--set", "link.device_id=print bridge", "--set", "link.timeout_s=2")
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
        self.assertEqual((device["usb_id"], device["serial_number"], device["is_printer"]), ("0525:a4a8", "B-1", True))


if __name__ == "__main__":
    unittest.main()
