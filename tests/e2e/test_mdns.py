#!/usr/bin/python3
"""Printers on the network: a real avahi-daemon on a D-Bus of its own, which comes and goes."""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

from program import SKIPPED
from web_daemon import SETTINGS, Daemon, wait_for

AVAHI = shutil.which("avahi-daemon", path="/usr/sbin:/usr/bin")
BUS = """<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"
 "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">
<busconfig><type>system</type><listen>unix:path=FOLDER/bus</listen><auth>EXTERNAL</auth>
<policy context="default"><allow user="*"/><allow own="*"/><allow send_type="method_call"/>
<allow send_type="signal"/><allow send_type="method_return"/><allow send_type="error"/>
<allow receive_type="method_call"/><allow receive_type="signal"/><allow receive_type="method_return"/>
<allow receive_type="error"/><allow send_destination="*"/><allow receive_sender="*"/></policy></busconfig>
"""


class Network:
    """A D-Bus and an avahi-daemon that nobody else uses."""

    def __init__(self):
        self.holder = tempfile.TemporaryDirectory(prefix="packmerger-mdns-")
        self.folder = pathlib.Path(self.holder.name)
        (self.folder / "bus.conf").write_text(BUS.replace("FOLDER", str(self.folder)))
        self.environment = {"DBUS_SYSTEM_BUS_ADDRESS": f"unix:path={self.folder}/bus"}
        self.bus = self.avahi = None
        (self.folder / "avahi.conf").write_text("[server]\nuse-ipv6=no\nallow-interfaces=lo\nhost-name=packmerger-test\n[publish]\npublish-workstation=no\n")

    def start_bus(self):
        self.bus = subprocess.Popen(["dbus-daemon", "--nofork", f"--config-file={self.folder}/bus.conf"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        wait_for((self.folder / "bus").exists, "D-Bus")

    def start_avahi(self):
        with open(self.folder / "avahi.log", "ab") as log:
            self.avahi = subprocess.Popen([AVAHI, "--no-rlimits", "--no-drop-root", "--no-chroot", "-f", self.folder / "avahi.conf"],
                                          env={**os.environ, **self.environment}, stdout=log, stderr=log)

    def stop(self, which):
        process = getattr(self, which)
        if process:
            process.terminate()
            process.wait(30)
        setattr(self, which, None)

    def services(self):
        """Names and TXT records as avahi-browse finds them."""
        told = subprocess.run(["avahi-browse", "-rpt", "_octoprint._tcp"], env={**os.environ, **self.environment},
                              capture_output=True, text=True, timeout=60).stdout
        found = {}
        for line in told.splitlines():
            fields = line.split(";")
            if fields[0] == "=":
                found[fields[3].replace("\\032", " ").replace("\\040", "(").replace("\\041", ")")] = (int(fields[8]), fields[9])
        return found

    def close(self):
        self.stop("avahi")
        self.stop("bus")
        self.holder.cleanup()


class Announced(unittest.TestCase):
    def setUp(self):
        self.network = Network()
        self.addCleanup(self.network.close)

    def daemon(self, address="0.0.0.0"):
        settings = SETTINGS.replace("[web]", f'[web]\naddress = "{address}"')
        daemon = Daemon(settings + '[printer.lab]\nprofile = "marlin"\nport = "/dev/none"\n', self.network.environment)
        self.addCleanup(daemon.close)
        return daemon

    def troubles(self, daemon):
        return [one["about"] for one in json.loads(daemon.ask("GET", "/api/v1/troubles")[1])]

    def test_each_printer_with_its_path_and_no_key(self):
        self.network.start_bus()
        self.network.start_avahi()
        daemon = self.daemon()
        found = wait_for(lambda: (lambda all_: all_ if len(all_) == 2 else None)(self.network.services()), "both printers")
        for printer in ("lab", "objet"):
            name = next(name for name in found if name.startswith(printer + " (PackMerger on "))
            port, text = found[name]
            self.assertEqual(port, daemon.port)
            for part in (f'"path=/printers/{printer}"', '"version=', '"api=', '"uuid=', '"model='):
                self.assertIn(part, text)
            self.assertNotIn(daemon.key, text)
            self.assertNotIn('"u=', text)
            self.assertNotIn('"p=', text)
        self.assertEqual(daemon.said().count("are announced"), 1)
        daemon.stop()
        wait_for(lambda: not self.network.services(), "their end")
        daemon.start()
        wait_for(lambda: len(self.network.services()) == 2, "both again")

    def test_avahi_comes_and_goes(self):
        self.network.start_bus()
        daemon = self.daemon()
        wait_for(lambda: "avahi-daemon does not run" in daemon.said(), "the log")
        self.assertEqual(self.troubles(daemon), [], "it need not be installed")
        self.network.start_avahi()
        wait_for(lambda: len(self.network.services()) == 2, "both printers")
        self.network.stop("avahi")
        wait_for(lambda: daemon.said().count("not announced") == 2, "the log")
        wait_for(lambda: self.troubles(daemon) == ["announcing printers (mDNS)"], "the trouble")
        self.network.start_avahi()
        wait_for(lambda: len(self.network.services()) == 2, "both again")
        wait_for(lambda: not self.troubles(daemon), "the end of the trouble")
        self.assertEqual(daemon.said().count("not announced"), 2, "told once each time")

    def test_without_any_bus_it_goes_on(self):
        daemon = self.daemon()
        wait_for(lambda: "not announced" in daemon.said(), "the log")
        time.sleep(2)
        self.assertEqual(daemon.said().count("not announced"), 1)
        self.assertEqual(self.troubles(daemon), [])
        self.assertEqual(daemon.ask("GET", "/api/v1/printers")[0], 200)

    def test_a_daemon_that_nobody_reaches_is_not_announced(self):
        self.network.start_bus()
        self.network.start_avahi()
        daemon = self.daemon("127.0.0.1")
        time.sleep(2)
        self.assertFalse(self.network.services())
        self.assertNotIn("announced", daemon.said())


if __name__ == "__main__":
    # it keeps a file in /run, and there can be one of it at a time
    if os.geteuid() != 0:
        print("skipped: only root can start an avahi-daemon")
        sys.exit(SKIPPED)
    if AVAHI and subprocess.run([AVAHI, "--check"], stderr=subprocess.DEVNULL).returncode == 0:
        print("skipped: this machine's own avahi-daemon runs")
        sys.exit(SKIPPED)
    missing = [name for name in ("dbus-daemon", "avahi-browse") if shutil.which(name) is None] + ([] if AVAHI else ["avahi-daemon"])
    if missing:
        print("skipped: not installed: " + ", ".join(missing))
        sys.exit(SKIPPED)
    unittest.main()
