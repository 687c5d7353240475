#!/usr/bin/python3
"""Stands in for `packmerger prepare`: writes a small job folder, or misbehaves as the model's name says."""
import hashlib
import json
import os
import shutil
import signal
import sys
import time

model, arguments = sys.argv[2], sys.argv[3:]
value = {key: arguments[i + 1] for i, key in enumerate(arguments[:-1]) if key.startswith("--")}
name = os.path.basename(model)


def say(text):
    print(text, file=sys.stderr, flush=True)


def estimate(cost):
    return {"fits": True, "time_s": 60.0, "model_g": 1.0, "support_g": 0.5, "cost": cost, "currency": "EUR",
            "parts": 2, "trays": 1}


if sys.argv[1] == "compare":
    profile = os.path.basename(value["--profile"]).removesuffix(".toml")
    say("[ 50%] packing")
    if "broken" in name or "only-" in name and "only-" + profile not in name:
        say("error: It does not fit the printer.")
        say("hint: Scale it down.")
        sys.exit(65)
    packed = estimate(5.0 if profile == "objet30" else 8.0)
    print(json.dumps({profile: {"as_is": {"fits": False}, "solid": estimate(30.0), "hollow": estimate(20.0), "packed": packed}}))
    sys.exit(0)

out = value["--out"]
say("[  0%] reading")
if "broken" in name:
    say("error: The model has holes that cannot be closed.")
    say("hint: Repair it in another program.")
    sys.exit(65)
if "crash" in name:
    os.kill(0, signal.SIGSEGV)  # its own group: no other may be signalled
if "hang" in name:
    if os.fork() == 0:  # a grandchild that must end too
        with open(os.path.join(os.path.dirname(out), "grandchild.pid"), "w") as pid:
            pid.write(str(os.getpid()))
    say("[ 40%] packing")
    time.sleep(600)
if "memory" in name:
    hoard = []
    try:
        while True:
            hoard.append(bytearray(64 << 20))
    except MemoryError:
        hoard = []
        say("error: There is not enough memory for this model.")
        say("hint: Reduce the model.")
        sys.exit(65)
if "slow" in name:
    for percent in range(0, 100, 10):
        say("[%3d%%] packing" % percent)
        time.sleep(0.1)

with open(model, "rb") as file:
    digest = hashlib.sha256(file.read()).hexdigest()
profile = value["--profile"]
if "/" not in profile:
    profile = os.path.join(os.environ["PACKMERGER_SOURCE"], "profiles", profile + ".toml")
trays = 2 if "two" in name else 1
packed, hollow = (20.0, 10.0) if "dear" in name else (10.0, 20.0)
report = {
    "version": 1,
    "inputs": [{"file": name.encode("utf-8", "replace").decode(), "sha256": digest, "scale": 1}],
    "parts": [{"id": i + 1, "tray": i + 1} for i in range(trays)],
    "estimates": {"as_is": {"fits": False, "cost": None}, "solid": estimate(30.0), "hollow": estimate(hollow),
                  "packed": estimate(packed)},
}
temporary = os.path.join(os.path.dirname(out), "." + os.path.basename(out) + ".temporary")
os.mkdir(temporary)
shutil.copyfile(profile, os.path.join(temporary, "profile.toml"))
lines = 20000 if "long" in name else 5
for tray in range(1, trays + 1):
    suffix = "" if tray == 1 else "-%d" % tray
    with open(os.path.join(temporary, "program%s.gcode" % suffix), "w") as program:
        program.write("G28\n" + "".join("G1 X%d F3000\n" % (10 + i % 50) for i in range(lines)) + "M104 S0\n")
    with open(os.path.join(temporary, "tray%s.stl" % suffix), "wb") as mesh:
        mesh.write(bytes(84))
with open(os.path.join(temporary, "preview.png"), "wb") as picture:
    picture.write(b"\x89PNG")
if "types" in name:
    report["parts"], report["estimates"]["packed"]["parts"] = [{"tray": 1.5}], "two"
with open(os.path.join(temporary, "job.json"), "w") as file:
    json.dump(report, file)
if "pipe" in name:
    os.remove(os.path.join(temporary, "program.gcode"))
    os.mkfifo(os.path.join(temporary, "program.gcode"))
if "link" in name:
    os.symlink("/etc/passwd", os.path.join(temporary, "preview.glb"))
os.rename(temporary, out)
say("[100%] writing")
