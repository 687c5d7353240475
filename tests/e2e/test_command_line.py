#!/usr/bin/python3
"""The contract of the command line: exit codes, streams, shapes of the data, one result for one seed."""
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from bad_inputs import stl
from check_job import check
from checker import estimates
from shapes import crossed_bars, sphere, torus

FAST = ("--set", "tabu_patience=1", "--set", "tabu_samples=2")
WITHOUT_THE_CLOCK = ("timings_s",)


class CommandLine(unittest.TestCase):
    """What the tests below share: a folder with a sphere and a torus."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-cli-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.sphere, self.torus = self.folder / "sphere.stl", self.folder / "torus.stl"
        self.sphere.write_bytes(stl(sphere()))
        self.torus.write_bytes(stl(torus()))

    def prepare(self, *arguments, out="job", **options):
        return program.run("prepare", *arguments, "--out", self.folder / out, **options)

    def expect(self, code, *arguments):
        result = program.run(*arguments)
        self.assertEqual(result.code, code, f"{arguments}: {result}")
        self.assertNotEqual(result.err.strip(), "", f"{arguments}: nothing said on stderr")
        self.assertFalse((self.folder / "job").exists())
        return result


class Usage(CommandLine):
    def test_wrong_usage(self):
        good = ["prepare", self.sphere, "--profile", "objet30", "--out", self.folder / "job"]
        for wrong in (["--scale", "-1"], ["--scale", "2", "--size", "3"], ["--size", "0"], ["--scale", "nan"],
                      ["--size", "inf"], ["--budget", "nan"], ["--units", "furlong"],
                      ["--variant", "best"], ["--seed", "x"], ["--budget", "-1"], ["--set", "nonsense=1"],
                      ["--set", "gap_mm=wide"], ["--set", "gap_mm"], ["--set", "gap_mm=-1"], ["--nonsense"]):
            with self.subTest(" ".join(wrong)):
                self.expect(2, *good, *wrong)
        for wrong in ([], ["nonsense"], ["prepare"], good[:2], good[:4], ["compare", self.sphere],
                      ["prepare", *good[2:]]):
            with self.subTest(" ".join(map(str, wrong[:2]))):
                self.expect(2, *wrong)

    def test_what_was_mistyped_is_named(self):
        self.assertIn('Did you mean "prepare"?', self.expect(2, "prepre", self.sphere).err)
        self.assertIn('Did you mean "cancel"?', self.expect(2, "jobs", "cancle", "3").err)
        near = self.expect(66, "prepare", self.sphere, "--profile", "replicater", "--out", self.folder / "job").err
        self.assertIn('Did you mean "replicator"?', near)
        ender = self.expect(66, "compare", self.sphere, "--profile", "ender3").err
        self.assertIn('The nearest is "marlin", for printers that melt filament', ender)
        for err in (ender,
                    self.expect(2, "compare", self.sphere).err,
                    self.expect(2, "prepare", self.sphere, "--out", self.folder / "job").err):
            self.assertIn(", ".join(sorted(path.stem for path in (program.SOURCE / "profiles").glob("*.toml"))), err)

    def test_what_is_missing_is_named(self):
        for spoken, verbs in ((["packmerger"], "prepare, compare, send"), (["packmerger", "jobs"], "list, show"),
                              (["packmerger", "printers"], "list, ")):
            err = self.expect(2, *spoken[1:]).err
            self.assertIn(f"error: {' '.join(spoken)} needs a verb.", err)
            self.assertIn(verbs, err)
        self.assertEqual(self.expect(2, "compare").err,
                         "error: MODEL is required.\nhint: `packmerger compare --help` tells how it is used.\n")

        daemon = subprocess.run([program.binary("packmergerd")], capture_output=True, text=True)
        self.assertEqual((daemon.returncode, daemon.stderr),
                         (2, "error: --config is required\nhint: packmergerd --help tells how it is used\n"))

    def test_values_that_are_wrong_are_told_in_words(self):
        for wrong, told in ((("jobs", "approve", "bunny"), 'ID: "bunny" is not a whole number above 0'),
                            (("compare", self.sphere, "--size", "3cm"), '--size: "3cm" is not a number above 0'),
                            (("compare", self.sphere, "--copies", "0"), '--copies: "0" is not a whole number from 1 to 1000')):
            self.assertIn(f"error: {told}.\n", self.expect(2, *wrong).err)

    def test_a_program_without_its_profiles_says_so(self):
        if any(pathlib.Path(folder, "packmerger/profiles").exists() for folder in ("/etc", "/usr/share")):
            self.skipTest("PackMerger is installed here")
        moved = shutil.copy(program.binary(), self.folder)
        done = subprocess.run([moved, "profiles", "show", "marlin"], capture_output=True, text=True,
                              env={"PATH": "/usr/bin:/bin", "XDG_CONFIG_HOME": str(self.folder)})
        self.assertEqual(done.returncode, 66, done.stderr)
        self.assertIn("hint: No profiles are installed.", done.stderr)

    def test_a_daemon_that_is_not_there_may_be_the_package_s(self):
        err = self.expect(69, "jobs", "list", "--socket", self.folder / "none.sock").err
        self.assertIn("/run/packmerger/packmergerd.sock", err)

    def test_help_reads_like_words(self):
        text = " ".join(program.run("prepare", "--help").out.split())
        self.assertIn("--variant packed|hollow|solid|cheapest", text)

    def test_help_goes_to_stdout(self):
        for verb in ([], ["prepare"], ["compare"], ["profiles"], ["send"], ["calibrate"], ["simulate"], ["jobs"], ["printers"]):
            with self.subTest(" ".join(verb)):
                result = program.run(*verb, "--help")
                self.assertEqual((result.code, result.err), (0, ""), str(result))
                self.assertIn("--help", result.out)

    def test_bad_profiles(self):
        texts = {"unknown key": 'base = "objet30"\nnonsense = 1\n', "wrong type": 'base = "objet30"\ngap_mm = "wide"\n',
                 "out of range": 'base = "objet30"\ngap_mm = -3\n', "no TOML": 'base = "objet30"\ngap_mm = = 1\n'}
        for name, text in texts.items():
            with self.subTest(name):
                path = self.folder / "mine.toml"
                path.write_text(text)
                result = self.expect(78, "prepare", self.sphere, "--profile", path, "--out", self.folder / "job")
                self.assertIn("mine.toml", result.err)
                self.assertRegex(result.err, r"\b2\b")  # the line
        with self.subTest("no such profile"):
            result = program.run("prepare", self.sphere, "--profile", "nobody", "--out", self.folder / "job")
            self.assertIn(result.code, (66, 78), str(result))
            self.assertIn("nobody", result.err)

    def test_an_interrupt_leaves_nothing(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal.Signals(number).name):
                beside = self.folder / number.name
                beside.mkdir()
                child = subprocess.Popen([program.binary(), "prepare", self.sphere, "--size", "120", "--profile", "objet30",
                                          "--out", beside / "job"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                         text=True, start_new_session=True)
                child.stderr.readline()  # the first line of progress: it is at work
                time.sleep(0.5)
                child.send_signal(number)
                _, err = child.communicate(timeout=60)
                self.assertEqual(child.returncode, 130, err[-500:])
                self.assertEqual(program.files_below(beside), [])
                with self.assertRaises(ProcessLookupError, msg="a child still runs"):
                    os.killpg(child.pid, 0)

    def test_a_long_step_of_a_library_is_ended_too(self):
        """Hundred bars around one axis, whose tops lie in one plane: cutting that plane takes minutes, in one call."""
        model = self.folder / "bars.stl"
        model.write_bytes(stl(crossed_bars(100)))
        child = subprocess.Popen([program.binary(), "prepare", model, "--profile", "objet30", "--no-split",
                                  "--out", self.folder / "job"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        for line in child.stderr:
            if "uniting" in line:
                break
        time.sleep(3)
        self.assertIsNone(child.poll(), "it would take minutes")
        started = time.monotonic()
        child.terminate()
        _, err = child.communicate(timeout=100)
        self.assertLess(time.monotonic() - started, 10)
        self.assertEqual(child.returncode, 130, err[-500:])
        self.assertIn("Interrupted", err)
        self.assertFalse((self.folder / "job").exists())


class Jobs(CommandLine):
    def test_two_models_without_splitting(self):
        result = self.prepare(self.sphere, self.torus, "--no-split", "--profile", "objet30", "--json", *FAST)
        self.assertEqual(result.code, 0, str(result))
        told = json.loads(result.out)
        self.assertEqual(told, json.loads((self.folder / "job" / "job.json").read_text()))
        self.assertEqual(sorted(part["model"] for part in told["parts"]), [0, 1])
        self.assertEqual([entry["file"] for entry in told["inputs"]], ["sphere.stl", "torus.stl"])
        self.assertEqual(check(self.folder / "job", [self.sphere, self.torus]).failures(), [])

    def test_one_model_given_twice_without_splitting(self):
        result = self.prepare(self.torus, self.torus, "--no-split", "--profile", "uprint", *FAST)
        self.assertEqual(result.code, 0, str(result))
        report = check(self.folder / "job", [self.torus])
        self.assertEqual(report.failures(), [])
        told = json.loads((self.folder / "job" / "job.json").read_text())
        self.assertEqual(len(told["parts"]), 2)

    def test_copies_with_and_without_splitting(self):
        for name, split in (("whole", ["--no-split"]), ("divided", [])):
            with self.subTest(name):
                job = self.folder / name
                result = program.run("prepare", self.torus, self.sphere, "--copies", "2", *split, "--profile", "objet30",
                                     "--size", "30", *FAST, "--out", job)
                self.assertEqual(result.code, 0, str(result))
                self.assertIn("2 copies", result.out)
                self.assertEqual(check(job, [self.torus, self.sphere]).failures(), [])
                told = json.loads((job / "job.json").read_text())
                self.assertEqual([entry["file"] for entry in told["inputs"]],
                                 ["torus.stl", "torus.stl", "sphere.stl", "sphere.stl"])
                self.assertEqual({part["model"] for part in told["parts"]}, {0, 1, 2, 3})

    def test_more_than_a_tray_holds(self):
        result = self.prepare(*[self.torus] * 5, "--no-split", "--profile", "objet30", "--set", "build_mm=60,50,25",
                              *FAST)
        self.assertEqual(result.code, 0, str(result))
        self.assertTrue((self.folder / "job" / "tray-2.3mf").exists())
        self.assertEqual(check(self.folder / "job", [self.torus]).failures(), [])

    def test_settings_reach_the_job(self):
        result = self.prepare(self.sphere, "--no-split", "--no-hollow", "--profile", "objet30", "--seed", "7", "--size",
                              "33", "--set", "gap_mm=2.5", "--set", "weight=0.5", "--json", *FAST)
        self.assertEqual(result.code, 0, str(result))
        told = json.loads(result.out)
        self.assertEqual((told["seed"], told["settings"]["gap_mm"], told["packing"]["weight"]), (7, 2.5, 0.5))
        self.assertNotIn("slicing", result.err, "this printer's own software does that")
        self.assertAlmostEqual(told["inputs"][0]["scale"], 33 / 40, places=6)
        self.assertEqual(check(self.folder / "job", [self.sphere]).failures(), [])

    def test_units(self):
        result = self.prepare(self.sphere, "--no-split", "--profile", "objet30", "--units", "cm", "--scale", "0.2",
                              "--json", *FAST)
        self.assertEqual(result.code, 0, str(result))
        self.assertAlmostEqual(json.loads(result.out)["inputs"][0]["scale"], 2.0, places=9)

    def contents(self, out):
        """Every file's bytes; job.json without what the clock says."""
        found = {}
        for path in sorted((self.folder / out).rglob("*")):
            if path.name == "job.json":
                data = json.loads(path.read_text())
                found["job.json"] = {key: value for key, value in data.items() if key not in WITHOUT_THE_CLOCK}
            elif path.is_file():
                found[str(path.relative_to(self.folder / out))] = path.read_bytes()
        return found

    def test_same_seed_same_bytes_on_one_thread_and_many(self):
        arguments = (self.sphere, self.torus, "--profile", "objet30", "--seed", "5", *FAST)
        self.assertEqual(self.prepare(*arguments, out="many").code, 0)
        self.assertEqual(self.prepare(*arguments, out="one", prefix=("taskset", "-c", "0")).code, 0)
        many, one = self.contents("many"), self.contents("one")
        self.assertEqual([name for name in many if many[name] != one.get(name)], [])
        self.assertEqual(set(many), set(one))

    def test_compare_as_json(self):
        result = program.run("compare", self.torus, "--no-split", "--profile", "objet30", "--profile", "uprint", "--json",
                             *FAST)
        self.assertEqual(result.code, 0, str(result))
        told = json.loads(result.out)
        self.assertEqual(sorted(told), ["objet30", "uprint"])
        for profile, four in told.items():
            self.assertEqual(set(four), {*estimates.WAYS, "advice"})
            self.assertRegex(four["advice"]["text"], "[Pp]ack")
            self.assertIn(four["advice"]["variant"], ("packed", "hollow", "solid", None))
            self.assertEqual([line for way in estimates.WAYS for line in estimates.faults(four[way], profile)], [])


if __name__ == "__main__":
    unittest.main()
