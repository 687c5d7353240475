#!/usr/bin/python3
"""Files arrive in every way there is, and the daemon is killed now and then: none is lost, half-read or printed twice.
PACKMERGER_DROPS (by itself 4 for each way) and PACKMERGER_SEED make it longer or another."""
import os
import pathlib
import random
import sys
import tempfile
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import ways_to_arrive
from workshop import SETTINGS, Workshop, gcode, sha256

DROPS = int(os.environ.get("PACKMERGER_DROPS", 4 * len(ways_to_arrive.WAYS)))
SEED = int(os.environ.get("PACKMERGER_SEED", 1))
PRINTERS = 4
DROPPERS = 6
KILLS = 5
STRANGE = ["a b", "ü", "-rf", "'", "#1", "%20", "日本", "a;b", "$(x)", "é" * 60]


class Drops(unittest.TestCase):
    def drop(self, shop, numbers):
        """What one of the droppers does."""
        chance = random.Random(f"{SEED} {numbers[0]}")
        for number in numbers:
            way = ways_to_arrive.WAYS[number % len(ways_to_arrive.WAYS)]
            mark = f"d{number}"
            # Every tenth name is used by many files, every eleventh is a strange one.
            name = "same.gcode" if number % 10 == 0 and way is ways_to_arrive.renamed else f"{mark}.gcode"
            if number % 11 == 0:
                name = f"{mark}{chance.choice(STRANGE)}.gcode"
            folder = shop.inbox(shop.printers[number % PRINTERS])
            while (folder / name).exists():
                time.sleep(0.02)
            text = gcode(mark, moves=chance.randrange(60))
            count = way(folder, name, text)
            with self.lock:
                (self.dropped if count else self.gone)[mark] = text
                self.counts[way.__name__] = self.counts.get(way.__name__, 0) + 1

    def test_every_way_of_arriving(self):
        holder = tempfile.TemporaryDirectory(prefix="packmerger-drops-")
        self.addCleanup(holder.cleanup)
        self.lock, self.dropped, self.gone, self.counts = threading.Lock(), {}, {}, {}
        shop = Workshop(self, holder.name, printers=PRINTERS, settings=SETTINGS)
        for printer in shop.printers:
            shop.inbox(printer).mkdir(parents=True)
        begun = time.monotonic()
        shop.start()
        droppers = [threading.Thread(target=self.drop, args=(shop, range(first, DROPS, DROPPERS))) for first in range(DROPPERS)]
        for one in droppers:
            one.start()
        for kill in range(1, KILLS + 1):
            while any(one.is_alive() for one in droppers) and len(self.dropped) + len(self.gone) < kill * DROPS / (KILLS + 1):
                time.sleep(0.05)
            shop.kill()
            shop.start()
        for one in droppers:
            one.join()
        shop.wait_until_all_ended(len(self.dropped), patience_s=120 + DROPS / 5)
        took_s = time.monotonic() - begun
        jobs = shop.check(self.dropped)
        states = [job["state"] for job in jobs.values()]
        self.assertLessEqual(states.count("failed"), KILLS * PRINTERS, "only what was printed in a kill may fail")
        self.assertEqual(len(self.dropped) + len(self.gone), DROPS)
        self.assertGreaterEqual(len(self.counts), 12)
        for path in shop.left_in_inboxes():
            self.assertTrue(path.is_symlink() or path.is_dir(), f"{path} was left")
        printed = shop.times_printed()
        for mark in self.gone:
            self.assertNotIn(f"M117 begin {mark}", printed)
        print(f"{DROPS} drops in {len(self.counts)} ways and {KILLS} kills: {states.count('done')} printed, "
              f"{states.count('failed')} interrupted, {len(self.gone)} taken back or no files; {took_s:.0f} s", file=sys.stderr)
        self.assertEqual(shop.end(), 0)


if __name__ == "__main__":
    unittest.main()
