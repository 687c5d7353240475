#!/usr/bin/python3
"""The programs of an upgrade speak to the daemon of before it, which goes on with its print: it knows fewer verbs, and tells
less."""
import json
import pathlib
import socketserver
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program

JOBS = [{"id": 7, "printer": "lab", "name": "a.stl", "state": "sending", "status": "printing 42 %"}]
PRINTERS = [{"name": "lab", "profile": "ender3", "approve": "auto", "bed": "not clear", "port": "/dev/ttyUSB0", "job": 7,
             "folder": "/srv/lab", "trouble": "its folder does not answer"}]
UNKNOWN = {"ok": False, "error": {"fault": 2, "what": "The request's verb is unknown", "hint": "docs/DAEMON.md lists the requests."}}


class Older(socketserver.StreamRequestHandler):
    def handle(self):
        told = {"jobs.list": JOBS, "printers.list": PRINTERS}.get(json.loads(self.rfile.readline())["verb"])
        self.wfile.write(json.dumps(UNKNOWN if told is None else {"ok": True, "result": told}).encode() + b"\n")


class AnOlderDaemon(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="packmerger-older-")
        self.addCleanup(folder.cleanup)
        self.socket = str(pathlib.Path(folder.name) / "socket")
        server = socketserver.ThreadingUnixStreamServer(self.socket, Older)
        self.addCleanup(server.server_close)
        self.addCleanup(server.shutdown)
        threading.Thread(target=server.serve_forever, daemon=True).start()

    def says(self, *arguments):
        result = program.run(*arguments, "--socket", self.socket)
        self.assertEqual((result.code, result.err), (0, ""))
        return result.out

    def test_lists_are_told_as_far_as_it_tells_them(self):
        self.assertIn("printing 42 %", self.says("jobs", "list"))
        self.assertIn("job 7; its folder does not answer", self.says("printers", "list"))
        self.assertEqual(json.loads(self.says("jobs", "list", "--json")), JOBS)
        self.assertEqual(json.loads(self.says("printers", "list", "--json")), PRINTERS)

    def test_what_it_does_not_know_is_told_with_the_way_out(self):
        for arguments in (["jobs", "first", "7"], ["jobs", "prepare", "7", "--variant", "hollow"], ["jobs", "delete", "7"]):
            result = program.run(*arguments, "--socket", self.socket)
            self.assertEqual((result.code, result.out), (2, ""))
            self.assertIn(f'older than this program, and does not know "jobs {arguments[1]}"', result.err)
            self.assertIn("systemctl restart packmergerd", result.err)
            self.assertIn("cancels what is being printed", result.err)


if __name__ == "__main__":
    unittest.main()
