#!/usr/bin/python3
"""A model dropped into a watched folder, with the real prepare: settings beside it, printers compared for it, and what lies
beside it at the end."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import watched
from bad_inputs import stl
from shapes import torus

PNG = b"\x89PNG\r\n\x1a\n"


class Drop(watched.Watched):
    patience_s = 240

    def setUp(self):
        super().setUp()
        quick = 'split = false\nhollow = false\nset = ["tabu_patience=1", "cost.currency=EUR"]\n'
        self.start(f'[printer.objet]\nprofile = "objet30"\nhandoff_folder = "out"\n{quick}approve = "auto"\n'
                   f'[printer.uprint]\nprofile = "uprint"\nhandoff_folder = "out"\n{quick}'
                   '[printer.any]\nprofile = "auto"\n', last="any")

    def reaches(self, number, state):
        self.wait_for(lambda: self.job(number)["state"] in (state, "failed"))
        self.assertEqual(self.job(number)["state"], state, self.job(number))

    def model(self, name):
        """Written elsewhere, ready to be moved in."""
        (self.folder / name).write_bytes(stl(torus(10, 4)))
        return self.folder / name

    def test_settings_beside_a_model(self):
        (self.drops / "objet/part.stl.toml").write_text("size = 30\ncopies = 2\nseed = 9\n[set]\ngap_mm = 2.5\n")
        self.model("part.stl").rename(self.drops / "objet/part.stl")
        self.wait_for(lambda: self.job(1)["state"] in ("ready", "handed_over", "failed"))
        if self.job(1)["state"] == "ready":
            self.ask("jobs", "approve", 1)
        self.reaches(1, "handed_over")
        told = json.loads((pathlib.Path(self.job(1)["folder"]) / "job.json").read_text())
        self.assertEqual((len(told["inputs"]), told["seed"], told["packing"]["gap_mm"]), (2, 9, 2.5))
        self.assertAlmostEqual(max(told["inputs"][0]["size_mm"]), 30, delta=0.01)
        done = self.drops / "objet/done"
        self.wait_for((done / "part.stl.result.json").exists)
        self.assertEqual(sorted(path.name for path in done.iterdir()),
                         ["part.stl", "part.stl.preview.png", "part.stl.result.json", "part.stl.toml"])
        self.assertEqual((done / "part.stl.preview.png").read_bytes()[:8], PNG)
        result = json.loads((done / "part.stl.result.json").read_text())
        self.assertEqual(result["estimates"], told["estimates"])
        self.assertEqual((result["profile"], result["seed"], result["variant"]), ("objet30", 9, "packed"))

    def test_a_mistake_in_the_settings_is_told_with_its_line(self):
        (self.drops / "objet/part.stl.toml").write_text("size = 30\ncopies = 0\n")
        self.model("part.stl").rename(self.drops / "objet/part.stl")
        self.reaches_failed(1)
        failed = self.drops / "objet/failed"
        self.wait_for((failed / "part.stl.reason.txt").exists)
        self.assertIn("part.stl.toml:2: copies: expected an integer from 1 to 1000", (failed / "part.stl.reason.txt").read_text())
        self.assertTrue((failed / "part.stl.toml").exists() and (failed / "part.stl").exists())

    def reaches_failed(self, number):
        self.wait_for(lambda: self.job(number)["state"] == "failed")

    def test_printers_are_compared_and_one_is_proposed(self):
        self.model("part.stl").rename(self.drops / "any/part.stl")
        self.reaches(1, "ready")
        job = self.job(1)
        choice = job["choice"]
        costs = {one["printer"]: one["cost"] for one in choice["printers"]}
        self.assertEqual(set(costs), {"objet", "uprint"})
        self.assertEqual(job["printer"], min(costs, key=costs.get))
        self.assertEqual((choice["chosen"], job["chosen_by"], job["waits_for"]), (job["printer"], "any", "approval"))
        told = json.loads((pathlib.Path(job["folder"]) / "job.json").read_text())
        self.assertAlmostEqual(told["estimates"][told["variant"]]["cost"], costs[job["printer"]], delta=0.01 * costs[job["printer"]])
        shown = self.ask("jobs", "show", 1).out
        self.assertIn("The cheapest of 2 printers is proposed", shown)
        self.assertRegex(shown, rf"-> +{job['printer']} ")
        self.assertIn("auto (cheapest)", self.ask("printers", "list").out)
        self.ask("jobs", "approve", 1)
        self.reaches(1, "handed_over")
        self.wait_for((self.drops / "any/done/part.stl.result.json").exists)
        self.assertEqual(json.loads((self.drops / "any/done/part.stl.result.json").read_text())["choice"], choice)


if __name__ == "__main__":
    unittest.main()
