#!/usr/bin/python3
"""The package from `apt install` to `apt purge`, in a fresh Debian 12 under a real systemd. It takes some ten minutes, and
runs where PACKMERGER_LONG is set (cmake --build build --target long_package); elsewhere it is skipped, and says whether it
could run.
PACKMERGER_OLDER_DEB names the package of an earlier version to upgrade from (at least one whose daemon prints programs of
other slicers); else this one counts as one."""
import ctypes
import json
import os
import pathlib
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import debian_machine
import program
import web_daemon
from bad_inputs import stl
from shapes import torus

OLDER = "0.0.1"
STATE, DROPS, TRAYS = "/var/lib/packmerger", "/var/lib/packmerger/folders", "/var/lib/packmerger/trays"
SETTINGS = "/etc/packmerger/packmergerd.toml"
LAB = '\n[printer.lab]\nprofile = "objet30"\nhandoff_folder = "/var/lib/packmerger/trays"\n'
PAGE = "\n[web]\nport = {port}\n"
CABLE = '\n[printer.{name}]\nprofile = "{profile}"\nport = "{port}"\napprove = "auto"\nsimulated = true\nvariant = "solid"\n'
PROGRAM = "G28\nG1 X10 Y10 F3000\nG4 S40\nG1 X20 Y20\nM84\n"

# What made the first packages' service start: Debian 12's systemd counts neither Landlock nor seccomp as a service's call.
OVERRIDE = "[Service]\nSystemCallFilter=landlock_create_ruleset landlock_add_rule landlock_restrict_self seccomp\n"

# Prepares nothing, and tells what it could do although it must not.
PROBE = """#!/bin/sh
(: > /var/lib/packmerger/escaped) 2>/dev/null && { echo 'error: not confined' >&2; exit 65; }
(: > "$TMPDIR/own") || { echo 'error: confined out of its own folder' >&2; exit 65; }
echo 'error: confined as it should be' >&2; exit 65
"""


def kernel_has_landlock():
    create_ruleset, version_only = 444, 1
    return ctypes.CDLL(None).syscall(create_ruleset, None, 0, version_only) > 0


class Installed(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="package-", dir=debian_machine.BUILD)
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.new = debian_machine.make_package(self.folder / "new")
        older = os.environ.get("PACKMERGER_OLDER_DEB")
        self.old = pathlib.Path(older) if older else debian_machine.make_package(self.folder / "old", OLDER)
        self.port = web_daemon.free_port()
        self.machine = debian_machine.Machine(self.folder, self.folder / "boot.log")
        self.addCleanup(self.machine.end)

    def must(self, *command):
        """What a command in there says; it has to succeed."""
        print("#", *command, flush=True)
        result = self.machine.run(*command)
        told = (result.stdout + result.stderr).strip()
        print("\n".join(line for line in told.splitlines() if not line.startswith("(Reading"))[-3000:], flush=True)
        self.assertEqual(result.returncode, 0, command)
        return told

    def put(self, path, text, mode="644"):
        inside = self.machine.root / path.lstrip("/")
        inside.write_bytes(text if isinstance(text, bytes) else text.encode())
        inside.chmod(int(mode, 8))

    def configure(self, *parts):
        """Adds to the settings and has them read, as docs/INSTALL says."""
        with open(self.machine.root / SETTINGS.lstrip("/"), "a") as settings:
            settings.writelines(parts)
        self.must("systemctl", "reload", "packmergerd")

    def apt(self, verb, *names):
        for name, package in (("old", self.old), ("new", self.new)):
            self.put(f"/root/{name}.deb", package.read_bytes())
        return self.must("apt", "-y", verb, *names)

    def service(self, key):
        return self.machine.run("systemctl", "show", "--value", "-p", key, "packmergerd").stdout.strip()

    def journal(self):
        return self.machine.run("journalctl", "--no-pager", "-u", "packmergerd").stdout

    def lives(self):
        """The service runs, and no start before this one failed."""
        self.assertEqual((self.service("ActiveState"), self.service("NRestarts")), ("active", "0"), self.journal())
        self.assertNotIn("SYS", self.journal())

    def as_alice(self, *command):
        return self.must("runuser", "-u", "alice", "--", *command)

    def job(self, number):
        shown = self.machine.run("packmerger", "jobs", "show", number, "--json")
        return json.loads(shown.stdout) if shown.returncode == 0 else {"state": "none"}

    def reaches(self, number, *states):
        self.machine.wait_for(lambda: self.job(number)["state"] in (*states, "failed"), f"job {number}", 600)
        self.assertIn(self.job(number)["state"], states, (self.job(number), self.journal()[-3000:]))

    def drop(self, printer, name, data):
        """As a person who is in the group packmerger would."""
        self.put(f"/srv/{name}", data)
        self.as_alice("cp", f"/srv/{name}", f"{DROPS}/{printer}/")

    def approves(self, number):
        """A job of the lab, which asks; its folder is there for members of the group to see."""
        self.reaches(number, "ready")
        self.as_alice("packmerger", "jobs", "approve", number)
        self.reaches(number, "handed_over")
        self.assertTrue(list((self.machine.root / TRAYS.lstrip("/")).glob("*/tray.stl")))
        self.as_alice("test", "-r", f"{self.job(number)['folder']}/preview.png")

    def hands_over(self, number, name):
        self.drop("lab", name, stl(torus(10, 4)))
        self.approves(number)

    def answer(self, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{self.port}{path}", timeout=30) as reply:
            return reply.status, reply.read()

    def simulate(self, profile):
        """A printer on a pseudo-terminal that the service may open."""
        self.must("systemd-run", "--quiet", f"--unit={profile}", "--uid=packmerger", "--property=StandardOutput=file:/run/" + profile,
                  "packmerger", "simulate", profile, "--speed", "1" if profile == "marlin" else "inf")
        port = self.machine.root / "run" / profile
        return self.machine.wait_for(lambda: self.machine.run("cat", f"/run/{profile}").stdout.strip(), "its port")

    def test_from_install_to_purge(self):
        self.machine.run("apt-get", "update")
        self.installs()
        self.prepares_and_hands_over()
        self.refuses_a_mistake()
        self.upgrades_while_it_prints()
        self.prints_over_a_cable_what_it_sliced()
        self.confines_what_prepares()
        self.comes_back_after_a_removal()
        self.is_purged()

    def installs(self):
        self.apt("install", "/root/old.deb")
        self.lives()
        self.must("useradd", "--create-home", "--groups", "packmerger", "alice")
        if kernel_has_landlock():
            self.assertNotIn("no Landlock", self.journal())

    def prepares_and_hands_over(self):
        self.is_told_of_the_lab()
        self.drop("lab", "first.stl", stl(torus(10, 4)))
        self.machine.wait_for(lambda: self.job(1)["state"] == "ready" or self.service("NRestarts") != "0", "job 1", 600)
        if self.job(1)["state"] != "ready":
            self.is_cured_by_an_upgrade()
        self.approves(1)
        self.drop("lab", "waits.stl", stl(torus(10, 4)))
        self.reaches(2, "ready")
        self.assertIn(b"<!doctype html>", self.answer("/")[1].lower())
        self.lives()

    def is_told_of_the_lab(self):
        self.configure(LAB, PAGE.format(port=self.port))
        self.machine.wait_for(lambda: (self.machine.root / DROPS.lstrip("/") / "lab").is_dir(), "the watched folder")

    def is_cured_by_an_upgrade(self):
        """The older one's service is killed here as soon as it prepares; the newer one's goes on with that model. Who helped
        himself with an override has the older one, too."""
        self.apt("install", "/root/new.deb")
        self.approves(1)
        self.must("journalctl", "--rotate", "--vacuum-time=1s")  # what was killed before is not the newer one's
        self.lives()
        self.apt("purge", "packmerger")
        self.must("mkdir", "-p", "/etc/systemd/system/packmergerd.service.d")
        self.put("/etc/systemd/system/packmergerd.service.d/override.conf", OVERRIDE)
        self.apt("install", "/root/old.deb")
        self.is_told_of_the_lab()
        self.drop("lab", "first.stl", stl(torus(10, 4)))

    def refuses_a_mistake(self):
        settings = self.machine.root / SETTINGS.lstrip("/")
        good = settings.read_text()
        settings.write_text(good + "[printer.wrong]\n")
        self.assertNotEqual(self.machine.run("systemctl", "reload", "packmergerd").returncode, 0)
        settings.write_text(good)
        self.configure()
        self.lives()

    def upgrades_while_it_prints(self):
        """The daemon of before goes on with its print; a restart afterwards brings the new one, with all that was."""
        self.configure(CABLE.format(name="cable", profile="marlin", port=self.simulate("marlin")))
        self.machine.wait_for(lambda: (self.machine.root / DROPS.lstrip("/") / "cable").is_dir(), "the watched folder")
        self.drop("cable", "long.gcode", PROGRAM)
        self.reaches(3, "ready", "sending")
        if self.job(3)["state"] == "ready":
            self.as_alice("packmerger", "jobs", "approve", 3)
            self.reaches(3, "sending")
        before, settings = self.service("MainPID"), (self.machine.root / SETTINGS.lstrip("/")).read_text()
        self.assertIn("packmergerd prints", self.apt("install", "/root/new.deb"))
        for verb, told in (("jobs", "long.gcode"), ("printers", "cable")):  # the new programs ask the daemon of before
            self.assertIn(told, self.as_alice("packmerger", verb, "list"))
            self.as_alice("packmerger", verb, "list", "--json")
        self.drop("lab", "meanwhile.stl", stl(torus(10, 4)))  # the daemon of before has it prepared by what is installed now
        self.reaches(4, "ready")
        self.assertEqual(self.service("MainPID"), before)
        self.reaches(3, "done")
        self.must("systemctl", "restart", "packmergerd")
        self.assertNotEqual(self.service("MainPID"), before)
        version = self.must("dpkg-deb", "--field", "/root/new.deb", "Version")
        self.assertEqual(self.must("dpkg-query", "--show", "--showformat=${Version}", "packmerger"), version)
        self.assertEqual((self.machine.root / SETTINGS.lstrip("/")).read_text(), settings)
        self.assertEqual([self.job(number)["state"] for number in (1, 2, 3, 4)],
                         ["handed_over", "ready", "done", "ready"])
        self.lives()
        self.keeps_what_waited()
        self.apt("reinstall", "/root/new.deb")  # nothing prints: it restarts the daemon by itself
        self.assertIn("first.stl", self.as_alice("packmerger", "jobs", "list"))
        self.lives()
        self.hands_over(5, "second.stl")

    def keeps_what_waited(self):
        """What the daemon before prepared is handed over, and settings that do not say whom the page trusts trust as they did."""
        for number in (2, 4):
            self.approves(number)
        self.assertIn("trust_local", self.journal())
        self.assertEqual(self.answer("/api/v1/jobs")[0], 200)
        settings = self.machine.root / SETTINGS.lstrip("/")
        settings.write_text(settings.read_text().replace("[web]\nport", "[web]\ntrust_local = false\nport"))
        self.configure()
        self.assertIn(f"127.0.0.1:{self.port}", self.must("packmerger", "keys", "link").replace("localhost", "127.0.0.1"))
        with self.assertRaises(urllib.error.HTTPError):
            self.answer("/api/v1/jobs")

    def prints_over_a_cable_what_it_sliced(self):
        """With the slicer and gpx, which came along."""
        self.configure(CABLE.format(name="replicator", profile="replicator", port=self.simulate("replicator")))
        self.machine.wait_for(lambda: (self.machine.root / DROPS.lstrip("/") / "replicator").is_dir(), "the watched folder")
        self.drop("replicator", "third.stl", stl(torus(10, 4)))
        self.reaches(6, "ready", "done", "sending", "approved")
        if self.job(6)["state"] == "ready":
            self.as_alice("packmerger", "jobs", "approve", 6)
        self.reaches(6, "done")
        self.lives()

    def confines_what_prepares(self):
        if not kernel_has_landlock():
            return
        self.put("/usr/local/bin/probe", PROBE, "755")
        self.configure('\n[prepare]\nprogram = "/usr/local/bin/probe"\n')
        self.drop("lab", "probed.stl", stl(torus(10, 4)))
        self.reaches(7, "failed")
        self.assertIn("confined as it should be", self.job(7)["reason"])
        self.assertFalse((self.machine.root / STATE.lstrip("/") / "escaped").exists())

    def comes_back_after_a_removal(self):
        self.apt("remove", "packmerger")
        self.assertEqual(self.service("ActiveState"), "inactive")
        for path, stays in (("/usr/bin/packmergerd", False), (SETTINGS, True), (f"{STATE}/jobs.sqlite", True)):
            self.assertEqual((self.machine.root / path.lstrip("/")).exists(), stays, path)
        self.apt("install", "/root/new.deb")
        self.lives()
        self.assertIn("first.stl", self.as_alice("packmerger", "jobs", "list"))

    def is_purged(self):
        """The models that people dropped stay; all else goes."""
        self.apt("purge", "packmerger")
        state = self.machine.root / STATE.lstrip("/")
        self.assertEqual([path.name for path in state.iterdir()], ["folders"])
        self.assertTrue((state / "folders/lab/done/first.stl").exists())
        self.assertFalse((self.machine.root / "etc/packmerger").exists())
        self.assertNotIn("packmergerd", self.machine.run("systemctl", "list-unit-files", "--no-legend").stdout)


if __name__ == "__main__":
    reason = debian_machine.missing()
    if not reason and not os.environ.get("PACKMERGER_LONG"):
        reason = "it can run here, and takes some ten minutes: cmake --build build --target long_package runs it"
    if reason:
        print(f"skipped: {reason}", file=sys.stderr)
        sys.exit(program.SKIPPED)
    unittest.main()
