#!/usr/bin/python3
"""Webhooks and MQTT: a real broker, and a web server that fails in every way."""
import hashlib
import hmac
import http.server
import json
import pathlib
import shutil
import subprocess
import sys
import threading
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from web_daemon import SETTINGS, Daemon, free_port, is_open, wait_for

MOSQUITTO = shutil.which("mosquitto", path="/usr/sbin:/usr/bin:/usr/local/sbin")


class Receiver:
    """A web server whose next answers the test decides: a status, or "slow" or "redirect"."""

    def __init__(self, port=0):
        self.got, self.script, self.paths = [], [], []
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            def do_POST(self):
                outer.paths.append(self.path)
                body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
                answer = outer.script.pop(0) if outer.script else 200
                outer.got.append((answer, dict(self.headers), body))
                if answer == "slow":
                    time.sleep(8)
                    answer = 200
                self.send_response(302 if answer == "redirect" else answer)
                if answer == "redirect":
                    self.send_header("Location", f"http://127.0.0.1:{outer.port}/elsewhere")
                self.send_header("Content-Length", "0")
                self.end_headers()

            do_GET = do_POST

            def log_message(self, *_):
                pass

        self.server = http.server.ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self.port = self.server.server_address[1]
        self.thread = threading.Thread(target=self.server.serve_forever, daemon=True)
        self.thread.start()

    def events(self, taken_only=True):
        return [json.loads(body) for answer, _, body in self.got if answer == 200 or answer == "slow" or not taken_only]

    def jobs(self):
        return [(one["job"]["id"], one["job"]["state"]) for one in self.events() if one["event"] == "job"]

    def close(self):
        self.server.shutdown()
        self.server.server_close()


class Webhook(unittest.TestCase):
    def setUp(self):
        self.receiver = Receiver()
        self.addCleanup(lambda: self.receiver.close())
        self.daemon = Daemon(SETTINGS + f'[[webhook]]\nurl = "http://127.0.0.1:{self.receiver.port}/hook"\nsecret = "s3cret"\n')
        self.addCleanup(self.daemon.close)

    def upload(self):
        status, content, _ = self.daemon.upload()
        self.assertEqual(status, 201)
        return json.loads(content)["id"]

    def undelivered(self):
        file = self.daemon.folder / "state/undelivered.jsonl"
        return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []

    def test_every_change_arrives_in_order_and_signed(self):
        job = self.upload()
        self.daemon.ask("POST", f"/api/v1/jobs/{job}/cancel")
        wait_for(lambda: (job, "cancelled") in self.receiver.jobs(), "the end of the job")
        self.assertEqual([state for number, state in self.receiver.jobs() if number == job], ["received", "preparing", "cancelled"])
        self.daemon.ask("POST", "/api/v1/printers/objet/pause")
        wait_for(lambda: any(one["event"] == "printer" and one["printer"]["paused"] for one in self.receiver.events()), "the pause")
        for _, headers, body in self.receiver.got:
            expected = "sha256=" + hmac.new(b"s3cret", body, hashlib.sha256).hexdigest()
            self.assertEqual(headers["X-PackMerger-Signature"], expected)
            self.assertEqual(headers["Content-Type"], "application/json")
            self.assertNotIn(b"s3cret", body)
        deliveries = [headers["X-PackMerger-Delivery"] for _, headers, _ in self.receiver.got]
        self.assertEqual(len(set(deliveries)), len(deliveries))

    def test_what_fails_for_a_while_is_tried_again(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        self.receiver.script = [500, 503, 429]
        job = self.upload()
        wait_for(lambda: (job, "preparing") in self.receiver.jobs(), "both messages")
        self.assertEqual(self.receiver.jobs(), [(job, "received"), (job, "preparing")])
        tries = [headers["X-PackMerger-Delivery"] for answer, headers, _ in self.receiver.got[1:5]]
        self.assertEqual(len(set(tries)), 1, "one message, four tries")
        self.assertIn("HTTP 500", self.daemon.said())
        self.assertNotIn("/hook", self.daemon.said(), "a path may be a secret")
        self.assertFalse(self.undelivered())

    def test_what_is_refused_for_good_is_kept(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        self.receiver.script = [404, "redirect"]
        job = self.upload()
        wait_for(lambda: len(self.undelivered()) == 2, "the dead letters")
        self.assertEqual([one["why"] for one in self.undelivered()], ["HTTP 404", "HTTP 302"])
        self.assertEqual(self.undelivered()[0]["message"]["job"]["id"], job)
        self.assertEqual(set(self.receiver.paths), {"/hook"}, "redirects are not followed")
        self.assertEqual(len(self.receiver.got), 3)

    def test_a_slow_receiver_keeps_nobody_waiting(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        self.receiver.script = ["slow"]
        self.upload()
        wait_for(lambda: len(self.receiver.got) > 1, "the slow one")
        begun = time.monotonic()
        for _ in range(5):
            self.assertEqual(self.daemon.ask("GET", "/api/v1/state")[0], 200)
        self.assertLess(time.monotonic() - begun, 5)

    def troubles(self):
        return json.loads(self.daemon.ask("GET", "/api/v1/troubles")[1])

    def test_a_receiver_that_fails_is_seen_until_it_does_not(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        self.assertEqual(self.troubles(), [])
        self.receiver.script = [503] * 3
        job = self.upload()
        seen = wait_for(self.troubles, "the trouble")[0]
        self.assertEqual((seen["about"], seen["what"]), (f"webhook http://127.0.0.1:{self.receiver.port}", "HTTP 503"))
        self.assertGreater(seen["next_s"], seen["since_s"])
        told = self.daemon.shell("printers", "list").stderr
        self.assertRegex(told, r"webhook http://127.0.0.1:\d+: HTTP 503 \(since 20\d\d-.*, next ")
        self.assertNotIn("/hook", told)
        wait_for(lambda: (job, "preparing") in self.receiver.jobs(), "both messages")
        wait_for(lambda: not self.troubles(), "the end of the trouble")
        self.assertEqual(self.daemon.said().count("HTTP 503"), 1)

    def test_a_receiver_that_is_away_gets_it_later(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        port = self.receiver.port
        self.receiver.close()
        job = self.upload()
        wait_for(lambda: "webhook" in self.daemon.said(), "the log")
        self.receiver = Receiver(port)
        wait_for(lambda: (job, "preparing") in self.receiver.jobs(), "what happened meanwhile")
        self.assertEqual(self.receiver.jobs(), [(job, "received"), (job, "preparing")])

    def test_the_end_of_the_daemon_is_told_or_kept(self):
        wait_for(lambda: self.receiver.got, "the printer's state")
        self.receiver.close()
        job = self.upload()
        wait_for(lambda: "webhook" in self.daemon.said(), "the log")
        begun = time.monotonic()
        self.daemon.stop()
        self.assertLess(time.monotonic() - begun, 30)
        kept = [one["message"]["job"] for one in self.undelivered() if one["message"]["event"] == "job"]
        self.assertIn((job, "received"), [(one["id"], one["state"]) for one in kept])
        self.receiver = Receiver()

    def test_secrets_stay_in_the_settings(self):
        job = self.upload()
        wait_for(lambda: self.receiver.jobs(), "a message")
        for text in (self.daemon.said(), str(self.daemon.ask("GET", f"/api/v1/jobs/{job}")[1]), str(self.receiver.got).replace("X-PackMerger", "")):
            self.assertNotIn("s3cret", text)


class Broker:
    """mosquitto in a folder of its own, with a user and a password, and what it was told."""

    def __init__(self, folder, port, tls=False, more=()):
        self.folder, self.port, self.tls = folder, port, tls
        subprocess.run(["mosquitto_passwd", "-c", "-b", folder / "users", "maker", "pass word"], check=True, capture_output=True)
        lines = [f"listener {port} 127.0.0.1", "allow_anonymous false", f"password_file {folder / 'users'}", "user root", *more]
        if tls:
            lines += [f"certfile {folder / 'cert.pem'}", f"keyfile {folder / 'key.pem'}"]
        (folder / "mosquitto.conf").write_text("\n".join(lines) + "\n")
        self.start()

    def start(self):
        with open(self.folder / "mosquitto.log", "ab") as log:
            self.process = subprocess.Popen([MOSQUITTO, "-c", self.folder / "mosquitto.conf"], stdout=log, stderr=log)
        wait_for(lambda: is_open(self.port), "the broker")

    def retained(self, topic):
        """What the broker keeps below a topic, as somebody is told who comes now."""
        tls = ["--cafile", self.folder / "cert.pem"] if self.tls else []
        told = subprocess.run(["mosquitto_sub", "-h", "localhost" if self.tls else "127.0.0.1", "-p", str(self.port), "-u", "maker", "-P", "pass word",
                               "-t", topic, "-v", "-W", "1", "--retained-only", *tls], capture_output=True, text=True)
        return dict(line.split(" ", 1) for line in told.stdout.splitlines())

    def stop(self, how="terminate"):
        getattr(self.process, how)()
        self.process.wait(30)


@unittest.skipUnless(MOSQUITTO and shutil.which("mosquitto_passwd") and shutil.which("mosquitto_sub"), "mosquitto and mosquitto-clients are not installed")
class Mqtt(unittest.TestCase):
    def begin(self, tls=False, up=True, password="pass word", more=()):
        port = free_port()
        self.daemon = None
        self.folder = pathlib.Path(program.tempfile.mkdtemp(prefix="packmerger-mqtt-"))
        self.addCleanup(shutil.rmtree, self.folder)
        if tls:
            subprocess.run(["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", "/CN=localhost", "-addext",
                            "subjectAltName=DNS:localhost", "-keyout", self.folder / "key.pem", "-out", self.folder / "cert.pem"], check=True, capture_output=True)
        self.broker = Broker(self.folder, port, tls, more)
        self.addCleanup(lambda: self.broker.stop())
        if not up:
            self.broker.stop()
        (self.folder / "password").write_text(password + "\n")
        host = "localhost" if tls else "127.0.0.1"
        more = f'tls = true\nca_file = "{self.folder}/cert.pem"\n' if tls else ""
        self.daemon = Daemon(SETTINGS + f'[mqtt]\nbroker = "{host}:{port}"\ntopic = "shop/packmerger"\nuser = "maker"\npassword_file = "{self.folder}/password"\n{more}')
        self.addCleanup(self.daemon.close)

    def told(self, topic="shop/#"):
        return self.broker.retained(topic)

    def job_state(self):
        text = self.told().get("shop/packmerger/printers/objet/job")
        return text and json.loads(text)["job"]["state"]

    def test_states_are_kept_for_whoever_comes(self):
        self.begin()
        wait_for(lambda: self.told().get("shop/packmerger/status") == "online", "online")
        wait_for(lambda: "shop/packmerger/printers/objet" in self.told(), "the printer")
        self.assertEqual(json.loads(self.told()["shop/packmerger/printers/objet"])["printer"]["name"], "objet")
        job = json.loads(self.daemon.upload()[1])["id"]
        wait_for(lambda: self.job_state() == "preparing", "the job")
        self.daemon.ask("POST", f"/api/v1/jobs/{job}/cancel")
        wait_for(lambda: self.job_state() == "cancelled", "its end")
        self.daemon.stop()
        wait_for(lambda: self.told().get("shop/packmerger/status") == "offline", "the farewell")
        self.daemon.start()

    def test_a_daemon_that_is_killed_is_offline(self):
        self.begin()
        wait_for(lambda: self.told().get("shop/packmerger/status") == "online", "online")
        self.daemon.process.kill()
        wait_for(lambda: self.told().get("shop/packmerger/status") == "offline", "the last will")

    def test_a_broker_that_restarts_is_told_again(self):
        self.begin()
        wait_for(lambda: "shop/packmerger/printers/objet" in self.told(), "the printer")
        self.broker.stop("kill")
        self.daemon.upload()
        self.daemon.ask("POST", "/api/v1/printers/objet/pause")
        self.assertEqual(self.daemon.ask("GET", "/api/v1/state")[0], 200, "nobody waits for the broker")
        self.broker.start()
        wait_for(lambda: self.told().get("shop/packmerger/status") == "online", "online")
        wait_for(lambda: json.loads(self.told().get("shop/packmerger/printers/objet", '{"printer": {"paused": false}}'))["printer"]["paused"], "the pause")
        self.assertEqual(self.job_state(), "preparing")

    def test_a_broker_that_comes_later(self):
        self.begin(up=False)
        wait_for(lambda: "cannot be reached" in self.daemon.said(), "the log")
        self.broker.start()
        wait_for(lambda: "shop/packmerger/printers/objet" in self.told(), "the printer")
        self.assertEqual(self.daemon.said().count("cannot be reached"), 1)

    def test_a_broker_that_takes_no_messages_is_tried_ever_less_often(self):
        self.begin(more=["max_packet_size 200"])  # whoever sends more is dropped
        troubles = lambda: json.loads(self.daemon.ask("GET", "/api/v1/troubles")[1])
        wait_for(lambda: [one for one in troubles() if one["tries"] == 2], "two tries")
        [seen] = troubles()
        self.assertEqual((seen["about"], seen["what"]), (f"MQTT broker 127.0.0.1:{self.broker.port}", "it does not take its messages"))
        self.assertGreaterEqual(seen["next_s"] - seen["since_s"], 14, "after 5 s, and after 10 s more")
        self.assertEqual(self.daemon.said().count("does not take"), 1, self.daemon.said())

    def test_tls(self):
        self.begin(tls=True)
        wait_for(lambda: "shop/packmerger/printers/objet" in self.told(), "the printer")

    def test_a_wrong_password_is_told(self):
        self.begin(password="wrong")
        wait_for(lambda: "refuses user and password" in self.daemon.said(), "the log")
        self.assertNotIn("wrong\n", self.daemon.said())


if __name__ == "__main__":
    unittest.main()
