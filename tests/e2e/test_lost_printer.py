#!/usr/bin/python3
"""Printers that are killed in the middle of a print, and ports that two want: `send`, the daemon and the simulated
printers as processes of their own."""
import hashlib
import json
import os
import pathlib
import re
import struct
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program

PATIENCE_S = 60
FAILED, BUSY = 74, 75
MOVES = 3000
MODEL = bytes(80) + struct.pack("<I", 1) + bytes(50)  # an STL of one triangle
SOON_S = 5  # a printer that is gone is told within
IDLE_S = 1.0  # of processor time: far less than spinning would take


def gcode():
    return "".join(f"{line}\n" for line in ["G28", *(f"G1 X{i % 200} Y{i % 150} F9000" for i in range(MOVES)), "M84"])


def x3g():
    """Moves of 2 mm at 40 mm/s."""
    moves = (struct.pack("<B5iIBfH", 0x9B, 1000 + 190 * i, 50, 80, 0, 0, 3000, 0x18, 2.0, 40 * 64) for i in range(MOVES))
    return b"\x99\0\0\0\0lost\0" + b"".join(moves) + b"\x9A\0"


def processor_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Silent:
    """A terminal behind which nobody answers."""

    def __init__(self, test):
        self.host, self.printer = os.openpty()
        self.name = os.ttyname(self.printer)
        test.addCleanup(self.go)

    def go(self):
        for descriptor in (self.host, self.printer):
            if descriptor is not None:
                os.close(descriptor)
        self.host = self.printer = None


class LostPrinter(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-lost-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.port = self.folder / "port"  # stays the same, as /dev/serial/by-id does
        self.printers = 0

    def job(self, profile, name="job"):
        folder = self.folder / name
        folder.mkdir()
        shown = program.run("profiles", "show", profile)
        self.assertEqual(shown.code, 0, str(shown))
        (folder / "profile.toml").write_text(re.sub(r"(?m)^boot_wait_s *= *\S+", "boot_wait_s = 0.1", shown.out))
        (folder / "job.json").write_text(json.dumps(
            {"version": 1, "variant": "packed", "inputs": [{"file": "a.stl", "sha256": hashlib.sha256(MODEL).hexdigest(),
                                                             "scale": 1}],
             "parts": [{"id": 1, "tray": 1}], "estimates": {"packed": {"fits": True, "time_s": 60, "cost": 1}}}))
        if profile == "marlin":
            (folder / "program.gcode").write_text(gcode())
        else:
            (folder / "program.x3g").write_bytes(x3g())
        return folder

    def printer(self, profile, speed):
        """A simulated printer at self.port, and its record."""
        self.printers += 1
        record = self.folder / f"record-{self.printers}.txt"
        running = program.Background(self, "packmerger", "simulate", profile, "--speed", speed, "--record", record,
                                     log=self.folder / "simulator.log")
        address = running.child.stdout.readline().strip()
        self.port.unlink(missing_ok=True)
        self.port.symlink_to(address)
        return running, record

    def sending(self, job):
        return program.Background(self, "packmerger", "send", job, "--port", self.port, log=self.folder / "send.log")

    def wait_for(self, holds, told=lambda: ""):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            if holds():
                return
            time.sleep(0.05)
        self.fail(f"it did not happen; {told()}")

    def wait_for_moves(self, record, told=lambda: ""):
        self.wait_for(lambda: record.exists() and len(record.read_text().splitlines()) > 20, told)

    def lost_while_sending(self, profile):
        job = self.job(profile)
        printer, record = self.printer(profile, speed=10)
        send = self.sending(job)
        self.wait_for_moves(record)
        used_before_s = processor_s(send.child.pid)
        printer.child.kill()
        killed_at = time.monotonic()
        _, status, usage = os.wait4(send.child.pid, 0)
        send.child.returncode = os.waitstatus_to_exitcode(status)
        self.assertLess(time.monotonic() - killed_at, SOON_S)
        self.assertEqual(send.child.returncode, FAILED)
        self.assertIn("is gone", (self.folder / "send.log").read_text())
        self.assertLess(usage.ru_utime + usage.ru_stime - used_before_s, IDLE_S)
        _, record = self.printer(profile, speed="inf")
        again = program.run("send", job, "--port", self.port)
        self.assertEqual(again.code, 0, str(again))
        executed = record.read_text()
        if profile == "marlin":
            self.assertIn(gcode(), executed.replace("M105\n", ""))
        else:
            self.assertEqual(bytes.fromhex(executed), x3g())

    def test_marlin_is_killed_while_sending(self):
        self.lost_while_sending("marlin")

    def test_replicator_is_killed_while_sending(self):
        self.lost_while_sending("replicator")

    def test_a_second_send_is_refused_and_disturbs_nothing(self):
        job = self.job("marlin")
        _, record = self.printer("marlin", speed=8)
        send = self.sending(job)
        self.wait_for_moves(record)
        for _ in range(2):
            second = program.run("send", job, "--port", self.port)
            self.assertEqual(second.code, BUSY, str(second))
        self.assertIsNone(send.child.poll(), "the first one still prints")
        self.assertEqual(send.child.wait(timeout=PATIENCE_S), 0)
        own = {"M105", "M115", "M27", "M110 N0", "M114", "M155 S2", "M155 S0", "M400"}
        executed = [line for line in record.read_text().splitlines() if line not in own]
        self.assertEqual(executed, gcode().splitlines())

    def daemon(self, name, simulated=True):
        folder = self.folder / name
        folder.mkdir()
        prepare = folder / "prepare.py"  # stands in for packmerger prepare: the job is there already
        prepare.write_text("#!/usr/bin/python3\nimport subprocess, sys\n"
                           f"subprocess.run(['cp', '-r', '{self.folder / 'job'}', sys.argv[sys.argv.index('--out') + 1]], check=True)\n")
        prepare.chmod(0o755)
        config = folder / "d.toml"
        config.write_text(f"""
state = "state"
retry_s = 0.5
[prepare]
program = "{prepare}"
[watch]
still_s = 0.2
rescan_s = 1
[printer.m]
profile = "marlin"
port = "{self.port}"
approve = "auto"
simulated = {str(simulated).lower()}
""")
        running = program.Background(self, "packmergerd", "--config", config, log=folder / "daemon.log")
        running.socket = ("--socket", folder / "state" / "packmergerd.sock")
        self.wait_for(lambda: program.run("printers", "list", *running.socket).code == 0)
        model = folder / "state" / "folders" / "m" / "ball.stl"
        model.write_bytes(MODEL)
        return running

    def shown(self, daemon, number=1):
        told = program.run("jobs", "show", str(number), "--json", *daemon.socket)
        return json.loads(told.out) if told.code == 0 else {"state": "none"}

    def test_the_daemons_printer_is_killed(self):
        self.job("marlin")
        printer, record = self.printer("marlin", speed=10)
        daemon = self.daemon("daemon")
        self.wait_for_moves(record, lambda: self.shown(daemon))
        other = self.daemon("other")
        self.wait_for(lambda: "held by another program" in self.shown(other).get("status", ""),
                      lambda: self.shown(other))
        self.assertEqual(program.run("send", self.folder / "job", "--port", self.port).code, BUSY)
        self.assertEqual(self.shown(daemon)["state"], "sending")
        other.end()

        used_before_s = processor_s(daemon.child.pid)
        printer.child.kill()
        killed_at = time.monotonic()
        self.wait_for(lambda: self.shown(daemon)["state"] == "failed", lambda: self.shown(daemon))
        self.assertLess(time.monotonic() - killed_at, SOON_S)
        self.assertIn("is gone", json.dumps(self.shown(daemon)))
        time.sleep(2)
        self.assertLess(processor_s(daemon.child.pid) - used_before_s, IDLE_S)

        _, record = self.printer("marlin", speed="inf")
        self.assertEqual(program.run("jobs", "again", "1", *daemon.socket).code, 0)
        self.wait_for(lambda: self.shown(daemon, 2)["state"] == "done", lambda: self.shown(daemon, 2))
        self.assertIn(gcode(), record.read_text().replace("M105\n", ""))
        self.assertEqual(daemon.end(), 0)

    def bed(self, daemon):
        told = json.loads(program.run("printers", "list", "--json", *daemon.socket).out)
        return next(printer["bed"] for printer in told if printer["name"] == "m")

    def connects(self, daemon):
        job = self.shown(daemon)
        return job["state"] == "sending" and job["progress"]["stage"] == "connecting"

    def test_what_ends_before_it_began_leaves_the_bed_clear(self):
        self.job("marlin")
        silent = Silent(self)
        self.port.symlink_to(silent.name)
        daemon = self.daemon("daemon", simulated=False)
        self.assertEqual(program.run("printers", "clear", "m", *daemon.socket).code, 0)
        self.wait_for(lambda: self.connects(daemon), lambda: self.shown(daemon))
        silent.go()
        # by the history: it is tried again soon, and then its reason is another
        self.wait_for(lambda: any("is gone" in event["note"] for event in self.shown(daemon)["history"]),
                      lambda: self.shown(daemon))
        # while it is tried again the bed is taken for a moment
        self.wait_for(lambda: (self.shown(daemon)["state"], self.bed(daemon)) == ("approved", "clear"),
                      lambda: self.shown(daemon))

        self.port.unlink()
        self.port.symlink_to(Silent(self).name)
        self.wait_for(lambda: self.connects(daemon), lambda: self.shown(daemon))
        self.assertEqual(program.run("jobs", "cancel", "1", *daemon.socket).code, 0)
        self.wait_for(lambda: self.shown(daemon)["state"] == "cancelled", lambda: self.shown(daemon))
        self.assertEqual(self.shown(daemon)["reason"], "cancelled before the print began")
        self.assertEqual((self.shown(daemon)["told"], self.bed(daemon)), (None, "clear"))
        self.assertEqual(daemon.end(), 0)


if __name__ == "__main__":
    unittest.main()
