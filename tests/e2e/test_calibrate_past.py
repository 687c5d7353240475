#!/usr/bin/python3
"""`packmerger calibrate` asks a daemon with a long past for all of it."""
import json
import pathlib
import re
import socket
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program


class TellsItsJobs(threading.Thread):
    """Stands in for a daemon with a long past: as many jobs as told, one request a connection or many."""

    def __init__(self, path, jobs):
        super().__init__(daemon=True)
        self.jobs = jobs
        self.requests = []
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(str(path))
        self.listener.listen()
        self.start()

    def run(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            with client, client.makefile("rw") as lines:
                for line in lines:
                    request = json.loads(line)
                    self.requests.append(request)
                    older = [job for job in self.jobs if job["id"] < request.get("before", 1 << 40)]
                    lines.write(json.dumps({"ok": True, "result": older[:request["limit"]]}) + "\n")
                    lines.flush()


class SeenLongAgo(unittest.TestCase):
    def seen(self, count, printed):
        """The requests, and the jobs that were fitted, of a daemon with so many jobs."""
        folder = tempfile.TemporaryDirectory(prefix="packmerger-calibrate-")
        self.addCleanup(folder.cleanup)
        folder = pathlib.Path(folder.name)
        (folder / "part.gcode").write_text("G28\nG90\nG1 X100 F6000\nM84\n")
        made = program.run("prepare", folder / "part.gcode", "--profile", "marlin", "--out", folder / "job")
        self.assertEqual(made.code, 0, str(made))
        jobs = [{"id": number, "name": f"part{number}.gcode", "printer": "m0", "profile": "marlin", "folder": str(folder / "job"),
                 "state": "done" if number in printed else "cancelled", "printed_s": 60.0 if number in printed else None,
                 "paused_s": None} for number in range(count, 0, -1)]
        daemon = TellsItsJobs(folder / "daemon.sock", jobs)
        self.addCleanup(daemon.listener.close)
        result = program.run("calibrate", "marlin", "--socket", folder / "daemon.sock", "--json")
        self.assertEqual(result.code, 0, str(result))
        prints = json.loads(result.out)["quantities"]["time"]["prints"]
        return daemon.requests, [int(re.search(r"job (\d+) ", one["print"]).group(1)) for one in prints]

    def test_every_finished_print_counts_however_old(self):
        requests, prints = self.seen(2345, printed={1, 345, 346, 1345, 1346, 2345})
        self.assertEqual(prints, [2345, 1346, 1345, 346, 345, 1])
        self.assertEqual([request.get("before") for request in requests], [None, 1346, 346])

    def test_a_last_page_that_is_full(self):
        requests, prints = self.seen(2000, printed={1, 2000})
        self.assertEqual(prints, [2000, 1])
        self.assertEqual([request.get("before") for request in requests], [None, 1001, 1])


if __name__ == "__main__":
    unittest.main()
