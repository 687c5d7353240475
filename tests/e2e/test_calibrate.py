#!/usr/bin/python3
"""`packmerger calibrate`: prints whose true constants are known, stated in every way and seen by the daemon."""
import json
import pathlib
import re
import shutil
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import stl
from shapes import sphere, torus
from workshop import Workshop

FAST = ("--no-split", "--set", "tabu_patience=1", "--set", "tabu_samples=2")
TRUTH = {"polyjet.layer_s": 6.5, "polyjet.swath_s": 1.2, "polyjet.support_g_per_cm3": 2.1,
         "polyjet.model_waste_factor": 1.4}
SIZES = {"sphere": (40, 70), "torus": (90,)}


def settings(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


class Stated(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-calibrate-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        (cls.folder / "sphere.stl").write_bytes(stl(sphere()))
        (cls.folder / "torus.stl").write_bytes(stl(torus()))
        cls.made = {}  # (model, size) -> what a machine of the true constants takes
        for name, sizes in SIZES.items():
            for size in sizes:
                result = program.run("compare", cls.folder / f"{name}.stl", "--size", size, "--profile", "objet30",
                                     *settings(TRUTH), *FAST, "--json")
                assert result.code == 0, str(result)
                cls.made[name, size] = json.loads(result.out)["objet30"]["as_is"]
        result = program.run("prepare", cls.folder / "torus.stl", "--size", 60, "--profile", "objet30", "--variant", "packed",
                             *settings(TRUTH), *FAST, "--out", cls.folder / "job")
        assert result.code == 0, str(result)

    def stated(self):
        """The options that tell every print."""
        words = []
        for (name, size), made in self.made.items():
            words += ["--print", self.folder / f"{name}.stl", "--size", size, "--took", f"{made['time_s']:.0f}s",
                      "--model", f"{made['model_g']:.3f}g", "--support", f"{made['support_g']:.3f}"]
        packed = json.loads((self.folder / "job/job.json").read_text())["estimates"]["packed"]
        return [*words, "--print", self.folder / "job", "--took", f"{packed['time_s']:.0f} s", "--support", f"{packed['support_g']}"]

    def calibrate(self, *arguments, code=0, profile="objet30"):
        result = program.run("calibrate", profile, *arguments, cwd=self.folder)
        self.assertEqual(result.code, code, f"{arguments}: {result}")
        if code:
            self.assertEqual(result.out, "")
            self.assertIn("hint: ", result.err)
        return result

    def found(self, *arguments):
        told = json.loads(self.calibrate(*arguments, "--json").out)
        return told, {one["key"]: one for one in told["constants"]}

    def test_the_true_constants_are_found(self):
        told, found = self.found(*self.stated())
        self.assertEqual(told["prints"], 4)
        for key, value in TRUTH.items():
            self.assertTrue(found[key]["fitted"], key)
            self.assertAlmostEqual(found[key]["after"] / value, 1, delta=2e-3, msg=key)
            self.assertLess(found[key]["standard_error"], 2e-3 * value, key)
        self.assertIn("polyjet.per_mm_x_s", found)
        time = told["quantities"]["time"]
        self.assertGreater(time["rms_before"], 0.05)
        self.assertLess(time["rms_after"], 1e-3)
        self.assertGreater(time["rms_left_out"], time["rms_after"])
        self.assertLess(time["rms_left_out"], time["rms_before"])
        self.assertEqual(len(time["prints"]), 4)
        self.assertEqual(len(told["quantities"]["model"]["prints"]), 3, "the job folder's model material was not told")
        self.assertIsNone(told["out"])

    def test_what_is_written_is_a_profile_with_the_new_times(self):
        out = self.folder / "lab.toml"
        result = self.calibrate(*self.stated(), "--out", out)
        text = out.read_text()
        self.assertRegex(text, r'^# Fitted to 4 finished prints on \d{4}-\d\d-\d\d ')
        self.assertIn('base = "objet30"', text)
        self.assertRegex(text, r"layer_s = [\d.]+  # s; \d{4}-\d\d-\d\d, 4 prints, standard error ")
        keys = re.findall(r"^(\w+) = ", text, re.MULTILINE)
        self.assertEqual(set(keys) - {"base", "layer_s", "swath_s", "support_g_per_cm3", "model_waste_factor", "start_s", "per_mm_x_s"}, set())
        self.assertIn("polyjet.layer_s", result.out)
        self.assertNotIn("base =", result.out)
        self.assertEqual(program.run("profiles", "check", out).code, 0)
        compared = program.run("compare", self.folder / "sphere.stl", "--size", 70, "--profile", out, *FAST, "--json")
        self.assertEqual(compared.code, 0, str(compared))
        as_is, true = json.loads(compared.out)["lab"]["as_is"], self.made["sphere", 70]
        for key in ("time_s", "model_g", "support_g"):
            self.assertAlmostEqual(as_is[key] / true[key], 1, delta=2e-3, msg=key)
        # the file is kept, and replaced when that is asked for
        self.calibrate(*self.stated(), "--out", out, code=73)
        self.assertEqual(out.read_text(), text)
        # fitted again, it is still derived from the one profile that has no base
        self.calibrate(*self.stated(), "--out", out, "--force", profile=out)
        self.assertIn('base = "objet30"', out.read_text())
        self.assertEqual(program.run("profiles", "check", out).code, 0)

    def test_a_file_that_is_called_as_its_base_holds_every_key(self):
        out = self.folder / "objet30.toml"
        self.calibrate(*self.stated(), "--out", out)
        self.addCleanup(out.unlink)
        self.assertNotIn("base =", out.read_text())
        self.assertEqual(program.run("profiles", "check", out).code, 0)

    def test_without_out_the_keys_are_shown(self):
        result = self.calibrate(*self.stated())
        table, toml = result.out.split('\nbase = "objet30"\n')
        self.assertIn("root mean square", table)
        self.assertIn("[polyjet]\n", toml)

    def test_a_table_tells_the_same(self):
        for separator in (",", ";"):
            lines = ["# our prints", separator.join(("print", "took", "size", "support", "model"))]
            for (name, size), made in self.made.items():
                lines.append(separator.join((f'"{name}.stl"', f"{made['time_s']:.0f}s", str(size), f"{made['support_g']:.3f}g",
                                             f"{made['model_g']:.3f}")))
            (self.folder / "prints.csv").write_text("\r\n".join(lines) + "\r\n")
            _, by_table = self.found("--prints", self.folder / "prints.csv")
            _, typed = self.found(*self.stated()[:-6])
            self.assertEqual(by_table, typed)

    def test_a_bad_table_tells_its_line(self):
        for text, line, word in (("print,tok\nsphere.stl,6h\n", 1, "tok"), ("took\n6h\n", 1, "print"),
                                 ("print,took\nsphere.stl,6\n", 2, "duration"), ("print\nsphere.stl,6h\n", 2, "fields"),
                                 ("print,took\n\n#\n,6h\n", 4, "no print"), ("", 1, "no print"), ("print\n", 1, "no print")):
            with self.subTest(text):
                (self.folder / "bad.csv").write_text(text)
                err = self.calibrate("--prints", self.folder / "bad.csv", code=65).err
                self.assertIn(f"bad.csv:{line}: ", err)
                self.assertIn(word, err)

    def test_one_print_fits_one_factor(self):
        made = self.made["sphere", 40]
        _, found = self.found("--print", self.folder / "sphere.stl", "--size", "40", "--took", f"{made['time_s']:.0f}s")
        ratio = found["polyjet.layer_s"]["after"] / found["polyjet.layer_s"]["before"]
        self.assertAlmostEqual(found["polyjet.swath_s"]["after"] / found["polyjet.swath_s"]["before"], ratio, delta=1e-5)
        self.assertIn("one factor", found["polyjet.layer_s"]["why"])
        self.assertIsNone(found["polyjet.layer_s"]["standard_error"])
        self.assertIn("no print tells its support material", found["polyjet.support_g_per_cm3"]["why"])
        self.assertIn("no print tells its model material", found["polyjet.model_waste_factor"]["why"])

    def test_wrong_usage(self):
        one = ("--print", self.folder / "sphere.stl", "--size", "40")
        for wrong in (("--took", "6h"), (*one, "--took", "6.23"), (*one, "--took", "-6h"), (*one, "--took", "6h", "--took", "7h"),
                      (*one, "--support", "0g"), (*one, "--support", "12 stone"), (*one, "--tray", "1.5"), (*one, "--force"),
                      (*one, "--took", "6h", "--out", "lab.ini"), (*one, "--took", "6h", "--out", "a b.toml"), ("--print",)):
            with self.subTest(" ".join(map(str, wrong))):
                result = program.run("calibrate", "objet30", *wrong, cwd=self.folder)
                self.assertEqual((result.code, result.out), (2, ""), str(result))
                self.assertNotEqual(result.err, "")
        self.assertEqual(program.run("calibrate").code, 2)

    def test_prints_that_say_nothing_here(self):
        stated = ("--took", "2h")
        self.calibrate("--print", self.folder / "nobody.stl", *stated, code=66)
        self.calibrate("--print", self.folder, *stated, code=66)  # no job folder
        self.calibrate("--print", self.folder / "sphere.stl", "--size", "40", code=65)  # nothing told
        self.calibrate("--print", self.folder / "sphere.stl", "--size", "4000", *stated, code=65)  # does not fit
        self.calibrate("--print", self.folder / "job", "--tray", "2", *stated, code=65)
        self.calibrate("--print", self.folder / "job", "--size", "60", *stated, code=65)
        self.assertIn("uprint", self.calibrate("--print", self.folder / "job", *stated, code=65, profile="uprint").err)
        (self.folder / "fine.toml").write_text('base = "objet30"\nlayer_mm = 0.016\n')
        self.assertIn("0.016", self.calibrate("--print", self.folder / "job", *stated, code=65,
                                              profile=self.folder / "fine.toml").err)
        self.calibrate("--print", self.folder / "job", *stated, code=66, profile="nobody")
        (self.folder / "twin.toml").write_text('base = "objet30"\n')
        self.assertIn("other_profile", self.calibrate("--print", self.folder / "job", *stated, profile=self.folder / "twin.toml").err)

    def test_no_daemon(self):
        result = self.calibrate("--socket", self.folder / "nobody.sock", code=69)
        self.assertIn("--socket", result.err)

    def test_uprint_by_volumes(self):
        truth = {"fdm.deposition_cm3_h": 25, "fdm.layer_s": 12, "fdm.support_fill_fraction": 0.5}
        words = []
        for name, size in (("sphere", 60), ("torus", 120), ("sphere", 25)):
            result = program.run("compare", self.folder / f"{name}.stl", "--size", size, "--profile", "uprint", *settings(truth),
                                 *FAST, "--json")
            made = json.loads(result.out)["uprint"]["as_is"]
            words += ["--print", self.folder / f"{name}.stl", "--size", size, "--took", f"{made['time_s']:.0f}s",
                      "--support", f"{made['support_g'] / 1.05:.4f}cm3"]
        told = json.loads(self.calibrate(*words, "--json", profile="uprint").out)
        found = {one["key"]: one for one in told["constants"]}
        for key, value in truth.items():
            self.assertAlmostEqual(found[key]["after"] / value, 1, delta=1e-2, msg=key)


class SeenByTheDaemon(unittest.TestCase):
    def test_finished_prints_of_a_simulated_printer(self):
        folder = pathlib.Path(tempfile.mkdtemp(prefix="packmerger-calibrate-"))
        self.addCleanup(shutil.rmtree, folder)
        shop = Workshop(self, folder, printers=1, speed="1")
        shop.start()
        socket = ("--socket", shop.state / "packmergerd.sock")
        none = program.run("calibrate", "marlin", *socket)
        self.assertEqual(none.code, 65, str(none))
        self.assertIn("--print", none.err)
        for number, moves in enumerate((1, 2, 4)):
            there_and_back = "G1 X100 F6000\nG1 X0 F6000\n" * moves
            shop.drop("m0", f"part{number}.gcode", f"G28\nG90\n{there_and_back}M84\n")
        shop.wait_until_all_ended(3)
        jobs = [job for job in shop.jobs() if job["state"] == "done"]
        self.assertEqual(len(jobs), 3, shop.jobs())
        out = folder / "m0.toml"
        result = program.run("calibrate", "marlin", *socket, "--out", out, "--json")
        self.assertEqual(result.code, 0, str(result))
        told = json.loads(result.out)
        time = told["quantities"]["time"]
        self.assertEqual({round(one["seen"], 6) for one in time["prints"]}, {round(job["printed_s"], 6) for job in jobs})
        self.assertEqual({round(one["before"], 6) for one in time["prints"]}, {round(job["predicted_s"], 6) for job in jobs})
        (start,) = told["constants"]
        self.assertEqual((start["key"], start["fitted"], start["prints"]), ("fdm.start_s", True, 3))
        self.assertGreaterEqual(start["after"], 0)
        self.assertLess(start["after"], 60)
        self.assertLessEqual(time["rms_after"], time["rms_before"])
        self.assertIsNotNone(time["rms_left_out"])
        if not start["at_limit"]:
            self.assertIn('base = "marlin"', out.read_text())
        self.assertEqual(program.run("profiles", "check", out).code, 0)
        # the same prints, typed in
        words = [word for job in jobs for word in ("--print", job["folder"], "--took", f"{job['printed_s']:.6f}s")]
        typed = json.loads(program.run("calibrate", "marlin", *words, "--json").out)
        self.assertAlmostEqual(typed["constants"][0]["after"], start["after"], places=3)
        # of this printer by its name, and of none
        named = json.loads(program.run("calibrate", "marlin", *socket, "--printer", "m0", "--json").out)
        self.assertEqual(named["constants"], told["constants"])
        self.assertEqual(program.run("calibrate", "marlin", *socket, "--printer", "nobody").code, 65)
        # a folder that is gone is left out, and said
        shutil.rmtree(jobs[0]["folder"])
        fewer = program.run("calibrate", "marlin", *socket)
        self.assertEqual(fewer.code, 0, str(fewer))
        self.assertIn("no_folder", fewer.err)


if __name__ == "__main__":
    unittest.main()
