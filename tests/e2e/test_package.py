#!/usr/bin/python3
"""What is installed beside the programs: completions, manual pages, the unit, udev rules, and the Debian package.
Arguments: names of the classes below to run."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import tomllib
import unittest

import debian_machine
import program
import unit_calls

SOURCE = program.SOURCE
BUILD = pathlib.Path(program.binary()).parents[1]
MADE = BUILD / "manual"
INSTALL = SOURCE / "src" / "install"
UTF8 = dict(os.environ, LC_ALL="C.UTF-8")


def needs(tool):
    return unittest.skipUnless(shutil.which(tool), f"{tool} is not here")


def run(*command, **options):
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, env=UTF8, **options)


def verbs_and_options(*verbs):
    """{("jobs", "list"): ["--help", …]} as --help tells them, for the verbs and all below them."""
    text = program.run(*verbs, "--help").out
    options = re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.MULTILINE)
    below = re.findall(r"^  (\w[\w-]*)", text.partition("\nSubcommands:\n")[2], re.MULTILINE)
    found = {verbs: options + below}
    for verb in below:
        found |= verbs_and_options(*verbs, verb)
    return found


class Completions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.words = verbs_and_options()

    def bash(self, *words):
        """What bash offers for the last of the words."""
        script = f"""source {MADE}/packmerger.bash
            compopt() {{ :; }}
            COMP_WORDS=(packmerger "$@"); COMP_CWORD=$#; _packmerger; printf '%s\\n' "${{COMPREPLY[@]}}" """
        path = f"{BUILD / 'bin'}:{os.environ['PATH']}"
        result = subprocess.run(["bash", "-c", script, "bash", *words], capture_output=True, text=True,
                                env=dict(os.environ, PATH=path))
        self.assertEqual(result.stderr, "", words)
        return result.stdout.split()

    def test_help_was_understood(self):
        self.assertIn("--profile", self.words[("prepare",)])
        self.assertIn("approve", self.words[("jobs",)])
        self.assertGreater(len(self.words), 15)

    def test_bash_offers_every_verb_and_option(self):
        for verbs, expected in self.words.items():
            with self.subTest(" ".join(verbs)):
                starts = {"--" if word.startswith("--") else "" for word in expected}
                offered = [word for start in starts for word in self.bash(*verbs, start)]
                self.assertLessEqual(set(expected), set(offered))

    def test_bash_offers_values(self):
        self.assertEqual(self.bash("prepare", "--units", "c"), ["cm"])
        self.assertEqual(set(self.bash("prepare", "--variant", "")), {"packed", "hollow", "solid", "cheapest"})
        self.assertIn("replicator", self.bash("compare", "--profile", "rep"))
        self.assertIn("gap_mm=", self.bash("prepare", "--set", "gap"))
        self.assertIn("objet30", self.bash("profiles", "show", "o"))
        with tempfile.TemporaryDirectory() as folder:
            model = pathlib.Path(folder) / "a model.stl"
            model.touch()
            self.assertEqual(" ".join(self.bash("prepare", f"{folder}/a")), str(model))

    @needs("zsh")
    def test_zsh_knows_every_verb_and_option(self):
        result = run("zsh", "-n", MADE / "_packmerger")
        self.assertEqual((result.returncode, result.stderr), (0, ""))

    @needs("fish")
    def test_fish_offers_every_verb_and_option(self):
        for verbs, expected in self.words.items():
            offered = ""
            for start in ("--", "") if any(not word.startswith("-") for word in expected) else ("--",):
                line = " ".join(("packmerger", *verbs, start))
                offered += run("fish", "--no-config", "-c", f"source {MADE}/packmerger.fish; complete -C '{line}'").stdout
            missing = set(expected) - set(re.findall(r"^\S+", offered, re.MULTILINE))
            self.assertEqual(missing, set(), verbs)

    def test_the_scripts_name_every_option(self):
        zsh, fish = (MADE / "_packmerger").read_text(), (MADE / "packmerger.fish").read_text()
        for verbs, expected in self.words.items():
            body = zsh.partition("\n_" + "_".join(("packmerger", *verbs)) + "() {\n")[2].partition("\n}\n")[0]
            for word in expected:
                self.assertRegex(body, re.escape(word) + r"\b", verbs)
                named = f" -l {word[2:]} " if word.startswith("--") else f" -a {word} "
                self.assertTrue(any(named in line for line in fish.splitlines()
                                    if re.search(rf"__packmerger_i[ns] {' '.join(verbs)}'", line)), (verbs, word))


class Pages(unittest.TestCase):
    NAMES = ("packmerger.1", "packmergerd.8", "packmergerd.toml.5", "packmerger-profile.5")

    @needs("man")
    def test_no_page_gives_a_warning(self):
        for name in self.NAMES:
            result = run("man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", MADE / name)
            self.assertEqual((result.returncode, result.stderr), (0, ""), name)

    def test_the_page_tells_every_verb_and_option(self):
        text = (MADE / "packmerger.1").read_text().replace("\\-", "-")
        for verbs, options in verbs_and_options().items():
            if any(not option.startswith("--") for option in options):
                continue
            section = text.partition(f".SS {' '.join(verbs)}\n")[2].partition("\n.S")[0]
            for option in options:
                self.assertIn(f"\\fB{option}\\fR", section, verbs)

    def test_the_settings_page_tells_every_key(self):
        text = (MADE / "packmergerd.toml.5").read_text().replace("\\-", "-")
        for key in re.findall(r"^\| `([\w.]+)`", (SOURCE / "docs/DAEMON.md").read_text(), re.MULTILINE):
            self.assertIn(f"\\fB{key}\\fR", text)


class Service(unittest.TestCase):
    UNIT = INSTALL / "packmergerd.service"

    @needs("systemd-analyze")
    def test_exposure_is_below_two(self):
        result = run("systemd-analyze", "security", "--offline=yes", "--no-pager", self.UNIT)
        score = re.search(r"Overall exposure level for .*: ([\d.]+)", result.stdout)
        self.assertIsNotNone(score, result.stderr)
        self.assertLess(float(score.group(1)), 2.0, result.stdout)

    @needs("systemd-analyze")
    def test_systemd_understands_every_line(self):
        result = run("systemd-analyze", "verify", self.UNIT)
        complaints = [line for line in result.stderr.splitlines()
                      if "packmergerd.service" in line and "is not executable" not in line and "man " not in line]
        self.assertEqual(complaints, [])

    @needs("systemd-analyze")
    def test_every_call_that_is_needed_is_allowed(self):
        self.assertEqual(unit_calls.NEEDED - unit_calls.allowed(self.UNIT.read_text()), set())

    def settings_are_good(self, text):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "packmergerd.toml"
            path.write_text(text)
            result = run(program.binary("packmergerd"), "--check", "--config", path)
            self.assertEqual(result.returncode, 0, result.stderr)
            return result.stdout

    def test_the_settings_are_good_as_they_come(self):
        self.assertIn("0 printer", self.settings_are_good((INSTALL / "packmergerd.toml").read_text()))

    def test_the_examples_in_the_settings_are_good(self):
        text = (INSTALL / "packmergerd.toml").read_text()
        self.assertIn("2 printer", self.settings_are_good(re.sub(r"^# (\[|\w+ = )", r"\1", text, flags=re.MULTILINE)))

    def test_udev_knows_the_ids_of_every_profile_and_no_other(self):
        expected = set()
        for path in (SOURCE / "profiles").glob("*.toml"):
            for usb_id in tomllib.loads(path.read_text()).get("link", {}).get("usb_ids", []):
                expected.add((path.stem, *usb_id.split(":")))
        rules = (MADE / "70-packmerger.rules").read_text()
        self.assertGreater(len(expected), 1)
        linked = re.findall(r'ATTRS\{idVendor\}=="(\w+)", ATTRS\{idProduct\}=="(\w+)", .*SYMLINK\+="packmerger/([\w.-]+?)-\$', rules)
        self.assertEqual({(name, vendor, product) for vendor, product, name in linked}, expected)
        for _, vendor, product in expected:
            lines = [line for line in rules.splitlines() if f'=="{vendor}"' in line and f'=="{product}"' in line]
            for subsystem in ("usb", "tty"):
                self.assertTrue(any(f'SUBSYSTEM=="{subsystem}"' in line and 'GROUP="dialout"' in line and
                                    'ENV{ID_MM_DEVICE_IGNORE}="1"' in line for line in lines), (vendor, product))


class Package(unittest.TestCase):
    @classmethod
    @needs("cpack")
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-deb-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.deb = debian_machine.make_package(cls.folder)
        run("dpkg-deb", "-x", cls.deb, cls.folder / "root").check_returncode()

    @needs("lintian")
    def test_lintian_finds_no_error(self):
        result = run("lintian", "--fail-on", "error", "--suppress-tags", "appstream-metadata-missing-modalias-provide",
                     self.deb)
        self.assertEqual((result.returncode, result.stdout.strip()), (0, ""))

    def test_no_upgrade_asks_about_the_settings(self):
        """A file of the package in /etc that somebody changed stops an upgrade that nobody watches."""
        root = self.folder / "root"
        self.assertEqual([path for path in root.glob("etc/**/*") if path.is_file()], [])
        self.assertNotEqual(run("dpkg-deb", "-I", self.deb, "conffiles").returncode, 0)
        self.assertEqual((root / "usr/share/packmerger/packmergerd.toml").read_text(), (INSTALL / "packmergerd.toml").read_text())

    def test_the_installed_programs_find_each_other(self):
        """A model is filled with tetrahedra by the helper in /usr/lib/packmerger, with the package's profiles."""
        root = self.folder / "root"
        environment = dict(UTF8, PACKMERGER_PROFILES=str(root / "usr/share/packmerger/profiles"))
        model = program.bunny(self.folder)
        if model is None:
            self.skipTest("node or its bunny is not here")
        out = self.folder / "job"
        result = subprocess.run([root / "usr/bin/packmerger", "prepare", model, "--profile", "objet30", "--out", out,
                                 "--size", "60", "--budget", "2", "--set", "segmentation=paper"],
                                env=environment, capture_output=True, text=True)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue((out / "job.json").is_file())
        helper = root / "usr/lib/packmerger/packmerger-tetgen"
        helper.rename(self.folder / "gone")
        try:
            again = subprocess.run([root / "usr/bin/packmerger", "prepare", model, "--profile", "objet30", "--out",
                                    self.folder / "other", "--size", "60"], env=environment, capture_output=True, text=True)
        finally:
            (self.folder / "gone").rename(helper)
        self.assertEqual(again.returncode, 69, again.stderr)


if __name__ == "__main__":
    unittest.main()
