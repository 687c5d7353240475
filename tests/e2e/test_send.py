#!/usr/bin/python3
"""send as a person uses it: at a terminal with Ctrl-C, without one, and killed in the middle."""
import json
import os
import pathlib
import pty
import re
import select
import signal
import subprocess
import tempfile
import termios
import time
import tty
import unittest

import program
from stuck_printer import StuckPrinter

PATIENCE_S = 60
LEAVES_S = 20  # of a profile with 30 s of patience
SAFE = b"\nM410\nM108\nM104 S0\nM140 S0\nM107\nM84\n"


def write_job(folder, lines):
    folder.mkdir()
    profile = (program.SOURCE / "profiles" / "marlin.toml").read_text()
    (folder / "profile.toml").write_text(profile.replace("boot_wait_s = 2", "boot_wait_s = 0.1"))
    (folder / "program.gcode").write_text("\n".join(lines) + "\n")
    (folder / "job.json").write_text(json.dumps({
        "version": 1, "inputs": [{"file": "model.stl", "sha256": "0"}], "parts": [{"tray": 1}],
        "variant": "packed", "estimates": {}}))
    return folder


def moves(count):
    """60 mm at 60 mm/s each."""
    return [f"G1 X{60 * (i % 2)} F3600 ; {i}" for i in range(1, count + 1)]


class Sending(unittest.TestCase):
    def setUp(self):
        place = tempfile.TemporaryDirectory()
        self.addCleanup(place.cleanup)
        self.folder = pathlib.Path(place.name)

    def start(self, argv, **options):
        child = subprocess.Popen([program.binary(), *map(str, argv)], start_new_session=True, **options)
        self.addCleanup(lambda: (child.poll() is None and child.kill(), child.wait()))
        return child

    def simulated(self):
        record = self.folder / "record.txt"
        printer = self.start(["simulate", "marlin", "--record", record], stdout=subprocess.PIPE, text=True)
        self.addCleanup(printer.stdout.close)
        return printer.stdout.readline().strip(), record

    def wait_for(self, holds, what):
        end = time.monotonic() + PATIENCE_S
        while not holds():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.05)

    def at_terminal(self, job, port):
        """send with a terminal of its own; returns it, a reader of what it shows, and a way to type."""
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        child = self.start(["send", job, "--port", port], stdin=slave, stdout=slave, stderr=slave,
                           preexec_fn=lambda: os.set_inheritable(slave, True))
        os.close(slave)
        shown = bytearray()

        def shows(text, times=1):
            while select.select([master], [], [], 0)[0]:
                try:
                    shown.extend(os.read(master, 4096))
                except OSError:
                    break
            return shown.decode(errors="replace").count(text) >= times

        return child, shows, lambda text: os.write(master, text.encode())

    def test_ctrl_c_pauses_and_asks_then_cancels(self):
        job = write_job(self.folder / "job", moves(500))
        port, record = self.simulated()
        child, shows, write = self.at_terminal(job, port)
        self.wait_for(lambda: shows("printing, 1"), "it prints")
        self.assertTrue(shows(" left"), "and says how long it will take")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: shows("g: go on, c: cancel, s: stop at once?"), "it asks")
        self.wait_for(lambda: "M400" in record.read_text(), "it pauses")
        write("g\n")
        printed = record.read_text().count("G1")
        self.wait_for(lambda: record.read_text().count("G1") > printed + 2, "it goes on")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: record.read_text().count("M400") == 2, "it pauses again")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: child.poll() is not None, "it ends")
        self.assertEqual(child.returncode, 130)
        self.assertTrue(shows("Cancelling"))
        executed = record.read_text().splitlines()
        self.assertEqual(executed.count("M140 S0"), 1, "heaters off")
        self.assertLess(executed.count("G1 X60 F3600"), 250)

    def test_a_question_of_the_printer_is_asked_again_behind_a_pause(self):
        job = write_job(self.folder / "job", ["G28", "M600", *moves(3)])
        port, record = self.simulated()
        child, shows, write = self.at_terminal(job, port)
        self.wait_for(lambda: shows("Your answer"), "the printer asks")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: shows("s: stop at once?"), "the pause asks")
        write("g\n")
        self.wait_for(lambda: shows("Your answer", 2), "the printer's question stands again")
        write("0\n")
        self.wait_for(lambda: shows("1: Continue"), "its second question")
        write("1\n")
        self.wait_for(lambda: child.poll() is not None, "it ends")
        self.assertEqual(child.returncode, 0)
        self.assertEqual(record.read_text().count("G1"), 3)

    def test_stop_at_once(self):
        job = write_job(self.folder / "job", moves(500))
        port, record = self.simulated()
        child, shows, write = self.at_terminal(job, port)
        self.wait_for(lambda: shows("printing, 1"), "it prints")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: shows("s: stop at once?"), "it asks")
        write("s\n")
        self.wait_for(lambda: child.poll() is not None, "it ends")
        self.assertEqual(child.returncode, 74)
        self.wait_for(lambda: record.read_text().endswith("halt\n"), "the printer has halted")

    def test_without_a_terminal_the_first_cancels(self):
        job = write_job(self.folder / "job", moves(500))
        port, record = self.simulated()
        child = self.start(["send", job, "--port", port], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.addCleanup(child.stderr.close)
        self.wait_for(lambda: "G1" in record.read_text(), "it prints")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: child.poll() is not None, "it ends")
        self.assertEqual(child.returncode, 130)
        self.assertEqual(record.read_text().splitlines().count("M140 S0"), 1, "heaters off")

    def stuck(self):
        """A printer that takes lines until it is to wait for heat, and then neither answers nor obeys."""
        printer = StuckPrinter(self)
        return printer, write_job(self.folder / "job", ["M140 S60", "M190 S60", *moves(10)])

    def stuck_without_a_terminal(self):
        printer, job = self.stuck()
        errors = self.folder / "errors.txt"
        with open(errors, "wb") as stderr:
            child = self.start(["send", job, "--port", printer.name], stdin=subprocess.DEVNULL, stderr=stderr)
        self.wait_for(lambda: b"M190" in printer.heard, "it heats")
        return printer, child, errors

    def expect_left(self, child, begun, told):
        self.wait_for(lambda: child.poll() is not None, "it ends")
        self.assertLess(time.monotonic() - begun, LEAVES_S, "a cancel would wait for the printer")
        self.assertEqual(child.returncode, 130)
        self.assertIn("heaters may be on", told())

    def test_two_interrupts_write_the_safe_text_and_wait_for_nothing(self):
        printer, child, errors = self.stuck_without_a_terminal()
        begun = time.monotonic()
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: b"M108" in printer.heard, "it cancels")
        self.assertNotIn(b"\nM104 S0\n", printer.heard)
        child.send_signal(signal.SIGINT)
        self.expect_left(child, begun, lambda: errors.read_text())
        self.wait_for(lambda: SAFE in printer.heard, "without numbers, so that it is obeyed whatever was lost")

    def test_the_third_ctrl_c_writes_the_safe_text_and_waits_for_nothing(self):
        printer, job = self.stuck()
        child, shows, _ = self.at_terminal(job, printer.name)
        self.wait_for(lambda: b"M190" in printer.heard, "it heats")
        begun = time.monotonic()
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: shows("c: cancel"), "it asks")
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: b"M108" in printer.heard, "it cancels")
        child.send_signal(signal.SIGINT)
        self.expect_left(child, begun, lambda: "heaters may be on" if shows("heaters may be on") else "")
        self.wait_for(lambda: SAFE in printer.heard, "the safe text")

    def test_a_port_that_takes_nothing_is_left_and_told(self):
        printer, child, errors = self.stuck_without_a_terminal()
        termios.tcflow(printer.slave, termios.TCOOFF)
        begun = time.monotonic()
        child.send_signal(signal.SIGINT)
        self.wait_for(lambda: "cancelling" in errors.read_text(), "it cancels")
        child.send_signal(signal.SIGINT)
        self.expect_left(child, begun, lambda: errors.read_text())

    def test_killed_send_leaves_what_was_acknowledged(self):
        """This printer takes exactly 23 lines of the program and then says nothing."""
        job = write_job(self.folder / "job", moves(100))
        master, slave = pty.openpty()
        self.addCleanup(os.close, master)
        self.addCleanup(os.close, slave)
        tty.setraw(slave, termios.TCSANOW)
        child = self.start(["send", job, "--port", os.ttyname(slave)], stdin=subprocess.DEVNULL,
                           stderr=subprocess.DEVNULL)
        heard, acknowledged, silent, end = b"", 0, False, time.monotonic() + PATIENCE_S
        while not silent:
            self.assertLess(time.monotonic(), end)
            if not select.select([master], [], [], 0.1)[0]:
                continue
            heard += os.read(master, 4096)
            *lines, heard = heard.split(b"\n")
            for line in lines:
                of_program = re.match(rb"N[1-9]\d* (?!M105)", line)
                if silent := silent or (of_program and acknowledged >= 23):
                    continue
                acknowledged += 1 if of_program else 0
                os.write(master, b"FIRMWARE_NAME:Fake\nok\n" if line == b"M115" else line and b"ok\n")
        child.send_signal(signal.SIGKILL)
        child.wait()
        self.assertEqual((job / "sent-1.progress").read_text(), "acknowledged 000000000023 of 000000000100\n")


if __name__ == "__main__":
    unittest.main()
