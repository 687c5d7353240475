#!/usr/bin/python3
"""Nothing is lost and nothing printed twice: the daemon is killed at random moments, its disk fills and breaks, clocks jump.
PACKMERGER_KILLS and PACKMERGER_DISK_FAULTS make the series longer, PACKMERGER_SEED another."""
import contextlib
import errno
import os
import pathlib
import random
import sqlite3
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from workshop import Workshop, gcode

KILLS = int(os.environ.get("PACKMERGER_KILLS", 15))
DISK_FAULTS = int(os.environ.get("PACKMERGER_DISK_FAULTS", 10))
SEED = int(os.environ.get("PACKMERGER_SEED", 1))
DAY_S = 86400
READY_S = 2  # after a kill; a test allows tenfold
FAILING_DISK = program.binary("libfailing_disk.so")


class Case(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="packmerger-safe-")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.random = random.Random(SEED)
        print(f"seed {SEED}", file=sys.stderr)


class Kills(Case):
    def test_killed_at_random_moments(self):
        shop = Workshop(self, self.folder, speed=300)
        dropped, ready_s = {}, []
        for number in range(KILLS):
            ready_s.append(shop.start())
            self.assertIsNotNone(ready_s[-1], shop.log())
            for i in range(self.random.randrange(3)):
                name = f"k{number}-{i}.gcode"
                dropped[name] = gcode(name, moves=self.random.randrange(1, 200))
                shop.drop(self.random.choice(shop.printers), name, dropped[name])
            time.sleep(self.random.random() ** 2)
            shop.kill()
        shop.start()
        shop.wait_until_all_ended(len(dropped))
        jobs = shop.check(dropped)
        self.assertEqual(shop.left_in_inboxes(), [])
        states = [job["state"] for job in jobs.values()]
        self.assertIn("done", states)
        for job in jobs.values():
            if job["state"] == "failed":
                self.assertIn("interrupted", job["reason"])
        self.assertLess(max(ready_s), 10 * READY_S)
        print(f"{KILLS} kills, {len(dropped)} drops, {states.count('failed')} interrupted, ready again after "
              f"{statistics.median(ready_s):.2f} s (at most {max(ready_s):.2f} s)", file=sys.stderr)
        self.assertEqual(shop.end(), 0)


class Disk(Case):
    """Calls FIRST to FIRST + COUNT - 1 fail, as they do on a disk that is full or breaks, then it is mended."""

    def shop(self, number):
        folder = self.folder / str(number)
        folder.mkdir()
        when, told = folder / "when", folder / "told"
        environment = {"LD_PRELOAD": FAILING_DISK, "FAILING_DISK": str(folder / "state"),
                       "FAILING_DISK_WHEN": str(when), "FAILING_DISK_TOLD": str(told)}
        return Workshop(self, folder, printers=1, environment=environment), when, told

    def broken(self, number, first, count, cause):
        shop, when, told = self.shop(number)
        try:
            return self.mended(shop, number, first, count, cause, when, told)
        finally:
            shop.close()

    def mended(self, shop, number, first, count, cause, when, told):
        when.write_text(f"{first} {count} {cause}")
        dropped = {f"{number}-{i}.gcode": gcode(f"{number}-{i}.gcode") for i in range(2)}
        started = shop.start()
        for name, text in dropped.items():
            shop.drop("m0", name, text)
        end = time.monotonic() + 3
        while started and time.monotonic() < end and not (told.exists() and told.stat().st_size >= min(count, 3)):
            time.sleep(0.05)
        when.unlink()
        if shop.daemon.poll() is not None:
            self.assertGreater(shop.daemon.returncode, 0, f"it crashed at call {first}: {shop.log()}")
            self.assertIn("error", shop.log())
            self.assertIsNotNone(shop.start(), shop.log())
        shop.wait_until_all_ended(len(dropped))
        shop.check(dropped)
        self.assertEqual(shop.end(), 0)
        return told.exists()

    def test_a_full_disk_is_one_line_of_the_log_and_seen(self):
        shop, when, _ = self.shop("full")
        shop.start()
        shop.wait_for(lambda: shop.inbox("m0").is_dir())
        when.write_text(f"1 1000000 {errno.ENOSPC}")
        (shop.inbox("m0") / "a.gcode").write_text(gcode("a"))
        tries = lambda: {one["about"]: one["tries"] for one in shop.ask("troubles")}.get("the jobs' database", 0)
        shop.wait_for(lambda: tries() >= 4)
        self.assertEqual(shop.log().count("jobs.sqlite"), 1, shop.log())
        [seen] = [one for one in shop.ask("troubles") if one["about"] == "the jobs' database"]
        self.assertGreater(seen["next_s"] - seen["since_s"], 1.4, "after 0.2 s, and twice as long each time")
        when.unlink()
        shop.wait_until_all_ended(1)
        shop.check({"a": gcode("a")})
        self.assertEqual(shop.ask("troubles"), [])
        self.assertEqual(shop.end(), 0)

    def test_calls_that_fail(self):
        struck = 0
        for number in range(DISK_FAULTS):
            # the last of them strike while it prints
            first = self.random.randrange(1, 300) if number % 5 else number // 5 + 1
            count = self.random.choice([1, 1, 3, 1000000])
            cause = self.random.choice([errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.EROFS])
            with self.subTest(first=first, count=count, cause=errno.errorcode[cause]):
                struck += self.broken(number, first, count, cause)
        self.assertGreater(struck, DISK_FAULTS / 2, "most faults must have struck")
        print(f"{struck} of {DISK_FAULTS} faults struck", file=sys.stderr)


class FullAtTheStart(Case):
    """A small disk of its own with the state folder, full to the last byte while no daemon runs."""

    def setUp(self):
        super().setUp()
        state = self.folder / "state"
        state.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=24m", "packmerger-test", state], capture_output=True,
                                 text=True)
        if mounted.returncode != 0:
            self.skipTest(f"no disk can be mounted here: {mounted.stderr.strip()}")
        self.addCleanup(lambda: subprocess.run(["umount", "--lazy", state], check=False))

    def test_old_jobs_are_cleared_and_it_goes_on(self):
        shop = Workshop(self, self.folder, printers=1)
        shop.start()
        old, young, after = (gcode(name) + tail for name, tail in
                             (("old", f"; {'x' * 78}\n" * 40000), ("young", ""), ("after", "")))
        shop.drop("m0", "old.gcode", old)
        shop.wait_until_all_ended(1)
        shop.drop("m0", "young.gcode", young)
        shop.wait_until_all_ended(2)
        shop.kill()
        database = sqlite3.connect(shop.state / "jobs.sqlite")
        database.execute("UPDATE job SET ended_s = ended_s - ? WHERE name = 'old.gcode'", [3 * DAY_S])
        database.commit()
        database.close()
        with open(shop.state / "others", "wb", buffering=0) as others, contextlib.suppress(OSError):
            while others.write(b"x" * 512):
                pass
        self.assertIsNotNone(shop.start(), shop.log())
        shop.wait_for(lambda: all((job["deleted_s"] is None) == (job["name"] == "young.gcode") for job in shop.jobs()))
        self.assertFalse((shop.state / "jobs/1").exists())
        self.assertTrue((shop.state / "jobs/2").exists())
        self.assertIn("is full: the folders of the oldest jobs are deleted", shop.log())
        shop.drop("m0", "after.gcode", after)
        shop.wait_until_all_ended(3)
        shop.check({"old": old, "young": young, "after": after})
        self.assertEqual(shop.end(), 0)


class Clock(Case):
    """The wall's clock jumps by days while programs arrive and are printed; time that only passes goes on as it was."""

    def test_jumps(self):
        shift = self.folder / "shift"
        shift.write_text("0")
        shop = Workshop(self, self.folder, printers=1, speed=300, environment={
            "LD_PRELOAD": program.binary("libshifted_clock.so"), "SHIFTED_CLOCK": str(shift)})
        shop.start()
        dropped = {}
        for number, jump in enumerate([-3, 2, -400, 20000, 0]):
            mark = f"c{number}"
            dropped[mark] = gcode(mark, moves=100)
            shop.drop("m0", f"{mark}.gcode", dropped[mark])
            shop.wait_for(lambda: len(shop.jobs()) == len(dropped))
            shift.write_text(str(jump * DAY_S))
            shop.wait_until_all_ended(len(dropped))
        jobs = shop.check(dropped)
        self.assertEqual({job["state"] for job in jobs.values()}, {"done"})
        received_s = [jobs[f"c{number}"]["received_s"] for number in range(5)]
        self.assertGreater(max(received_s) - min(received_s), 300 * DAY_S, "the clock did jump")
        self.assertEqual(shop.end(), 0)


if __name__ == "__main__":
    unittest.main()
