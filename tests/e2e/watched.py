"""packmergerd with watched folders, as a test's fixture."""
import json
import pathlib
import tempfile
import time
import unittest

import program


class Watched(unittest.TestCase):
    patience_s = 60

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-watched-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.drops = self.folder / "state/folders"
        (self.folder / "out").mkdir()

    def start(self, printers, last):
        """printers: settings; last: the printer whose folder is made last."""
        (self.folder / "d.toml").write_text(
            f'state = "state"\n[watch]\nstill_s = 0.3\nrescan_s = 0.2\ngive_up_s = 1\n{printers}')
        program.Background(self, "packmergerd", "--config", self.folder / "d.toml", log=self.folder / "daemon.log")
        self.wait_for(lambda: (self.drops / last).is_dir() and self.ask("printers", "list").code == 0)

    def ask(self, *arguments):
        return program.run(*arguments, "--socket", self.folder / "state/packmergerd.sock")

    def job(self, number):
        shown = self.ask("jobs", "show", number, "--json")
        return json.loads(shown.out) if shown.code == 0 else {"state": "none"}

    def wait_for(self, holds):
        end = time.monotonic() + self.patience_s
        while not holds():
            self.assertLess(time.monotonic(), end, (self.folder / "daemon.log").read_text()[-2000:])
            time.sleep(0.05)
