"""Runs the real programs as a user would. PACKMERGER_BIN names the folder they are in."""
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import threading
import time

SKIPPED = 77  # ctest's SKIP_RETURN_CODE
SOURCE = pathlib.Path(__file__).resolve().parents[2]
ADDRESS_SPACE = 4 << 30


def binary(name="packmerger"):
    return str(pathlib.Path(os.environ.get("PACKMERGER_BIN", SOURCE / "build" / "bin")) / name)


def models():
    """The folder of real meshes; None where it is not there."""
    folder = pathlib.Path(os.environ.get("PACKMERGER_MODELS") or SOURCE.parent / "shared" / "models")
    return folder if folder.is_dir() else None


def limit_memory():
    """For a child: an address space that a sanitizer's shadow memory would not fit into is not limited."""
    if not os.environ.get("PACKMERGER_SANITIZED"):
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))


class Result:
    def __init__(self, code, out, err, seconds, peak_bytes):
        self.code, self.out, self.err = code, out, err
        self.seconds, self.peak_bytes = seconds, peak_bytes

    def __str__(self):
        return f"exit {self.code} after {self.seconds:.1f} s; stderr: {self.err[-1500:]}"


def run(*arguments, timeout=240, limited=False, cwd=None, temporary=None, prefix=()):
    """Result of `packmerger ARGUMENTS…`; what is still running after timeout is killed with its children."""
    environment = dict(os.environ, **({"TMPDIR": str(temporary)} if temporary else {}))
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.monotonic()
        child = subprocess.Popen([*prefix, binary(), *map(str, arguments)], stdout=out, stderr=err, cwd=cwd,
                                 env=environment, stdin=subprocess.DEVNULL, start_new_session=True,
                                 preexec_fn=limit_memory if limited else None)
        guard = threading.Timer(timeout, lambda: os.killpg(child.pid, 9))
        guard.start()
        _, status, usage = os.wait4(child.pid, 0)
        guard.cancel()
        child.returncode = os.waitstatus_to_exitcode(status)
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode(errors="replace"))
        return Result(child.returncode, *texts, time.monotonic() - start, usage.ru_maxrss * 1024)


class Background:
    """A program of ours that runs beside the test."""

    def __init__(self, test, name, *arguments, log):
        self.log = open(log, "w+b")
        self.child = subprocess.Popen([binary(name), *map(str, arguments)], stdin=subprocess.DEVNULL,
                                      stdout=subprocess.PIPE, stderr=self.log, text=True)
        test.addCleanup(self.end)

    def end(self):
        self.child.terminate()
        code = self.child.wait(timeout=60)
        self.child.stdout.close()
        self.log.close()
        return code


def bunny(folder):
    """Writes bunny.obj into folder; None where node or its npm package is missing."""
    out = pathlib.Path(folder) / "bunny.obj"
    if shutil.which("node") is None:
        return None
    made = subprocess.run(["node", SOURCE / "tests" / "fixtures" / "bunny_obj.js", out], capture_output=True)
    return out if made.returncode == 0 else None


def files_below(folder):
    return sorted(str(path.relative_to(folder)) for path in pathlib.Path(folder).rglob("*"))
