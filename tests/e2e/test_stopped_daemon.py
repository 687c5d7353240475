#!/usr/bin/python3
"""SIGTERM to a daemon whose printer cannot be cancelled as usual: it ends in bounded time, and the printer's heaters were
told to go off, or people are told that they may be on."""
import pathlib
import re
import tempfile
import time
import unittest

import workshop
from stuck_printer import StuckPrinter

BOUND_S = 60  # a cancel is given up after a minute; the service waits for three


class StoppedDaemon(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def print_on(self, port, lines):
        """A daemon that prints them there, with two seconds of patience."""
        settings = workshop.SETTINGS + workshop.PRINTER.format(name="p", profile=self.folder / "p.toml", port=port)
        shop = workshop.Workshop(self, self.folder, printers=0, settings=settings)
        profile = (self.folder / "fast.toml").read_text()
        (self.folder / "p.toml").write_text(re.sub(r"(?m)^timeout_s = \d+", "timeout_s = 2", profile))
        shop.start()
        shop.drop("p", "a.gcode", "".join(f"{line}\n" for line in lines))
        return shop

    def stop(self, shop):
        """What the next daemon says of the only job."""
        begun = time.monotonic()
        self.assertEqual(shop.end(), 0)
        self.assertLess(time.monotonic() - begun, BOUND_S)
        shop.start()
        (job,) = shop.jobs()
        self.assertEqual(job["state"], "failed")
        self.assertIn("the daemon was stopped while printing", job["reason"])
        return job

    def test_a_printer_that_answers_nothing(self):
        printer = StuckPrinter(self)
        shop = self.print_on(printer.name, ["G28", "M140 S60", "M190 S60", "G1 X10 F600"])
        shop.wait_for(lambda: b"M190" in printer.heard)
        self.expect_doubt(self.stop(shop), printer)

    def test_one_that_answers_nothing_to_a_person_either(self):
        printer = StuckPrinter(self)
        shop = self.print_on(printer.name, ["G28", "M140 S60", "M190 S60", "G1 X10 F600"])
        shop.wait_for(lambda: b"M190" in printer.heard)
        shop.ask("jobs.cancel", id=1)
        shop.wait_for(lambda: shop.jobs()[0]["state"] == "cancelled", BOUND_S)
        self.expect_doubt(shop.jobs()[0], printer)

    def expect_doubt(self, job, printer):
        self.assertIn("it is not certain that the printer obeyed", job["reason"])
        self.assertIn("heaters may be on", job["hint"])
        self.assertIn(b"\nM104 S0\nM140 S0\n", printer.heard, "the safe text, without numbers")

    def test_a_filament_change_that_asks_twice(self):
        record = self.folder / "record.txt"
        printer = workshop.program.Background(self, "packmerger", "simulate", "marlin", "--record", record,
                                              log=self.folder / "printer.log")
        shop = self.print_on(printer.child.stdout.readline().strip(), ["G28", "M600", "G1 X10 F600"])
        shop.wait_for(lambda: [job["state"] for job in shop.jobs()] == ["ready"])  # nobody knows where M600 goes
        shop.ask("jobs.approve", id=1)
        shop.wait_for(lambda: "Nozzle Parked" in str(shop.jobs()))
        job = self.stop(shop)
        self.assertNotIn("obeyed", job["reason"])
        executed = record.read_text().splitlines()
        self.assertIn("M140 S0", executed, "both questions were answered")
        self.assertNotIn("G1 X10 F600", executed)


if __name__ == "__main__":
    unittest.main()
