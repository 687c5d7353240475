#!/usr/bin/python3
"""The daemon's web server: what browsers and programs may do, and an attack pack that must not succeed."""
import http.client
import json
import pathlib
import signal
import socket
import sys
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from web_daemon import SETTINGS, STL, Case, Daemon, free_port, is_open, wait_for


class Use(Case):
    def test_page_and_headers(self):
        status, content, headers = self.daemon.ask("GET", "/", key=False)
        self.assertEqual(status, 200)
        self.assertIn(b"page", content)
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertEqual(headers["X-Content-Type-Options"], "nosniff")
        self.assertIsNone(headers["Access-Control-Allow-Origin"])

    def test_upload_becomes_a_job_and_is_worked_on(self):
        status, content, _ = self.daemon.upload(name="Würfel 1.stl".encode())
        self.assertEqual(status, 201, content)
        job = json.loads(content)
        self.assertEqual(job["name"], "Würfel 1.stl")
        status, content, _ = self.daemon.ask("GET", f"/api/v1/jobs/{job['id']}", key=False)
        self.assertEqual((status, json.loads(content)["printer"]), (200, "objet"))
        for verb, expected in (("hold", 200), ("approve", 200), ("cancel", 200), ("cancel", 409)):
            status, content, _ = self.daemon.ask("POST", f"/api/v1/jobs/{job['id']}/{verb}")
            self.assertEqual(status, expected, content)
        self.assertTrue(json.loads(content)["error"]["hint"])

    def test_printers_are_paused_and_resumed(self):
        for verb in ("pause", "resume"):
            status, content, _ = self.daemon.ask("POST", f"/api/v1/printers/objet/{verb}")
            self.assertEqual((status, json.loads(content)["paused"]), (200, verb == "pause"))
        self.assertEqual(self.daemon.ask("POST", "/api/v1/printers/none/pause")[0], 404)

    def test_older_jobs_are_reached(self):
        ids = []
        for _ in range(5):
            ids.insert(0, json.loads(self.daemon.upload()[1])["id"])
            self.assertEqual(self.daemon.ask("POST", f"/api/v1/jobs/{ids[0]}/cancel")[0], 200)
        told, before = [], ids[0] + 1
        while len(told) < len(ids):
            listed = json.loads(self.daemon.ask("GET", f"/api/v1/jobs?limit=2&before={before}")[1])
            told += [job["id"] for job in listed]
            before = told[-1]
        self.assertEqual(told[:len(ids)], ids)
        shown = self.daemon.shell("jobs", "list", "--json", "--limit", "2", "--before", str(ids[0]))
        self.assertEqual([job["id"] for job in json.loads(shown.stdout)], ids[1:3])
        for wrong in ("0", "-1", "x", "", "99999999999999999999"):
            self.assertEqual(self.daemon.ask("GET", f"/api/v1/jobs?before={wrong}")[0], 409, wrong)
        self.assertEqual(self.daemon.shell("jobs", "list", "--before", "0").returncode, 2)

    def test_what_cannot_be_taken_is_told(self):
        for upload, expected in ((self.daemon.upload(name=b"a.exe"), 415), (self.daemon.upload(fields=()), 422),
                                 (self.daemon.upload(fields=((b"printer", b"none"),)), 404),
                                 (self.daemon.upload(content=b"x" * 2000000), 413)):
            self.assertEqual(upload[0], expected, upload[1])
        self.assertEqual(self.daemon.ask("GET", "/api/v1/jobs/9999")[0], 404)
        self.assertEqual(self.daemon.ask("DELETE", "/api/v1/jobs/1")[0], 405)
        self.assertEqual(self.daemon.ask("GET", "/api/v1/nothing")[0], 404)

    def test_the_rules_of_uploads_are_told(self):
        status, content, _ = self.daemon.ask("GET", "/api/v1/uploads", key=False)
        rules = json.loads(content)
        self.assertEqual((status, rules["most_bytes"]), (200, 1048576))
        for ending in rules["endings"]:
            status, content, _ = self.daemon.upload(name=b"a" + ending.encode(), content=STL)
            if ending in (".gcode", ".gco", ".g", ".gcode.3mf", ".x3g", ".s3g"):
                self.assertEqual(status, 422, content)  # this printer is handed documents
            else:
                self.assertEqual(status, 201, content)
                self.daemon.ask("POST", f"/api/v1/jobs/{json.loads(content)['id']}/cancel")

    def test_a_page_that_is_missing_is_told(self):
        page = self.daemon.folder / "page/index.html"
        text = page.read_bytes()
        page.unlink()
        try:
            status, content, _ = self.daemon.ask("GET", "/", key=False)
            self.assertEqual(status, 404)
            self.assertIn("without its page", json.loads(content)["error"]["what"])
        finally:
            page.write_bytes(text)

    def test_pages_are_told_what_changes(self):
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=30)
        connection.request("GET", "/api/v1/events")
        stream = connection.getresponse()
        self.assertEqual(stream.headers["Content-Type"], "text/event-stream")

        def next_state():
            while not (line := stream.readline()).startswith(b"data:"):
                pass
            return json.loads(line[5:])["result"]

        self.assertFalse(next_state()["printers"][0]["paused"])
        self.daemon.ask("POST", "/api/v1/printers/objet/pause")
        while not next_state()["printers"][0]["paused"]:
            pass
        self.daemon.ask("POST", "/api/v1/printers/objet/resume")
        connection.close()

    def test_pages_that_ask_for_it_are_told_only_what_changes(self):
        def events(last_id=None):
            connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=30)
            self.addCleanup(connection.close)
            connection.request("GET", "/api/v1/events?deltas=1", headers={"Last-Event-ID": last_id} if last_id else {})
            stream, event = connection.getresponse(), {}
            while line := stream.readline().decode():
                field, _, value = line.strip().partition(": ")
                if field:
                    event[field] = value
                elif "data" in event:
                    yield event["event"], event["id"], json.loads(event["data"])
                    event = {}

        def first_delta(stream):
            return next(({one["name"]: one["paused"] for one in told["printers"]}, number)
                        for kind, number, told in stream if kind == "delta" and "printers" in told)

        stream = events()
        kind, number, told = next(stream)
        self.assertEqual((kind, told["result"]["printers"][0]["paused"]), ("state", False))
        self.daemon.ask("POST", "/api/v1/printers/objet/pause")
        paused, number = first_delta(stream)
        self.assertEqual(paused, {"objet": True})
        self.daemon.ask("POST", "/api/v1/printers/objet/resume")
        self.assertEqual(first_delta(events(number))[0], {"objet": False}, "it goes on without a state")
        self.assertEqual(next(events("another.1"))[0], "state")

    def test_revoked_keys_are_worthless(self):
        key = self.daemon.shell("keys", "add", "guest").stdout.strip()
        self.assertEqual(self.daemon.ask("POST", "/api/v1/printers/objet/resume", key=key)[0], 200)
        self.assertEqual(self.daemon.shell("keys", "revoke", "guest").returncode, 0)
        self.assertEqual(self.daemon.ask("POST", "/api/v1/printers/objet/resume", key=key)[0], 401)
        self.assertNotIn("guest", self.daemon.shell("keys", "list").stdout)

    def test_a_stream_ends_with_its_key(self):
        key = self.daemon.shell("keys", "add", "watcher").stdout.strip()
        connection = http.client.HTTPConnection("127.0.0.1", self.daemon.port, timeout=60)
        connection.request("GET", "/api/v1/events", headers={"X-Api-Key": key})
        stream = connection.getresponse()
        self.assertTrue(stream.readline())
        self.assertEqual(self.daemon.shell("keys", "revoke", "watcher").returncode, 0)
        self.daemon.ask("POST", "/api/v1/printers/objet/pause")
        self.assertNotIn(b'"paused":true', stream.read())  # to its end
        self.daemon.ask("POST", "/api/v1/printers/objet/resume")
        connection.close()


WAYS_UP = ["../", "..%2f", "%2e%2e/", "%2e%2e%2f", "..%5c", "..\\", "%252e%252e%252f", "....//", "..;/", "%c0%ae%c0%ae/", ".%00./"]
GOALS = ["secret", "c.toml", "state/keys.json", "state/jobs.sqlite", "../../../../etc/passwd"]


class Attack(Case):
    def assert_secret(self, content, what):
        for text in (b"secret", b"sha256", b"root:", b"SQLite", b"[printer"):
            self.assertNotIn(text, content, what)

    def test_traversal(self):
        count = 0
        for up in WAYS_UP:
            for goal in GOALS:
                for base in ("/", "/assets/", "/api/v1/jobs/1/files/"):
                    target = base + up * 3 + goal
                    answer = self.daemon.raw(f"GET {target} HTTP/1.1\r\nHost: localhost\r\nX-Api-Key: {self.daemon.key}\r\nConnection: close\r\n\r\n".encode())
                    self.assertNotIn(b" 200 ", answer[:20], target)
                    self.assert_secret(answer, target)
                    count += 1
        self.assertNotIn(b"secret", self.daemon.ask("GET", "/way-out")[1])
        self.assertGreaterEqual(count, 100)

    def test_names_never_become_paths(self):
        before = set(program.files_below(self.daemon.folder / "state/folders"))
        names = [b"../../x.stl", b"/etc/x.stl", b"..\\x.stl", b"C:\\x.stl", b"%2e%2e%2fx.stl", b".hidden.stl", b"~x.stl",
                 b"<img src=x onerror=alert(1)>.stl", b"'; DROP TABLE jobs;--.stl", b"$(reboot).stl", b"`id`.stl",
                 b"-rf.stl", b"a;b.stl", b"x\\x00.stl", b"\xff\xfe.stl", b"CON.stl", b"." * 50 + b".stl", b"a" * 5000 + b".stl",
                 "‮lts.stl".encode(), b"{{7*7}}.stl", b"%s%n.stl", b"a|b.stl", b"a&b.stl", b"a?b#c.stl", b"con:aux.stl",
                 b"a b.stl", b"\tx.stl", b"x.stl/..", b"x.stl ", b"x.STL"]
        for name in names:
            status, content, headers = self.daemon.upload(name=name)
            self.assertIn(status, (201, 400, 413, 415, 422), (name, content))
            self.assertEqual(headers["Content-Type"], "application/json" if status in (201, 415, 422) else headers["Content-Type"])
            self.assertNotIn("html", headers["Content-Type"], name)
            if status == 201:
                job = json.loads(content)
                self.assertNotIn("/", job["name"])
                self.daemon.ask("POST", f"/api/v1/jobs/{job['id']}/cancel")
        self.assertGreaterEqual(len(names), 30)
        after = set(program.files_below(self.daemon.folder / "state/folders"))
        stray = [one for one in after - before if "/failed" not in one]
        self.assertFalse(stray, "an upload left its job")

    def test_reserved_and_repeated_fields(self):
        for field in ("file.path", "file.name", "file.size", "file.content_type", "path", "origin", "folder", "input", "id",
                      "state", "sha256", "key", "X-Api-Key", "_method", "printer[]", "printer.name", "file[]", "..",
                      "__proto__", "constructor", "filename", "tray", "port", "config", "socket", "print", "select", "userdata",
                      "root", "plateindex"):
            status, content, _ = self.daemon.upload(fields=((b"printer", b"objet"), (field.encode(), b"/etc/passwd")))
            self.assertIn(status, (201, 422), (field, content))
            self.assert_secret(content.replace(b'"sha256"', b""), field)
            if status == 201:
                self.daemon.ask("POST", f"/api/v1/jobs/{json.loads(content)['id']}/cancel")
        second = b'--FORM7\r\nContent-Disposition: form-data; name="file"; filename="b.stl"\r\n\r\n' + STL + b"\r\n"
        self.assertEqual(self.daemon.upload(extra=second)[0], 422)

    def test_other_sites_pages(self):
        origins = ["null", "http://evil.example", "https://evil.example", "http://localhost.evil.example", "http://127.0.0.1",
                   "http://localhost:1", "file://", "chrome-extension://x", "http://[::1]", "http://evil.example:80"]
        for origin in origins:
            for verb in ("pause", "clear", "resume"):
                status, content, headers = self.daemon.ask("POST", f"/api/v1/printers/objet/{verb}", headers={"Origin": origin})
                self.assertEqual(status, 403, (origin, content))
                self.assertIsNone(headers["Access-Control-Allow-Origin"])

    def test_foreign_names(self):
        for host in ("evil.example", "localhost.evil.example", "127.0.0.1.nip.io", "a", "", "evil.example:8080", "localhost@evil.example",
                     "xn--e1awd7f.example", "printers.local.evil", "[evil]"):
            for target in ("/", "/api/v1/jobs", "/api/v1/events"):
                answer = self.daemon.raw(f"GET {target} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
                self.assertRegex(answer[:14], rb"HTTP/1.1 40[03]", (host, target))

    def test_broken_requests(self):
        bad = [b"", b"\r\n\r\n", b"GET\r\n\r\n", b"GET /\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", b"GET / HTTP/9.9\r\n\r\n",
               b"GET / HTTP/1.1\r\n\r\n", b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: -1\r\n\r\n",
               b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 99999999999999999999\r\n\r\n",
               b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
               b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil\r\n\r\n", b"GET /" + b"a" * 70000 + b" HTTP/1.1\r\n\r\n",
               b"GET / HTTP/1.1\r\n" + b"X: y\r\n" * 5000 + b"\r\n", b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"y" * 200000 + b"\r\n\r\n",
               b"GET / HTTP/1.1\nHost: evil\n\n", b"GET / HTTP/1.1\r\nHost : localhost\r\n\r\n", b"OPTIONS * HTTP/1.1\r\nHost: localhost\r\n\r\n",
               b"CONNECT evil:80 HTTP/1.1\r\nHost: localhost\r\n\r\n", b"TRACE / HTTP/1.1\r\nHost: localhost\r\n\r\n",
               b"GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\n\r\n", b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n"]
        methods = [f"{m} /api/v1/printers/objet/pause HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n".encode()
                   for m in ("PUT", "DELETE", "PATCH", "PROPFIND", "pOST", "GET", "LINK", "PURGE", "MKCOL")]
        forms = [b"POST /api/v1/jobs HTTP/1.1\r\nHost: localhost\r\nX-Api-Key: " + self.daemon.key.encode() + b"\r\nConnection: close\r\nContent-Type: " + kind
                 + b"\r\nContent-Length: " + str(len(body)).encode() + b"\r\n\r\n" + body
                 for kind, body in ((b"multipart/form-data", b"--FORM7--"), (b"multipart/form-data; boundary=", b"--"), (b"text/plain", b"x"),
                                    (b"multipart/form-data; boundary=FORM7", b"--B\r\n\r\n"), (b"multipart/form-data; boundary=B", b"--B\r\nContent-Disposition: x\r\n\r\ny\r\n--B--"),
                                    (b"multipart/form-data; boundary=" + b"B" * 20000, b"--FORM7--"), (b"application/x-www-form-urlencoded", b"printer=objet&file=x"))]
        for data in bad + methods + forms:
            answer = self.daemon.raw(data, patience=1)
            self.assertNotRegex(answer[:14], rb"HTTP/1.1 20[1-9]", data[:80])
            self.assert_secret(answer, data[:80])
        self.assertGreaterEqual(len(bad + methods + forms), 30)
        self.assertFalse(json.loads(self.daemon.ask("GET", "/api/v1/printers")[1])[0]["paused"])

    def test_slow_and_endless_clients_take_no_memory(self):
        before = self.daemon.memory_kib()
        held = [socket.create_connection(("127.0.0.1", self.daemon.port)) for _ in range(70)]
        for one in held:
            one.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\nX: ")
            one.settimeout(1)
        for _ in range(200):
            for one in held:
                try:
                    one.sendall(b"y" * 4096)
                except OSError:
                    pass
        self.assertEqual(self.daemon.ask("GET", "/api/v1/jobs")[0], 200, "while they are all there")
        for one in held:
            one.close()
        self.assertLess(self.daemon.memory_kib() - before, 60000)


class Guesses(Case):
    def test_guessed_keys(self):
        guesses = ["", " ", "pm_", "admin", self.daemon.key[:-1], self.daemon.key + "x", self.daemon.key.upper(), self.daemon.key[3:],
                   "*", "' or 1=1", "%00", "null", "true", "0", "undefined", "Bearer " + self.daemon.key, "pm_" + "A" * 43]
        refused = 0
        for guess in guesses * 2:
            status, _, headers = self.daemon.ask("POST", "/api/v1/printers/objet/pause", key=guess)
            self.assertIn(status, (401, 429), guess)
            refused += status == 429
        self.assertGreater(refused, 0)
        self.assertEqual(self.daemon.ask("POST", "/api/v1/printers/objet/resume")[0], 200, "the right key is always taken")
        self.assertEqual(self.daemon.ask("GET", "/api/v1/state", key=False)[0], 200, "and so is the page beside the daemon")


class Trust(unittest.TestCase):
    def test_who_asks_from_this_machine_is_not_trusted_unless_it_is_said(self):
        daemon = Daemon(SETTINGS.replace("[web]", "[web]\ntrust_local = false"))
        try:
            self.assertNotIn("trust_local is not set", daemon.said())
            self.assertEqual(daemon.ask("GET", "/api/v1/state", key=False)[0], 401)
            self.assertEqual(daemon.ask("GET", "/api/v1/state")[0], 200)
            self.assertEqual(daemon.ask("GET", "/", key=False)[0], 200, "the page itself tells nothing")
            told = [word for word in daemon.said().split() if "#look=" in word]
            links = told + [daemon.shell("keys", "link").stdout.strip()]
            self.assertEqual(len(links), 2, daemon.said())
            for link in links:
                self.assertTrue(link.startswith(f"http://localhost:{daemon.port}/#look="), link)
                code = link.partition("=")[2]
                status, content, _ = daemon.ask("POST", "/api/v1/look", code, key=False)
                self.assertEqual(status, 200, content)
                key = json.loads(content)["key"]
                self.assertEqual(daemon.ask("GET", "/api/v1/state", key=key)[0], 200)
                self.assertEqual(daemon.ask("POST", "/api/v1/printers/objet/pause", key=key)[0], 401)
                for wrong in (code, code + "x", ""):
                    self.assertEqual(daemon.ask("POST", "/api/v1/look", wrong, key=False)[0], 401, "a link is good once")
            self.assertEqual(daemon.ask("POST", "/api/v1/look", "x", {"Origin": "http://evil.example"}, False)[0], 403)
            self.assertIn("look", daemon.shell("keys", "list").stdout)
        finally:
            daemon.close()

    def test_nobody_else_sees_what_arrives_in_a_state_folder_from_before(self):
        def open_to_others(folder):
            (folder / "state").mkdir()
            (folder / "state").chmod(0o755)
        daemon = Daemon(furnish=open_to_others)
        self.addCleanup(daemon.close)
        self.assertEqual((daemon.folder / "state" / "uploads").stat().st_mode & 0o777, 0o700)

    def test_settings_from_before_are_as_they_were_and_told_once(self):
        daemon = Daemon()
        try:
            self.assertEqual(daemon.ask("GET", "/api/v1/state", key=False)[0], 200)
            self.assertEqual(daemon.said().count("trust_local is not set"), 1)
        finally:
            daemon.close()


class Reload(unittest.TestCase):
    def test_the_server_follows_its_settings(self):
        daemon = Daemon()
        try:
            settings = (daemon.folder / "c.toml").read_text()
            connection = http.client.HTTPConnection("127.0.0.1", daemon.port, timeout=30)
            connection.request("GET", "/api/v1/events")
            stream = connection.getresponse()  # a page that watches does not keep the old server
            old, daemon.port = daemon.port, free_port()
            daemon.configure(settings.replace(f"port = {old}", "port = PORT"))
            daemon.process.send_signal(signal.SIGHUP)
            wait_for(lambda: is_open(daemon.port), "the new port")
            self.assertEqual(daemon.ask("GET", "/api/v1/printers")[0], 200)
            try:
                stream.read()  # ends, in the middle of a message or not
            except http.client.IncompleteRead:
                pass
            connection.close()
            daemon.port = old
            self.assertFalse(is_open(daemon.port))
            daemon.configure(settings.replace(f"port = {old}", "port = 0"))
            daemon.process.send_signal(signal.SIGHUP)
            wait_for(lambda: "web server ended" in daemon.said(), "its end")
        finally:
            daemon.close()


class Alone(unittest.TestCase):
    def test_listens_on_this_machine_until_there_is_a_key(self):
        daemon = Daemon()
        try:
            settings = (daemon.folder / "c.toml").read_text().replace("[web]", '[web]\naddress = "0.0.0.0"')
            daemon.shell("keys", "revoke", "tester")
            daemon.stop()
            daemon.configure(settings)
            daemon.start()
            self.assertEqual(self.listening(daemon), "0100007F")
            daemon.shell("keys", "add", "first")
            end = time.monotonic() + 30
            while self.listening(daemon) != "00000000" and time.monotonic() < end:
                time.sleep(0.1)
            self.assertEqual(self.listening(daemon), "00000000")
        finally:
            daemon.close()

    @staticmethod
    def listening(daemon):
        """The address, as the kernel tells it, at which somebody listens at the daemon's port."""
        end = time.monotonic() + 30
        while time.monotonic() < end:
            for line in pathlib.Path("/proc/net/tcp").read_text().splitlines()[1:]:
                local, state = line.split()[1], line.split()[3]
                if state == "0A" and int(local.split(":")[1], 16) == daemon.port:
                    return local.split(":")[0]
            time.sleep(0.05)
        return None


if __name__ == "__main__":
    unittest.main()
