#!/usr/bin/python3
"""Many jobs through simulated printers in one run of the daemon, while a tray is packed: its memory and descriptors stay
flat and its web interface answers. PACKMERGER_JOBS: how many."""
import http.client
import os
import pathlib
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from web_daemon import free_port
from workshop import SETTINGS, Workshop, gcode

JOBS = int(os.environ.get("PACKMERGER_JOBS", 120))
PRINTERS = 4
WARM = max(JOBS // 5, 60)  # the first jobs fill what is kept at hand
ANSWER_S = 0.05  # p99; a test allows tenfold
MOST_GROWTH_BYTES = 8 << 20  # from then to all of them
MOST_WAITING = 40


def resident_bytes(pid):
    return int(pathlib.Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def printed(shop):
    """How many programs lie in the printers' done folders: the daemon is not asked, its answers to others are measured."""
    return sum(1 for name in shop.printers for _ in (shop.inbox(name) / "done").glob("*.gcode"))


class LongRun(unittest.TestCase):
    def watch(self):
        """Asks for the state again and again, and notes how long each answer took."""
        line = http.client.HTTPConnection("127.0.0.1", self.port, timeout=60)
        while not self.enough.wait(0.02):
            begun = time.monotonic()
            line.request("GET", "/api/v1/state")
            reply = line.getresponse()
            reply.read()
            self.answers_s.append(time.monotonic() - begun)
            self.assertEqual(reply.status, 200)
        line.close()

    def test_many_jobs(self):
        holder = tempfile.TemporaryDirectory(prefix="packmerger-long-")
        self.addCleanup(holder.cleanup)
        folder = pathlib.Path(holder.name)
        self.port = free_port()
        shop = Workshop(self, folder, printers=PRINTERS, settings=SETTINGS + f"""[web]
port = {self.port}
[prepare]
budget_s = 20
[printer.objet]
profile = "objet30"
handoff_folder = "{folder}"
""")
        shop.start()
        self.enough, self.answers_s = threading.Event(), []
        model = program.bunny(folder)
        if model is not None:
            shop.inbox("objet").mkdir(exist_ok=True)
            model.rename(shop.inbox("objet") / "bunny.obj")
            shop.wait_for(lambda: any(job["state"] == "preparing" for job in shop.jobs()))
        watcher = threading.Thread(target=self.watch)
        watcher.start()
        dropped, early = {}, None
        try:
            for number in range(JOBS):
                mark = f"j{number}"
                dropped[mark] = gcode(mark, moves=20)
                shop.drop(shop.printers[number % PRINTERS], f"{mark}.gcode", dropped[mark])
                shop.wait_for(lambda: number - printed(shop) < MOST_WAITING)
                if number == WARM:
                    early = resident_bytes(shop.daemon.pid), descriptors(shop.daemon.pid)
            shop.wait_for(lambda: printed(shop) >= JOBS)
        finally:
            self.enough.set()
            watcher.join()
        late = resident_bytes(shop.daemon.pid), descriptors(shop.daemon.pid)
        answers_ms = sorted(1000 * one for one in self.answers_s)
        p99_ms = answers_ms[len(answers_ms) * 99 // 100]
        print(f"{JOBS} jobs: resident {early[0] >> 10} then {late[0] >> 10} KiB, descriptors {early[1]} then {late[1]}; "
              f"{len(answers_ms)} answers, median {answers_ms[len(answers_ms) // 2]:.1f} ms, p99 {p99_ms:.1f} ms, "
              f"longest {answers_ms[-1]:.1f} ms", file=sys.stderr)
        self.assertLess(late[0] - early[0], MOST_GROWTH_BYTES)
        self.assertLessEqual(late[1], early[1] + 4)
        self.assertLess(p99_ms, 10 * 1000 * ANSWER_S)
        for job in shop.jobs():
            if job["printer"] == "objet" and job["state"] in ("received", "preparing"):
                shop.ask("jobs.cancel", id=job["id"])
        self.assertTrue(all(shop.times_printed().get(f"M117 end {mark}") == 1 for mark in dropped))
        self.assertEqual(shop.end(), 0)


if __name__ == "__main__":
    unittest.main()
