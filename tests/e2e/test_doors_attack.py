#!/usr/bin/python3
"""The attack pack at the daemon's doors: none of it may lead elsewhere, take memory or start a print."""
import json
import pathlib
import socket
import subprocess
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
import slicer_wire as wire
from web_daemon import SETTINGS, STL, Case, Daemon, wait_for

BASE = "/printers/objet"
WAYS_UP = ["../", "..%2f", "%2e%2e/", "%2e%2e%2f", "..%5c", "%252e%252e%252f", "....//", ".%00./"]
DOORS = ["/api/version", "/api/files/local", "/api/files/local/x.stl", "/api/v1/files/local/x.stl", "/api/v1/storage",
         "/server/info", "/server/files/upload", "/api/login", "/api/settings", "/api/printer", "/api/job",
         "/api/printerprofiles", "/api/currentuser", "/api/server"]


class Attack(Case):
    def raw(self, data, patience=2):
        return self.daemon.raw(data, patience)

    def assert_secret(self, content, what):
        for text in (b"secret", b"sha256", b"root:", b"SQLite", b"[printer"):
            self.assertNotIn(text, content, what)

    def uploads(self):
        folder = self.daemon.folder / "state/uploads"
        return list(folder.iterdir()) if folder.is_dir() else []

    def test_every_door_needs_a_key(self):
        for door in DOORS:
            for method in ("GET", "POST", "PUT", "DELETE", "PATCH", "HEAD", "OPTIONS"):
                status = self.daemon.ask(method, BASE + door, key=False)[0]
                self.assertIn(status, (401, 405), (method, door))
                self.assertNotEqual(status, 200)

    def test_foreign_names_and_pages(self):
        for door in DOORS:
            for head in (b"Host: evil.example\r\n", b"Host: localhost\r\nOrigin: http://evil.example\r\n"):
                answer = self.raw(b"GET " + (BASE + door).encode() + b" HTTP/1.1\r\n" + head + b"X-Api-Key: "
                                  + self.daemon.key.encode() + b"\r\nConnection: close\r\n\r\n")
                self.assertRegex(answer[:13], rb"HTTP/1.1 403", door)
                self.assertNotIn(b"Access-Control", answer)

    def test_traversal(self):
        head = f" HTTP/1.1\r\nHost: localhost\r\nX-Api-Key: {self.daemon.key}\r\nConnection: close\r\nContent-Length: "
        count = 0
        for up in WAYS_UP:
            for goal in ("secret", "c.toml", "state/keys.json", "../../etc/passwd.stl", "state/jobs.sqlite"):
                for base in ("/printers/", BASE + "/", BASE + "/api/files/local/", BASE + "/api/v1/files/local/"):
                    for method, body in (("GET", ""), ("PUT", "x")):
                        answer = self.raw(f"{method} {base}{up * 3}{goal}{head}{len(body)}\r\n\r\n{body}".encode())
                        self.assertNotRegex(answer[:13], rb"HTTP/1.1 20", (method, base, up, goal))
                        self.assert_secret(answer, (method, base, up, goal))
                        count += 1
        self.assertGreaterEqual(count, 300)
        self.assertFalse(self.uploads())

    def test_names_never_become_paths(self):
        below = set(program.files_below(self.daemon.folder / "state/folders"))
        for name in (b"../../x.stl", b"/etc/x.stl", b"..\\x.stl", b"%2e%2e%2fx.stl", b".hidden.stl", b"~x.stl", b"$(reboot).stl",
                     b"x\\x00.stl", b"\xff\xfe.stl", b"." * 50 + b".stl", b"a" * 5000 + b".stl", b"x.stl/..", b'part \\"q\\".stl',
                     b'x\\"/../../y.stl', b'\\"; filename=\\"../../z.stl', b"%22/../../w.stl", b"x%22%2f..%2fv.stl", b'end\\',
                     "‮lts.stl".encode(), b"<img src=x onerror=alert(1)>.stl", b"a\tb.stl", "ü".encode() * 200 + b".stl"):
            for target, fields in (("/api/files/local", wire.octoprint_fields(True, b"../../../etc")),
                                   ("/server/files/upload", [(b"root", b"gcodes"), (b"path", b"/etc"), (b"print", b"true")])):
                form = wire.form(fields, name, STL)
                status, content, headers = self.daemon.ask("POST", BASE + target, form, {"Content-Type": "multipart/form-data; boundary=" + wire.BOUNDARY.decode()})
                self.assertIn(status, (201, 400, 413, 415, 422), (name, content))
                self.assertNotIn("html", headers["Content-Type"], name)
                self.assert_secret(content, name)
                if status == 201:
                    told = json.loads(content)
                    self.assertNotIn("/", told.get("item", told.get("files", {}).get("local"))["path"])
        stray = set(program.files_below(self.daemon.folder / "state/folders")) - below
        self.assertFalse([one for one in stray if "/failed" not in one])

    def test_reserved_and_repeated_fields(self):
        """OctoPrint hands file.path and file.name from its front to its back; here they are fields like any other."""
        headers = {"Content-Type": "multipart/form-data; boundary=" + wire.BOUNDARY.decode()}
        for field in (b"file.path", b"file.name", b"file.size", b"file.content_type", b"path", b"foldername", b"userdata", b"select",
                      b"plateindex", b"noOverwrite", b"printer", b"approve", b"held", b"id", b"__proto__"):
            form = wire.form([(b"print", b"false"), (field, b"/etc/passwd")], b"a.stl", STL)
            status, content, _ = self.daemon.ask("POST", BASE + "/api/files/local", form, headers)
            self.assertEqual(status, 201, (field, content))
            job = json.loads(self.daemon.ask("GET", f"/api/v1/jobs/{json.loads(content)['files']['local']['job']}")[1])
            self.assertEqual((job["name"], job["printer"], job["held"]), ("a.stl", "objet", True), field)
            # and as a file
            form = wire.form([(b"print", b"true")], b"a.stl", STL).replace(b'name="file"', b'name="' + field + b'"')
            self.assertIn(self.daemon.ask("POST", BASE + "/api/files/local", form, headers)[0], (201, 400))
        two = wire.form([], b"a.stl", STL)[:-len(wire.BOUNDARY) - 6] + wire.form([], b"b.stl", STL)
        self.assertEqual(self.daemon.ask("POST", BASE + "/api/files/local", two, headers)[0], 400)

    def test_lying_lengths(self):
        key = self.daemon.key
        jobs = len(json.loads(self.daemon.ask("GET", "/api/v1/jobs?limit=1000")[1]))
        target = BASE + "/api/v1/files/local/lie.stl"
        short = wire.put_headers(target, key, len(STL) + 1000).replace(b"Expect: 100-continue\r\n", b"") + STL
        self.assertNotIn(b" 201 ", self.raw(short, patience=1), "a body that is cut short")
        form = wire.form(wire.octoprint_fields(True), b"lie.stl", STL)
        for length in (len(form) + 1000, len(form) - 40):
            self.assertNotIn(b" 201 ", self.raw(wire.post_headers(BASE + "/api/files/local", key, length) + form, patience=1))
        for length in (b"-1", b"99999999999999999999999", b"0x10", b"5, 6", b"1e3", b"+5"):
            answer = self.raw(b"PUT " + target.encode() + b" HTTP/1.1\r\nHost: localhost\r\nX-Api-Key: " + key.encode() + b"\r\nContent-Length: " + length + b"\r\n\r\n" + STL, patience=1)
            self.assertNotIn(b" 201 ", answer, length)
        huge = wire.put_headers(target, key, 1 << 50)
        self.assertRegex(self.raw(huge)[:13], rb"HTTP/1.1 413")
        # without any length: chunks beyond the limit
        one = socket.create_connection(("127.0.0.1", self.daemon.port), 10)
        one.sendall(b"PUT " + target.encode() + b" HTTP/1.1\r\nHost: localhost\r\nX-Api-Key: " + key.encode() + b"\r\nTransfer-Encoding: chunked\r\n\r\n")
        try:
            for _ in range(40):
                one.sendall(b"10000\r\n" + b"x" * 65536 + b"\r\n")
            one.sendall(b"0\r\n\r\n")
            self.assertRegex(one.recv(100)[:13], rb"HTTP/1.1 413")
        except OSError:
            pass
        one.close()
        wait_for(lambda: not self.uploads(), "what was cut short to be removed")
        self.assertEqual(len(json.loads(self.daemon.ask("GET", "/api/v1/jobs?limit=1000")[1])), jobs)

    def test_broken_bodies(self):
        for door in ("/api/login", "/api/job", "/api/files/local/x.stl"):
            for body in (b"", b"{", b"[]", b"null", b'{"command":', b'{"command":{}}', b"[" * 4000, b"\xff\xfe", b'{"command":"select","print":"x"}', b"x" * 5000):
                status, content, _ = self.daemon.ask("POST", BASE + door, body)
                self.assertIn(status, (200, 400, 404, 413), (door, body[:20]))
                self.assert_secret(content, door)

    def test_nothing_starts_by_itself(self):
        for job in json.loads(self.daemon.ask("GET", "/api/v1/jobs?limit=1000")[1]):
            self.assertNotIn(job["state"], ("approved", "sending", "done", "handed_over"))


class Full(unittest.TestCase):
    def test_the_last_of_the_disk_is_not_taken(self):
        def small_disk(folder):
            (folder / "state").mkdir()
            mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=260m", "tmpfs", folder / "state"], capture_output=True)
            if mounted.returncode != 0:
                self.skipTest("only root can make a small disk")

        def end():
            daemon.stop()
            subprocess.run(["umount", daemon.folder / "state"], check=True)
            daemon.close()

        daemon = Daemon(SETTINGS.replace("1048576", str(300 << 20)), furnish=small_disk)
        self.addCleanup(end)
        headers = wire.put_headers(BASE + "/api/v1/files/local/large.stl", daemon.key, 100 << 20)
        self.assertRegex(daemon.raw(headers)[:13], rb"HTTP/1.1 507")
        headers = wire.post_headers(BASE + "/api/files/local", daemon.key, 100 << 20, expect=True)
        answer = daemon.raw(headers)
        self.assertRegex(answer[:13], rb"HTTP/1.1 507")
        self.assertIn(b"text/plain\r\n", answer)
        # without a length it is noticed on the way
        one = socket.create_connection(("127.0.0.1", daemon.port), 30)
        self.addCleanup(one.close)
        one.sendall(headers[:headers.index(b"Content-Length")].replace(b"POST", b"PUT").replace(b"/api/files/local", b"/api/v1/files/local/x.stl") + b"Transfer-Encoding: chunked\r\n\r\n")
        for _ in range(40):
            one.sendall(b"100000\r\n" + b"x" * (1 << 20) + b"\r\n")
        one.sendall(b"0\r\n\r\n")
        self.assertRegex(one.recv(100)[:13], rb"HTTP/1.1 507")
        self.assertEqual(daemon.ask("GET", BASE + "/api/version")[0], 200)


class Guesses(Case):
    def test_guesses_are_slowed_down_at_every_door_and_the_right_key_passes(self):
        replies = [self.daemon.ask("GET", BASE + DOORS[i % len(DOORS)], key=f"pm_{i}") for i in range(14)]
        slowed = [(content, headers) for status, content, headers in replies if status == 429]
        self.assertTrue(slowed)
        for _, headers in slowed:
            self.assertEqual(headers["Content-Type"], "text/plain")
            self.assertTrue(headers["Retry-After"])
        self.assertEqual(self.daemon.ask("GET", BASE + "/api/version")[0], 200)


if __name__ == "__main__":
    unittest.main()
