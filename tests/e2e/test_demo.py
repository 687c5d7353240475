#!/usr/bin/python3
"""demo.sh as a new user runs it, after the build: what it promises is shown, made and where it says. It runs in a folder of
its own with the programs that are built already; installing and building are not repeated."""
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import urllib.request

import program
import web_daemon

INSTALL = "install_packages() { :; }\ninstall_npm_packages() { :; }\n"


class Demo(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory(prefix="packmerger-demo-")
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)
        self.port = web_daemon.free_port()
        script = (program.SOURCE / "demo.sh").read_text()
        self.assertIn("echo 8310", script)
        self.write("demo.sh", script.replace("echo 8310", f"echo {self.port}"))
        self.write("src/install/install.sh", INSTALL)
        self.write("tools/cmake", '#!/bin/sh\n[ -x build/bin/packmerger ]\n')
        for name in ("tests", "node_modules", "package.json"):
            (self.folder / name).symlink_to(program.SOURCE / name)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)

    def with_programs(self):
        (self.folder / "build").mkdir()
        (self.folder / "build/bin").symlink_to(pathlib.Path(program.binary()).parent)

    def start(self, *arguments):
        return subprocess.Popen([self.folder / "demo.sh", *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, start_new_session=True,
                                env={**os.environ, "PATH": f"{self.folder / 'tools'}:{os.environ['PATH']}"})

    def test_a_first_run_says_how_long_it_takes(self):
        demo = self.start()
        self.assertRegex(demo.communicate(timeout=60)[0], r"first run .* builds everything \(about .* minutes")
        self.assertNotEqual(demo.returncode, 0, "there is nothing to run yet")

    def test_what_the_program_is_for_is_shown_made_and_served(self):
        self.with_programs()
        demo = self.start("web")
        self.addCleanup(demo.stdout.close)
        lines = []
        for line in demo.stdout:
            lines.append(line)
            if "Ctrl-C ends it" in line:
                break
        told = "".join(lines)
        self.the_page_is_reached(told)
        os.killpg(demo.pid, signal.SIGINT)
        self.assertEqual(demo.wait(timeout=60), 0, told[-3000:])
        self.assertNotIn("first run", told)
        bunny, arch = (json.loads((self.made(told, name, "picture").parent / "job.json").read_text()) for name in ("the bunny", "the arch"))
        ways = bunny["estimates"]
        self.assertLess(ways["packed"]["time_s"], ways["solid"]["time_s"] * 0.4)
        self.assertLess(ways["packed"]["support_g"], ways["solid"]["support_g"] * 0.6)
        self.assertFalse(arch["estimates"]["solid"]["fits"], "too long in one piece")
        self.assertGreater(len(arch["parts"]), 1)
        for heading in (r"time +model +support", r"cost +material +machine +hands"):
            self.assertEqual(len(re.findall(heading, told)), 2, f"a table for each\n{told}")
        handed = self.made(told, "the bunny", "handed over")
        self.assertTrue(any(path.suffix in (".3mf", ".stl") for path in handed.iterdir()), handed)
        printed, of = map(int, re.search(r"Trays printed: (\d+) of (\d+)", told).groups())
        self.assertEqual(printed, of)
        for name in re.findall(r"/\S*build/demo\S*?(?=[,\s]|$)", told):
            self.assertTrue(pathlib.Path(name).exists(), name)

    def the_page_is_reached(self, told):
        link = re.search(r"The page: (http://\S+)#look=\S+", told)
        self.assertIsNotNone(link, told[-3000:])
        self.assertIn(f":{self.port}/", link.group(1))
        self.assertEqual(urllib.request.urlopen(link.group(1), timeout=60).status, 200)

    def made(self, told, model, what):
        """The file or folder that the last lines name."""
        block = told[told.rindex(f"  {model}"):]
        return pathlib.Path(re.search(rf"{what} +(\S+)", block).group(1))


if __name__ == "__main__":
    missing = [tool for tool in ("node", "prusa-slicer", "gpx") if not shutil.which(tool)]
    if missing or not (program.SOURCE / "node_modules").is_dir():
        print(f"skipped: {', '.join(missing) or 'node_modules'} missing", file=sys.stderr)
        sys.exit(program.SKIPPED)
    unittest.main()
