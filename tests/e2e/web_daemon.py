"""packmergerd with its web server, in a folder of its own, and clients that send it what they like."""
import http.client
import os
import pathlib
import socket
import subprocess
import tempfile
import time
import unittest

import program

STL = b"solid a\n" + b"facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 9 0 0\nvertex 0 9 0\nendloop\nendfacet\n" + b"endsolid a\n"
SETTINGS = """state = "state"
[web]
port = PORT
page = "page"
most_upload_bytes = 1048576
[prepare]
program = "PREPARE"
[printer.objet]
profile = "objet30"
handoff_folder = "out"
"""


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def is_open(port):
    try:
        socket.create_connection(("127.0.0.1", port), 1).close()
        return True
    except OSError:
        return False


def wait_for(holds, what, patience=60):
    """What holds() gives, once it is true."""
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if found := holds():
            return found
        time.sleep(0.05)
    raise AssertionError(f"waited in vain for {what}")


class Daemon:
    """packmergerd in a folder of its own; models wait for ever, so that no geometry runs."""

    def __init__(self, settings=SETTINGS, environment=None, furnish=lambda folder: None):
        self.holder = tempfile.TemporaryDirectory(prefix="packmerger-web-")
        self.folder = pathlib.Path(self.holder.name)
        self.port = free_port()
        (self.folder / "out").mkdir()
        (self.folder / "page").mkdir()
        (self.folder / "page" / "index.html").write_text("<!doctype html><title>page</title>")
        (self.folder / "secret").write_text("secret")
        (self.folder / "page" / "way-out").symlink_to(self.folder / "secret")
        wait = self.folder / "wait"
        wait.write_text("#!/bin/sh\nexec sleep 1000\n")
        wait.chmod(0o755)
        furnish(self.folder)
        self.environment = dict(os.environ, **(environment or {}))
        self.configure(settings)
        self.log = open(self.folder / "log", "w")
        self.start()
        self.key = self.shell("keys", "add", "tester").stdout.strip()

    def configure(self, settings):
        text = settings.replace("PORT", str(self.port)).replace("PREPARE", str(self.folder / "wait"))
        (self.folder / "c.toml").write_text(text.replace("FOLDER", str(self.folder)))

    def start(self):
        self.process = subprocess.Popen([program.binary("packmergerd"), "--config", self.folder / "c.toml"],
                                        stdout=self.log, stderr=self.log, env=self.environment)
        wait_for(lambda: is_open(self.port), "the web server")

    def stop(self):
        self.process.terminate()
        self.process.wait(60)

    def said(self):
        return (self.folder / "log").read_text()

    def shell(self, *arguments):
        return subprocess.run([program.binary(), *arguments, "--socket", self.folder / "state/packmergerd.sock"],
                              capture_output=True, text=True, timeout=60)

    def ask(self, method, target, body=None, headers=None, key=True):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        headers = {**({"X-Api-Key": self.key} if key is True else {"X-Api-Key": key} if key else {}), **(headers or {})}
        try:
            connection.request(method, target, body, headers)
        except BrokenPipeError:
            pass  # refused before all was sent
        reply = connection.getresponse()
        content = reply.read()
        connection.close()
        return reply.status, content, reply.headers

    def raw(self, data, patience=5):
        """What comes back for these very bytes."""
        answer = b""
        with socket.create_connection(("127.0.0.1", self.port), 5) as one:
            one.settimeout(patience)
            try:
                one.sendall(data)
                while piece := one.recv(65536):
                    answer += piece
            except OSError:
                pass
        return answer

    def upload(self, name=b"a.stl", content=STL, fields=((b"printer", b"objet"),), key=True, file_field=b"file", extra=b""):
        body = b""
        for field, value in fields:
            body += b'--FORM7\r\nContent-Disposition: form-data; name="' + field + b'"\r\n\r\n' + value + b"\r\n"
        body += b'--FORM7\r\nContent-Disposition: form-data; name="' + file_field + b'"; filename="' + name + b'"\r\n\r\n'
        body += content + b"\r\n" + extra + b"--FORM7--\r\n"
        return self.ask("POST", "/api/v1/jobs", body, {"Content-Type": "multipart/form-data; boundary=FORM7"}, key)

    def memory_kib(self):
        status = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.split("VmRSS:")[1].split()[0])

    def close(self):
        self.stop()
        self.log.close()
        self.holder.cleanup()


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.daemon = Daemon()

    @classmethod
    def tearDownClass(cls):
        alive = cls.daemon.process.poll() is None
        cls.daemon.close()
        assert alive, "the daemon died"
