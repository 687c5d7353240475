"""A workshop for tests: packmergerd with simulated printers, which may be killed and started again, and what must hold
of every program that was ever dropped: one job, one file, printed once at most and then from its first line to its last."""
import hashlib
import json
import os
import pathlib
import signal
import socket
import subprocess
import time

import program

SETTINGS = """state = "state"
retry_s = 0.2
[watch]
still_s = 0.1
rescan_s = 0.5
give_up_s = 1
"""
PRINTER = """
[printer.{name}]
profile = "{profile}"
port = "{port}"
approve = "auto"
simulated = true
"""
ENDED = ("done", "failed", "cancelled")
MOST_LISTED = 1000
NOTES = (".result.json", ".reason.txt", ".png")


def sha256(data):
    return hashlib.sha256(data).hexdigest()


def gcode(mark, moves=8):
    """A program that tells its mark in its first and its last line."""
    return "".join(f"{line}\n" for line in
                   [f"M117 begin {mark}", "G28", *(f"G1 X{i % 100} Y{i % 90} F9000" for i in range(moves)), f"M117 end {mark}"])


class Workshop:
    def __init__(self, test, folder, printers=2, settings=SETTINGS, environment=None, speed="inf"):
        self.test, self.folder, self.environment = test, pathlib.Path(folder), environment or {}
        self.state = self.folder / "state"
        self.printers = [f"m{i}" for i in range(printers)]
        shown = program.run("profiles", "show", "marlin").out
        (self.folder / "fast.toml").write_text(shown.replace("boot_wait_s = 2", "boot_wait_s = 0.05"))
        self.simulators = []
        for name in self.printers:
            one = program.Background(test, "packmerger", "simulate", "marlin", "--speed", speed, "--record",
                                     self.record(name), log=self.folder / f"{name}.log")
            self.simulators.append(one)
            settings += PRINTER.format(name=name, profile=self.folder / "fast.toml", port=one.child.stdout.readline().strip())
        (self.folder / "d.toml").write_text(settings)
        self.daemon = None
        self.settled = {}
        test.addCleanup(self.kill)

    def record(self, name):
        return self.folder / f"{name}.record"

    def inbox(self, name):
        return self.state / "folders" / name

    def start(self, patience_s=20, prefix=()):
        """Seconds until the socket answers; None where the daemon ended instead."""
        log = open(self.folder / "daemon.log", "ab")
        begun = time.monotonic()
        self.daemon = subprocess.Popen([*prefix, program.binary("packmergerd"), "--config", self.folder / "d.toml"],
                                       stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                                       env={**os.environ, **self.environment})
        log.close()
        while time.monotonic() - begun < patience_s:
            if self.daemon.poll() is not None:
                return None
            try:
                self.ask("printers.list")
                return time.monotonic() - begun
            except OSError:
                time.sleep(0.01)
        self.test.fail(f"the daemon does not answer: {self.log()}")

    def kill(self):
        if self.daemon is not None and self.daemon.poll() is None:
            self.daemon.send_signal(signal.SIGKILL)
            self.daemon.wait()

    def end(self):
        self.daemon.send_signal(signal.SIGTERM)
        return self.daemon.wait(timeout=60)

    def close(self):
        """Ends the printers too; they end with the test anyway."""
        self.kill()
        for one in self.simulators:
            one.end()

    def log(self):
        return (self.folder / "daemon.log").read_text(errors="replace")[-3000:]

    def reply(self, verb, **arguments):
        with socket.socket(socket.AF_UNIX) as line:
            line.settimeout(60)
            line.connect(str(self.state / "packmergerd.sock"))
            line.sendall(json.dumps({"verb": verb, **arguments}).encode() + b"\n")
            reply = json.loads(line.makefile().readline() or "{}")
        if not reply:
            raise ConnectionError("the daemon ended before it answered")
        return reply

    def ask(self, verb, **arguments):
        reply = self.reply(verb, **arguments)
        self.test.assertTrue(reply["ok"], reply)
        return reply["result"]

    def jobs(self):
        """All of them; an ended one whose file was filed is asked for once."""
        listed, before = {}, None
        while before is None or any(number not in self.settled for number in range(1, before)):
            page = self.ask("jobs.list", limit=MOST_LISTED, **({} if before is None else {"before": before}))
            listed.update({job["id"]: job for job in page})
            if len(page) < MOST_LISTED:
                break
            before = page[-1]["id"]
        self.settled.update({number: job for number, job in listed.items() if job["state"] in ENDED and job["filed"]})
        return list({**self.settled, **listed}.values())

    def drop(self, printer, name, text):
        """As a careful program does it: under a name that is left alone, then renamed."""
        inbox = self.inbox(printer)
        inbox.mkdir(parents=True, exist_ok=True)
        (inbox / f".{name}").write_text(text)
        (inbox / f".{name}").rename(inbox / name)

    def wait_for(self, holds, patience_s=120, told=None):
        end = time.monotonic() + patience_s
        while (begun := time.monotonic()) < end:
            if holds():
                return
            time.sleep(max(0.05, 4 * (time.monotonic() - begun)))  # so that the daemon has time for other things
        self.test.fail(f"it did not happen: {told() if told else [j for j in self.jobs() if j['state'] not in ENDED][:3]}; {self.log()}")

    def wait_until_all_ended(self, count, patience_s=120):
        self.wait_for(lambda: len(jobs := self.jobs()) >= count and all(job["state"] in ENDED and job["filed"] for job in jobs),
                      patience_s)

    def filed(self):
        """{sha256: [(done or failed, path)]} of everything that was filed."""
        found = {}
        for printer in self.printers:
            for place in ("done", "failed"):
                for path in (self.inbox(printer) / place).glob("*"):
                    if path.is_file() and not path.name.endswith(NOTES):
                        found.setdefault(sha256(path.read_bytes()), []).append((place, path))
        return found

    def times_printed(self):
        """How often each "M117 begin …" and "M117 end …" was executed, by any printer."""
        told = {}
        for name in self.printers:
            if self.record(name).exists():
                for line in self.record(name).read_text(errors="replace").splitlines():
                    if line.startswith("M117 "):
                        told[line] = told.get(line, 0) + 1
        return told

    def check(self, dropped):
        """dropped: {what gcode() was given: its text}; every one became one job. Returns the jobs likewise."""
        test, jobs, printed, filed = self.test, {}, self.times_printed(), self.filed()
        by_hash = {sha256(text.encode()): mark for mark, text in dropped.items()}
        for job in self.jobs():
            test.assertIn(job["sha256"], by_hash, f"a job of bytes that nobody dropped: {job}")
            mark = by_hash[job["sha256"]]
            test.assertNotIn(mark, jobs, f"{mark} became two jobs")
            jobs[mark] = job
        test.assertEqual(sorted(set(dropped) - set(jobs)), [], "each drop is a job")
        for mark, text in dropped.items():
            job, begins, ends = jobs[mark], printed.get(f"M117 begin {mark}", 0), printed.get(f"M117 end {mark}", 0)
            test.assertLessEqual(max(begins, ends), 1, f"{mark} was printed {begins} times")
            if job["state"] == "done":
                test.assertEqual((begins, ends), (1, 1), f"{mark} is done, but was not printed to its end")
            files = filed.get(sha256(text.encode()), [])
            test.assertEqual(len(files), 1, f"{mark} lies in {files}")
            place, path = files[0]
            test.assertEqual(place, "done" if job["state"] == "done" else "failed", job)
            if job["state"] == "failed":
                test.assertTrue(job["reason"] and job["hint"], job)
                test.assertTrue(path.with_name(path.name + ".reason.txt").exists(), path)
        test.assertEqual(set(printed) - {f"M117 {word} {mark}" for word in ("begin", "end") for mark in dropped}, set(),
                         "something was printed that nobody dropped")
        return jobs

    def left_in_inboxes(self):
        return [path for printer in self.printers for path in self.inbox(printer).iterdir()
                if path.name not in ("done", "failed")]
