#!/usr/bin/python3
"""The daemon under the unit's own filter of system calls, which the kernel enforces: it starts, prepares a model, has a
program sliced and printed, hands a tray over and ends; a call that is not allowed kills whoever makes it."""
import ctypes.util
import os
import pathlib
import shutil
import sys
import tempfile
import time
import unittest

import program
import unit_calls
from bad_inputs import stl
from shapes import torus
from workshop import ENDED, PRINTER, SETTINGS, Workshop

HERE = pathlib.Path(__file__).resolve().parent
UNIT = program.SOURCE / "src" / "install" / "packmergerd.service"
OTHERS = """
[printer.lab]
profile = "objet30"
handoff_folder = "out"
approve = "auto"
"""


class Filtered(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-filter-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "out").mkdir()

    def under(self, names):
        if os.geteuid() == 0:
            names = names | {"fchown"}  # SQLite calls it as root alone, and the unit's user is not
        return [sys.executable, "-B", HERE / "under_filter.py", ",".join(sorted(names))]

    def wait_for(self, holds, shop):
        end = time.monotonic() + 240
        while not holds():
            self.assertLess(time.monotonic(), end, shop.log())
            time.sleep(0.1)

    def test_all_that_daemon_and_children_do_is_allowed(self):
        shop = Workshop(self, self.folder, printers=1, settings=SETTINGS + OTHERS)
        self.assertIsNotNone(shop.start(prefix=self.under(unit_calls.allowed(UNIT.read_text()))), shop.log())
        for name in ("lab", "m0"):
            self.wait_for(lambda name=name: shop.inbox(name).is_dir(), shop)
            (shop.inbox(name) / "ring.stl").write_bytes(stl(torus(20, 6, 24, 12)))
        self.wait_for(lambda: [job["state"] in (*ENDED, "handed_over") for job in shop.jobs()] == [True, True], shop)
        self.assertEqual({(job["printer"], job["state"]) for job in shop.jobs()}, {("lab", "handed_over"), ("m0", "done")},
                         shop.log())
        self.assertEqual(shop.end(), 0, shop.log())

    def test_the_filter_is_enforced(self):
        shop = Workshop(self, self.folder, printers=0, settings=SETTINGS)
        names = unit_calls.allowed(UNIT.read_text()) - {"signalfd4"}
        started = shop.start(prefix=self.under(names))
        self.assertIsNone(started, "a daemon that hears no signals")


if __name__ == "__main__":
    if not shutil.which("systemd-analyze") or not ctypes.util.find_library("seccomp"):
        print("skipped: systemd-analyze or libseccomp2 is not here", file=sys.stderr)
        sys.exit(program.SKIPPED)
    unittest.main()
