#!/usr/bin/python3
"""Trays in a bed of powder: parts above one another, away from every wall, as a document for the maker's program."""
import json
import unittest
import xml.etree.ElementTree as ElementTree
import zipfile

import numpy as np

from test_command_line import FAST, CommandLine

from check_job import check

MODEL = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"


class Powder(CommandLine):
    def test_whole_models_above_one_another(self):
        result = self.prepare(self.torus, self.sphere, "--copies", "4", "--size", "20", "--no-split", "--no-hollow",
                              "--profile", "fuse1", "--set", "build_mm=46,46,120", "--set", "powder.refresh_fraction=0.8",
                              "--budget", "2", *FAST)
        self.assertEqual(result.code, 0, str(result))
        job = self.folder / "job"
        self.assertEqual(check(job, [self.torus, self.sphere]).failures(), [])
        told = json.loads((job / "job.json").read_text())
        self.assertEqual(told["packing"]["support_mm3"], 0)
        self.assertGreater(told["estimates"]["packed"]["support_g"], 0, "powder that cannot be used again")
        self.assertTrue(all(told["estimates"][way]["fits"] for way in ("solid", "packed")))
        with zipfile.ZipFile(job / "tray.3mf") as archive:
            root = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
        self.assertEqual(len(root.findall(f"{MODEL}build/{MODEL}item")), 8)
        lows = [self.points(job / part["file"])[:, 2].min() for part in told["parts"]]
        self.assertGreater(max(lows), 10, "one stands above another")

    @staticmethod
    def points(path):
        triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
        return np.frombuffer(path.read_bytes(), triangle, offset=84)["corners"].reshape(-1, 3)


del CommandLine  # its tests are run by its own file

if __name__ == "__main__":
    unittest.main()
