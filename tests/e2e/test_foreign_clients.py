#!/usr/bin/python3
"""Clients that nobody here wrote print to the simulated printers, which are thereby honest. gpx prints to the
simulated Replicator in tests/sim/test_terminals.cpp; here it is printcore and the Marlins."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program

COMMANDS = ["M104 S199", "M190 S30", "M109 S200", "G28", "G92 E0", "M117 the * of a message",
            *(f"G1 X{i % 40}.5 Y{i % 7} E{i / 50:.2f} F6000" for i in range(800)), "M104 S0", "M84"]
ASKED_BY_PRINTCORE = {"M105", "M110"}


class Printcore(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-clients-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def prints(self, firmware, speed):
        record, gcode = self.folder / "record.txt", self.folder / "job.gcode"
        gcode.write_text("; a program\n\n" + "".join(f"{command} ; a comment\n" for command in COMMANDS))
        printer = program.Background(self, "packmerger", "simulate", "marlin", "--firmware", firmware,
                                     "--speed", speed, "--record", record, log=self.folder / "simulator.log")
        port = printer.child.stdout.readline().strip()
        done = subprocess.run(["printcore", port, gcode], capture_output=True, text=True, timeout=100)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        executed = record.read_text().splitlines()
        self.assertEqual([line for line in executed if line not in ASKED_BY_PRINTCORE], COMMANDS)

    def test_marlin_2_1(self):
        self.prints("marlin-2.1", speed=100)

    def test_marlin_1_1(self):
        self.prints("marlin-1.1", speed=100)


if __name__ == "__main__":
    unittest.main()
