#!/usr/bin/python3
"""Slicers at the daemon's doors: what they send is replayed byte for byte, and curl uploads as a second client."""
import http.client
import io
import json
import pathlib
import socket
import subprocess
import sys
import time
import unittest
import zipfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import slicer_wire as wire
from web_daemon import SETTINGS, STL, Case, Daemon

BASE = "/printers/objet"
LARGE = 200 << 20
# 84 bytes and 50 a triangle: a whole binary STL, as far as its length tells
TRIANGLES = LARGE // 50


class Answer:
    """The replies to raw bytes, one after the other."""

    def __init__(self, one):
        self.one, self.file = one, one.makefile("rb")

    def next(self):
        reply = http.client.HTTPResponse(self)
        reply.begin()
        return reply.status, reply.read(), reply.headers

    def makefile(self, _mode):
        return Unclosed(self.file)


class Unclosed:
    """http.client closes what it has read; further replies follow here."""

    def __init__(self, file):
        self.file = file

    def close(self):
        pass

    def flush(self):
        pass

    def __getattr__(self, name):
        return getattr(self.file, name)


class Doors(Case):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon(SETTINGS.replace("1048576", str(300 << 20)) + '[printer.lab]\nprofile = "marlin"\nport = "/dev/none"\n')

    def talk(self, *pieces):
        """Each piece is sent and its reply read, on one connection."""
        with socket.create_connection(("127.0.0.1", self.daemon.port), 60) as one:
            one.settimeout(60)
            answer = Answer(one)
            replies = []
            for piece in pieces:
                one.sendall(piece)
                replies.append(answer.next())
            return replies

    def job(self, number):
        return json.loads(self.daemon.ask("GET", f"/api/v1/jobs/{number}")[1])

    def upload(self, name, content=STL, wants_print=False, path=b"", target="/api/files/local", base=BASE, key=None):
        body = wire.form(wire.octoprint_fields(wants_print, path), name, content)
        key = self.daemon.key if key is None else key
        return self.talk(wire.post_headers(base + target, key, len(body)) + body)[0]


class PrusaSlicer(Doors):
    def test_the_recorded_bytes_are_what_we_send(self):
        form = wire.form(wire.octoprint_fields(True, b"folderA"), "part %22ü%22 1;x.gcode".encode(), b"G28\nG1 X10\n")
        self.assertEqual(len(form), 424)
        self.assertEqual(len(wire.post_headers("/api/files/local", "KEY123", 424)) + 424, 650)
        form = wire.form(wire.octoprint_fields(False), b"a.gcode", b"G28\nG1 X10\n")
        self.assertEqual(len(wire.post_headers("/api/files/local", "", 402)) + len(form), 609)
        self.assertEqual(len(wire.get("/api/version", "KEY123")), 114)

    def test_the_connection_is_tested(self):
        (status, body, _), = self.talk(wire.get(BASE + "/api/version", self.daemon.key))
        version = json.loads(body)
        self.assertEqual(status, 200)
        self.assertTrue(version["api"])
        self.assertTrue(version["text"].startswith("OctoPrint"))
        self.assertIs(version["capabilities"]["upload-by-put"], True)

    def test_the_key_may_come_as_a_bearer_token(self):
        bearer = b"Authorization: Bearer " + self.daemon.key.encode() + b"\r\n\r\n"
        (status, _, _), = self.talk(wire.get(BASE + "/api/version", "")[:-2] + bearer)
        self.assertEqual(status, 200)

    def test_a_printer_that_does_not_exist(self):
        (status, body, _), = self.talk(wire.get("/printers/none/api/version", self.daemon.key))
        self.assertEqual(status, 404)
        self.assertIn(b"no printer", body)

    def test_a_model_becomes_a_job(self):
        status, body, headers = self.upload("part %22ü%22 1;x.stl".encode(), path=b"folderA", wants_print=True)
        self.assertEqual(status, 201, body)
        told = json.loads(body)
        self.assertTrue(told["done"])
        self.assertFalse(told["effectivePrint"], "nothing is prepared yet")
        self.assertEqual(told["files"]["local"]["name"], 'part "ü" 1;x.stl')
        job = self.job(told["files"]["local"]["job"])
        self.assertEqual((job["name"], job["printer"]), ('part "ü" 1;x.stl', "objet"))
        self.assertFalse(job["held"])
        self.assertEqual(headers["Location"], BASE + "/api/files/local/part%20%22%C3%BC%22%201%3Bx.stl")
        status, body, _ = self.daemon.ask("GET", headers["Location"])
        self.assertEqual((status, json.loads(body)["job"]), (200, job["id"]))

    def test_the_recorded_upload_goes_to_the_queue(self):
        """Requests 2 and 4 of the recording, but for the address and the key."""
        for name, wants_print, path in (("part %22ü%22 1;x.gcode".encode(), True, b"folderA"), (b"a.gcode", False, b"")):
            status, body, _ = self.upload(name, b"G28\nG1 X10\n", wants_print, path, base="/printers/lab")
            self.assertEqual(status, 201, body)
            told = json.loads(body)
            self.assertFalse(told["effectivePrint"])
            job = self.job(told["files"]["local"]["job"])
            self.assertEqual((job["name"], job["printer"], job["held"]), (name.replace(b"%22", b'"').decode(), "lab", not wants_print))
        status, body, headers = self.upload(b"a.gcode", b"G28\n")
        self.assertEqual((status, headers["Content-Type"]), (422, "text/plain"), "this printer is handed its jobs")
        self.assertIn(b"takes no program", body)

    def test_a_name_with_quotes_in_either_form(self):
        """libcurl before 7.81 escapes them with a backslash; since then, and in browsers, they are %22."""
        for name in (b'cube \\"a\\".stl', b"cube %22a%22.stl"):
            status, content, _ = self.upload(name)
            self.assertEqual(status, 201, content)
            self.assertEqual(json.loads(content)["files"]["local"]["name"], 'cube "a".stl')

    def test_what_shall_only_be_uploaded_waits(self):
        status, body, _ = self.upload(b"a.stl")
        self.assertEqual(status, 201, body)
        self.assertTrue(self.job(json.loads(body)["files"]["local"]["job"])["held"])

    def test_no_key_and_a_wrong_one(self):
        for key in ("", "K"):
            for bytes_ in (wire.get(BASE + "/api/version", key), wire.post_headers(BASE + "/api/files/local", key, 402, True)):
                (status, body, headers), = self.talk(bytes_)
                self.assertEqual((status, headers["Content-Type"]), (401, "text/plain"), "a user reads it")
                self.assertIn(b"keys", body)
                self.assertNotIn(b"{", body)

    def test_large_bodies_wait_for_leave(self):
        body = wire.form(wire.octoprint_fields(False), b"big.stl", b"\0" * 80 + (39998).to_bytes(4, "little") + b"\0" * 1999900)
        with socket.create_connection(("127.0.0.1", self.daemon.port), 60) as one:
            one.sendall(wire.post_headers(BASE + "/api/files/local", self.daemon.key, len(body), expect=True))
            self.assertEqual(one.recv(100), b"HTTP/1.1 100 Continue\r\n\r\n")
            one.sendall(body)
            reply = http.client.HTTPResponse(one)
            reply.begin()
            self.assertEqual(reply.status, 201, reply.read())

    def test_refused_before_the_body(self):
        for target, length, expected in (("/api/files/local", LARGE * 2, 413), ("/api/files/sdcard", 5, 404)):
            (status, _, _), = self.talk(wire.post_headers(BASE + target, self.daemon.key, length, expect=True))
            self.assertEqual(status, expected)
        (status, body, _), = self.talk(wire.post_headers("/printers/none/api/files/local", self.daemon.key, 5, expect=True))
        self.assertEqual(status, 404)
        self.assertIn(b"no printer", body)

    def test_anything_else_is_told_in_a_sentence(self):
        status, body, headers = self.upload(b"a.exe")
        self.assertEqual((status, headers["Content-Type"]), (415, "text/plain"))
        self.assertIn(b"STL", body)
        self.assertTrue(body.isascii())


class PrusaLink(Doors):
    def test_storage(self):
        (status, body, _), = self.talk(wire.get(BASE + "/api/v1/storage", self.daemon.key))
        self.assertEqual(status, 200)
        self.assertEqual(next(iter(json.loads(body))), "storage_list")
        self.assertEqual(json.loads(body)["storage_list"][0]["path"], "/local")

    def test_put(self):
        headers = wire.put_headers(BASE + "/api/v1/files/local/folder/W%C3%BCrfel%201.stl", self.daemon.key, len(STL), True)
        with socket.create_connection(("127.0.0.1", self.daemon.port), 60) as one:
            one.sendall(headers)
            self.assertEqual(one.recv(100), b"HTTP/1.1 100 Continue\r\n\r\n")
            one.sendall(STL)
            reply = http.client.HTTPResponse(one)
            reply.begin()
            told = json.loads(reply.read())
        self.assertEqual((reply.status, told["name"]), (201, "Würfel 1.stl"))
        job = self.job(told["job"])
        self.assertFalse(job["held"])

    def test_refused_before_the_body(self):
        for target, key, expected in (("a.exe", self.daemon.key, 415), ("a.stl", "wrong", 401), ("", self.daemon.key, 404)):
            (status, _, _), = self.talk(wire.put_headers(BASE + "/api/v1/files/local/" + target, key, 100))
            self.assertEqual(status, expected, target)

    def test_user_and_password_are_refused_in_words(self):
        digest = b'Authorization: Digest username="maker", realm="x", nonce="1", uri="/", response="2"\r\n\r\n'
        (status, body, _), = self.talk(wire.get(BASE + "/api/version", "")[:-2] + digest)
        self.assertEqual(status, 401)
        self.assertIn(b"password", body)


class Moonraker(Doors):
    def test_info_and_upload(self):
        (status, body, _), = self.talk(wire.get(BASE + "/server/info", self.daemon.key))
        self.assertEqual(status, 200)
        self.assertTrue(json.loads(body)["result"]["moonraker_version"])
        form = wire.form([(b"root", b"gcodes"), (b"print", b"true")], b"a.stl", STL)
        (status, body, _), = self.talk(wire.post_headers(BASE + "/server/files/upload", self.daemon.key, len(form)) + form)
        told = json.loads(body)
        self.assertEqual((status, told["item"]["path"], told["item"]["size"]), (201, "a.stl", len(STL)))
        self.assertFalse(told["print_started"])
        form = wire.form([(b"root", b"config")], b"a.stl", STL)
        (status, _, _), = self.talk(wire.post_headers(BASE + "/server/files/upload", self.daemon.key, len(form)) + form)
        self.assertEqual(status, 400)


class Cura(Doors):
    def ask(self, method, path, body=None):
        status, content, headers = self.daemon.ask(method, BASE + path, body and json.dumps(body), {"Content-Type": "application/json"})
        return status, json.loads(content) if content and headers["Content-Type"] == "application/json" else content

    def test_everything_it_asks_is_answered(self):
        self.assertIn("feature", self.ask("GET", "/api/settings")[1])
        self.assertTrue(self.ask("POST", "/api/login", {"passive": True})[1]["name"])
        profiles = self.ask("GET", "/api/printerprofiles")[1]["profiles"]
        self.assertEqual([one["name"] for one in profiles.values() if one["current"]], ["objet"])
        status, printer = self.ask("GET", "/api/printer?exclude=temperature,sd")
        self.assertEqual((status, printer["state"]["text"]), (200, "Operational"))
        for flag in ("error", "closedOrError", "paused", "pausing", "printing", "cancelling"):
            self.assertIs(printer["state"]["flags"][flag], False)
        self.assertIs(printer["state"]["flags"]["ready"], True)
        status, job = self.ask("GET", "/api/job")
        self.assertEqual((status, job["state"], job["job"]["file"]["name"]), (200, "Operational", None))
        self.assertIn("printTime", job["progress"])
        self.assertEqual(self.ask("GET", "/plugin/appkeys/probe")[0], 404)
        self.assertEqual(self.ask("POST", "/api/job", {"command": "pause", "action": "pause"})[0], 409)
        self.assertEqual(self.ask("POST", "/api/job", {"command": "start"})[0], 409)
        self.assertEqual(self.ask("POST", "/api/job", {"command": 7})[0], 400)

    def test_a_printer_that_is_not_there(self):
        base = "/printers/lab"
        self.assertEqual(self.daemon.ask("GET", base + "/api/printer")[0], 409)
        self.assertEqual(json.loads(self.daemon.ask("GET", base + "/api/job")[1])["state"], "Offline")
        self.assertFalse(json.loads(self.daemon.ask("GET", base + "/server/info")[1])["result"]["klippy_connected"])

    def test_upload_and_print(self):
        form = wire.form([(b"path", b"")], b"cube.stl", STL)
        end = b"--" + wire.BOUNDARY + b"--\r\n"
        for field in (b"select", b"print"):
            form = form[:-len(end)] + b"--" + wire.BOUNDARY + b'\r\nContent-Disposition: form-data; name="' + field + b'"\r\n\r\ntrue\r\n' + end
        (status, body, headers), = self.talk(wire.post_headers(BASE + "/api/files/local", self.daemon.key, len(form)) + form)
        self.assertEqual(status, 201, body)
        self.assertFalse(self.job(json.loads(body)["files"]["local"]["job"])["held"])
        path = headers["Location"][len(BASE):]
        status, told = self.ask("POST", path, {"command": "select", "print": True})
        self.assertEqual(status, 409, "the settings ask first")
        self.assertIn(b"approval", told)
        self.assertEqual(self.ask("POST", path, {"command": "select"})[0], 204)
        self.assertEqual(self.ask("POST", "/api/files/local/none.stl", {"command": "select", "print": True})[0], 404)
        self.assertEqual(self.ask("POST", path, {"command": "slice"})[0], 400)


class SlicedPlates(Doors):
    """.gcode.3mf, as Orca and Bambu Studio send it, at each of the three doors."""

    @staticmethod
    def plate():
        content = io.BytesIO()
        with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("3D/3dmodel.model", "<model/>")
            archive.writestr("Metadata/plate_1.gcode", b"G28\nG1 X10\n")
        return content.getvalue()

    def by_octoprint(self, base):
        status, body, _ = self.upload(b"plate.gcode.3mf", self.plate(), base=base)
        return status, body, lambda told: told["files"]["local"]["job"]

    def by_prusalink(self, base):
        (status, body, _), = self.talk(wire.put_headers(base + "/api/v1/files/local/plate.gcode.3mf", self.daemon.key,
                                                        len(self.plate())) + self.plate())
        return status, body, lambda told: told["job"]

    def by_moonraker(self, base):
        form = wire.form([(b"root", b"gcodes"), (b"print", b"false")], b"plate.gcode.3mf", self.plate())
        (status, body, _), = self.talk(wire.post_headers(base + "/server/files/upload", self.daemon.key, len(form)) + form)
        return status, body, lambda told: self.newest()

    def newest(self):
        return json.loads(self.daemon.ask("GET", "/api/v1/jobs")[1])[0]["id"]

    def test_is_a_program_at_every_door(self):
        for send in (self.by_octoprint, self.by_prusalink, self.by_moonraker):
            with self.subTest(send.__name__):
                status, body, number = send("/printers/lab")
                self.assertEqual(status, 201, body)
                job = self.job(number(json.loads(body)))
                self.assertEqual(job["name"], "plate.gcode.3mf")
                self.assertEqual(job["kind"], "program")
                status, body, _ = send(BASE)
                self.assertEqual(status, 422, body)
                self.assertIn(b"takes no program", body)


class Large(Doors):
    def test_two_hundred_megabytes_by_form_and_by_put(self):
        model = self.daemon.folder / "large.stl"
        with open(model, "wb") as file:
            file.write(b"\0" * 80 + TRIANGLES.to_bytes(4, "little"))
            file.truncate(84 + 50 * TRIANGLES)
        address = f"http://127.0.0.1:{self.daemon.port}{BASE}"
        before = self.daemon.memory_kib()
        for arguments in (("-F", "print=false", "-F", f"file=@{model};filename=größe.stl", address + "/api/files/local"),
                          ("-T", str(model), address + "/api/v1/files/local/large.stl")):
            upload = subprocess.Popen(["curl", "-sS", "-w", "%{http_code}", "-H", f"X-Api-Key: {self.daemon.key}", *arguments],
                                      stdout=subprocess.PIPE, text=True)
            most = 0
            while upload.poll() is None:
                most = max(most, self.daemon.memory_kib())
                time.sleep(0.02)
            told = upload.stdout.read()
            upload.stdout.close()
            self.assertTrue(told.endswith("201"), told)
            number = json.loads(told[:-3]).get("job") or json.loads(told[:-3])["files"]["local"]["job"]
            taken = self.daemon.folder / "state/jobs" / str(number) / "input" / self.job(number)["name"]
            self.assertEqual(taken.stat().st_size, model.stat().st_size)
            self.assertLess(most - before, 30000, "KiB; the body is 204800")


if __name__ == "__main__":
    unittest.main()
