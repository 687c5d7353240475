#!/usr/bin/python3
"""From a slicer's button to the print: nothing starts on a bed that nobody declared clear, or unasked."""
import json
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
import slicer_wire as wire
from web_daemon import SETTINGS, Daemon, wait_for

BASE = "/printers/lab"
MOVES = [f"G1 X{20 + i % 40} Y{20 + i % 7} E{i / 50:.2f} F6000" for i in range(300)]
GCODE = "\n".join(["G28", "G92 E0", *MOVES, "M84", ""]).encode()


class Print(unittest.TestCase):
    def begin(self, approve, speed=1000):
        folder = pathlib.Path(program.tempfile.mkdtemp(prefix="packmerger-print-"))
        self.addCleanup(program.shutil.rmtree, folder)
        self.record = folder / "record.txt"
        printer = program.Background(self, "packmerger", "simulate", "marlin", "--speed", speed, "--record", self.record, log=folder / "log")
        port = printer.child.stdout.readline().strip()
        settings = SETTINGS.replace("PREPARE", program.binary())
        self.daemon = Daemon(settings + f'[printer.lab]\nprofile = "marlin"\nport = "{port}"\napprove = "{approve}"\n')
        self.addCleanup(self.daemon.close)

    def send(self, wants_print, name=b"part.gcode", program=GCODE):
        form = wire.form(wire.octoprint_fields(wants_print), name, program)
        status, body, headers = self.daemon.ask("POST", BASE + "/api/files/local", form,
                                                {"Content-Type": "multipart/form-data; boundary=" + wire.BOUNDARY.decode()})
        self.assertEqual(status, 201, body)
        self.assertFalse(json.loads(body)["effectivePrint"])
        return json.loads(body)["files"]["local"]["job"], headers["Location"]

    def job(self, number):
        return json.loads(self.daemon.ask("GET", f"/api/v1/jobs/{number}")[1])

    def waits(self, number, what):
        wait_for(lambda: self.job(number)["waits_for"] == what, f"the job to wait for {what}")
        self.assertFalse(self.printed())

    def printed(self):
        return [line for line in self.record.read_text().splitlines() if line.startswith("G1 X")] if self.record.exists() else []

    def clear(self):
        self.assertEqual(self.daemon.ask("POST", "/api/v1/printers/lab/clear")[0], 200)

    def test_upload_and_print_waits_for_a_clear_bed(self):
        self.begin("auto")
        number, _ = self.send(True)
        self.waits(number, "clear_bed")
        self.clear()
        wait_for(lambda: self.job(number)["state"] == "done", "the print")
        self.assertEqual(self.printed(), MOVES)
        second, _ = self.send(True)
        wait_for(lambda: self.job(second)["waits_for"] == "clear_bed", "the next to wait")
        self.assertEqual(self.printed(), MOVES)

    def test_upload_alone_prints_nothing_although_the_settings_are_auto(self):
        self.begin("auto")
        self.clear()
        number, location = self.send(False)
        self.waits(number, "hold")
        status = self.daemon.ask("POST", location, json.dumps({"command": "select", "print": True}))[0]
        self.assertEqual(status, 204, "now the user wants it")
        wait_for(lambda: self.job(number)["state"] == "done", "the print")
        self.assertEqual(self.printed(), MOVES)

    def test_settings_that_ask_are_obeyed(self):
        self.begin("ask")
        self.clear()
        number, location = self.send(True)
        self.waits(number, "approval")
        status, body, _ = self.daemon.ask("POST", location, json.dumps({"command": "select", "print": True}))
        self.assertEqual(status, 409, body)
        self.waits(number, "approval")

    def test_a_doubt_is_not_approved_by_a_button_that_does_not_show_it(self):
        self.begin("auto")
        self.clear()
        number, location = self.send(False, program=b"G28\nG1 X680 F6000\n")
        self.waits(number, "hold")
        status, body, _ = self.daemon.ask("POST", location, json.dumps({"command": "select", "print": True}))
        self.assertEqual(status, 409, body)
        self.assertEqual(self.daemon.ask("POST", f"/api/v1/jobs/{number}/cancel")[0], 200)
        status, body, _ = self.daemon.ask("POST", f"/api/v1/jobs/{number}/again?starts=0")
        self.assertEqual(status, 200, body)
        again = json.loads(body)["id"]
        self.waits(again, "approval")
        self.assertIn("680", self.job(again)["doubt"])
        status, body, _ = self.daemon.ask("POST", f"/api/v1/jobs/{again}/approve?starts=0")
        self.assertEqual(status, 409, body)
        self.assertEqual(json.loads(body)["error"]["starts"]["job"], again)

    def test_the_monitor_of_a_slicer(self):
        self.begin("auto", speed=1)
        self.clear()
        number, _ = self.send(True)

        def ask(path):
            status, body, _ = self.daemon.ask("GET", BASE + path)
            return json.loads(body) if status == 200 else {}

        wait_for(lambda: ask("/api/job").get("state") == "Printing", "the print")
        job = ask("/api/job")
        self.assertEqual(job["job"]["file"]["name"], "part.gcode")
        self.assertGreaterEqual(job["progress"]["completion"], 0)
        self.assertTrue(ask("/api/printer")["state"]["flags"]["printing"])
        for action, state in (("pause", "Paused"), ("resume", "Printing"), ("toggle", "Paused")):
            status = self.daemon.ask("POST", BASE + "/api/job", json.dumps({"command": "pause", "action": action}))[0]
            self.assertEqual(status, 204)
            wait_for(lambda: ask("/api/job").get("state") == state, state)
        self.assertTrue(ask("/api/printer")["state"]["flags"]["paused"])
        self.assertEqual(self.daemon.ask("POST", BASE + "/api/job", json.dumps({"command": "start"}))[0], 409)
        self.assertEqual(self.daemon.ask("POST", BASE + "/api/job", json.dumps({"command": "cancel"}))[0], 204)
        wait_for(lambda: self.job(number)["state"] == "cancelled", "its end")
        self.assertEqual(self.daemon.ask("POST", BASE + "/api/job", json.dumps({"command": "cancel"}))[0], 409)


if __name__ == "__main__":
    unittest.main()
