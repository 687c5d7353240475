"""A fresh Debian 12 under a systemd of its own: mmdebstrap makes its root, systemd-nspawn boots it. Needs root and the
network, and Debian's packages mmdebstrap and systemd-container."""
import os
import pathlib
import shutil
import socket
import subprocess
import time
import urllib.parse

import program

BUILD = pathlib.Path(program.binary()).parents[1]
PACKAGES = "systemd,systemd-sysv,dbus,udev"
KEPT_S = 30 * 24 * 3600  # older roots are made anew
ENVIRONMENT = ["env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL=C.UTF-8", "TERM=dumb", "DEBIAN_FRONTEND=noninteractive"]

# systemd-nspawn of Debian 12 forbids Landlock's calls of its own, and the daemon would find a kernel without Landlock.
LANDLOCK = "landlock_create_ruleset landlock_add_rule landlock_restrict_self"

# Where no systemd runs outside, nobody registers the machine or makes its place among the control groups, which its systemd
# wants as version 2. Two machines in one place would end each other's services: each has the one that $0 names.
CONTROL_GROUPS = """mount --make-rprivate /
if [ "$(stat -f -c %T /sys/fs/cgroup)" != cgroup2fs ]; then umount -l /sys/fs/cgroup && mount -t cgroup2 none /sys/fs/cgroup; fi
"""
ALONE = CONTROL_GROUPS + """mkdir "/sys/fs/cgroup/$0"
echo $$ > "/sys/fs/cgroup/$0/cgroup.procs"
exec "$@" --register=no --keep-unit"""
LEAVE = CONTROL_GROUPS + 'find "/sys/fs/cgroup/$0" -depth -type d -exec rmdir {} +'
WEB = {"http": 80, "https": 443}


def missing():
    """Why no machine can be made here; None where one can."""
    if os.geteuid() != 0:
        return "only root can boot a machine"
    for tool, package in (("mmdebstrap", "mmdebstrap"), ("systemd-nspawn", "systemd-container"), ("cpack", "cmake")):
        if shutil.which(tool) is None:
            return f"{tool} is not here: apt-get install {package}"
    sites = subprocess.run(["apt-get", "indextargets", "--format", "$(SITE)"], capture_output=True, text=True).stdout
    for site in map(urllib.parse.urlsplit, sorted(set(sites.split()))):
        if not (port := site.port or WEB.get(site.scheme)):
            continue
        try:
            socket.create_connection((site.hostname, port), 10).close()
            return None
        except OSError:
            continue
    return "Debian's packages are out of reach"


def make_package(folder, version=None):
    """packmerger.deb of the programs as they are built, under another version where one is named."""
    folder.mkdir(exist_ok=True)
    named = ["-R", version] if version else []
    made = subprocess.run(["sh", "-c", 'umask 022; exec cpack "$@"', "cpack", "--config", BUILD / "CPackConfig.cmake", *named,
                           "-B", folder], capture_output=True, text=True)
    if made.returncode != 0:
        raise AssertionError(made.stdout + made.stderr)
    return folder / "packmerger.deb"


def base_root():
    """The tar archive of a root with little more than systemd and apt, kept in the build folder."""
    kept = BUILD / "debian-12.tar"
    if kept.exists() and time.time() - kept.stat().st_mtime < KEPT_S:
        return kept
    new = BUILD / "debian-12.new.tar"
    new.unlink(missing_ok=True)
    subprocess.run(["mmdebstrap", "--quiet", "--variant=minbase", f"--include={PACKAGES}", "bookworm", new], check=True)
    return new.rename(kept)


class Machine:
    """Runs until end(). It shares the network with us: what listens there at 127.0.0.1 is reached from here."""

    def __init__(self, folder, log):
        self.root = pathlib.Path(folder) / "root"
        self.root.mkdir()
        subprocess.run(["tar", "--extract", "--numeric-owner", "--file", base_root(), "--directory", self.root], check=True)
        archives = BUILD / "debian-12-archives"  # so that a further run downloads nothing again
        (archives / "partial").mkdir(parents=True, exist_ok=True)
        (self.root / "etc/apt/apt.conf.d/90keep").write_text('Binary::apt::APT::Keep-Downloaded-Packages "1";\n')
        self.name = f"packmerger-test-{os.getpid()}"
        self.alone = not pathlib.Path("/run/systemd/system").is_dir()
        boot = ["systemd-nspawn", "--quiet", "--boot", f"--directory={self.root}", f"--machine={self.name}", "--console=pipe",
                f"--system-call-filter={LANDLOCK}", "--resolv-conf=copy-host", f"--bind={archives}:/var/cache/apt/archives"]
        if self.alone:
            boot = ["unshare", "--mount", "sh", "-ec", ALONE, self.name, *boot]
        self.log = open(log, "wb")
        self.nspawn = subprocess.Popen(boot, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log,
                                       env=dict(os.environ, SYSTEMD_NSPAWN_UNIFIED_HIERARCHY="1"))
        try:
            self.init = self.wait_for(self.find_init, "the machine's first process")
            self.wait_for(lambda: self.run("systemctl", "is-system-running").stdout.strip() in ("running", "degraded"), "its start")
        except BaseException:
            self.nspawn.kill()  # nobody else knows of it yet, and its folder is removed
            self.nspawn.wait()
            raise

    def find_init(self):
        """The process that is the first one in there."""
        if self.nspawn.poll() is not None:
            raise AssertionError(f"systemd-nspawn ended: {pathlib.Path(self.log.name).read_text(errors='replace')}")
        for status in pathlib.Path("/proc").glob("[0-9]*/status"):
            try:
                told = dict(line.split(":\t", 1) for line in status.read_text().splitlines() if ":\t" in line)
            except OSError:
                continue  # it has just ended
            if told["PPid"] == str(self.nspawn.pid) and told["Name"] == "systemd":
                return status.parent.name
        return None

    def wait_for(self, holds, what, patience=120):
        """What holds() gives, once it is true."""
        end = time.monotonic() + patience
        while not (found := holds()):
            if time.monotonic() > end:
                raise AssertionError(f"waited in vain for {what}")
            time.sleep(0.3)
        return found

    def run(self, *command):
        """A command in there, as its root."""
        enter = ["nsenter", "--target", self.init, "--mount", "--uts", "--ipc", "--pid", "--cgroup", "--net"]
        return subprocess.run([*enter, *ENVIRONMENT, *map(str, command)], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, errors="replace", timeout=900)

    def end(self):
        if self.nspawn.poll() is None:
            self.run("systemctl", "poweroff")
        try:
            self.nspawn.wait(120)
        except subprocess.TimeoutExpired:
            self.nspawn.kill()
            self.nspawn.wait()
        if self.alone:
            subprocess.run(["unshare", "--mount", "sh", "-ec", LEAVE, self.name], check=True)
        self.log.close()
