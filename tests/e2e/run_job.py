#!/usr/bin/python3
"""run_job.py MODEL PROFILE [--keep DIR] [prepare's options …]: prepares a job and verifies it.

MODEL is `bunny` (from the npm package), the name of a file in PACKMERGER_MODELS without its suffix, or a path.
Exits 0, 1 when something is wrong, 77 when the model is not there.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program
from check_job import check


def find_model(name, folder):
    if pathlib.Path(name).is_file():
        return pathlib.Path(name)
    if name == "bunny":
        return program.bunny(folder)
    found = sorted(program.models().glob(name + ".*")) if program.models() else []
    return found[0] if found else None


def validate_gltf(job):
    """Failures of the Khronos validator; None where it is not installed."""
    script = program.SOURCE / "tests" / "e2e" / "validate_gltf.js"
    done = subprocess.run(["node", script, job / "preview.glb", job / "assembly.glb", job / "page.glb"], capture_output=True, text=True)
    if done.returncode == program.SKIPPED:
        return None
    return "" if done.returncode == 0 else done.stdout + done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model")
    parser.add_argument("profile")
    parser.add_argument("--keep", help="leaves the job folder there")
    arguments, options = parser.parse_known_args()
    with tempfile.TemporaryDirectory(prefix="packmerger-e2e-") as folder:
        folder = pathlib.Path(folder)
        model = find_model(arguments.model, folder)
        if model is None:
            print(f"skipped: no model {arguments.model}: set PACKMERGER_MODELS, or run npm ci for the bunny")
            return program.SKIPPED
        job = pathlib.Path(arguments.keep) if arguments.keep else folder / "job"
        result = program.run("prepare", model, "--profile", arguments.profile, "--out", job, *options, timeout=550)
        print(f"prepare: {result.seconds:.1f} s, {result.peak_bytes / 2 ** 20:.0f} MiB at most")
        if result.code != 0:
            print(result)
            return 1
        report = check(job, [model])
        invalid = validate_gltf(job)
        if invalid is None:
            report.skip("glTF files are valid", "the npm package gltf-validator is not installed")
        else:
            report.check("glTF files are valid", not invalid, invalid)
        print("\n".join(report.lines()))
        return 1 if report.failures() else 0


if __name__ == "__main__":
    sys.exit(main())
