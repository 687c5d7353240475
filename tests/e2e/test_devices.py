#!/usr/bin/python3
"""The verb devices, on USB devices that umockdev pretends are connected."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))

import program

HOST = "/devices/pci0000:00/0000:00:14.0/usb1"
CDC, PRINTER_CLASS, VENDOR_CLASS = 2, 7, 255


def descriptors(vendor, product, interface_class, device_class=0):
    """A device descriptor and one configuration of one interface with two bulk endpoints."""
    device = bytes([18, 1, 0, 2, device_class, 0, 0, 64]) + vendor.to_bytes(2, "little")
    device += product.to_bytes(2, "little") + bytes([0, 1, 1, 2, 3, 1])
    interface = bytes([9, 4, 0, 0, 2, interface_class, 1, 2, 0])
    endpoints = bytes([7, 5, 0x02, 2, 64, 0, 0]) + bytes([7, 5, 0x81, 2, 64, 0, 0])
    configuration = bytes([9, 2, 9 + len(interface + endpoints), 0, 1, 1, 0, 0xC0, 0])
    return device + configuration + interface + endpoints


def usb_device(place, number, vendor, product, interface_class, texts, device_class=0):
    """One device as umockdev reads it."""
    blob = descriptors(vendor, product, interface_class, device_class).hex().upper()
    lines = [f"P: {HOST}/{place}", f"N: bus/usb/001/{number:03}={blob}", f"E: DEVNAME=/dev/bus/usb/001/{number:03}",
             "E: DEVTYPE=usb_device", "E: SUBSYSTEM=usb", "E: BUSNUM=001", f"E: DEVNUM={number:03}",
             f"A: idVendor={vendor:04x}", f"A: idProduct={product:04x}", "A: busnum=1", f"A: devnum={number}",
             "A: speed=12", "A: bConfigurationValue=1", f"H: descriptors={blob}"]
    return "\n".join(lines + [f"A: {name}={value}" for name, value in texts.items()]) + "\n\n"


def serial_port(place, name):
    """A port of the driver cdc_acm on the device's first interface."""
    interface = f"{HOST}/{place}/{place}:1.0"
    return (f"P: {interface}\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nL: driver=../../../../../../bus/usb/drivers/cdc_acm\n\n"
            f"P: {interface}/tty/{name}\nN: {name}\nS: serial/by-id/usb-printer-if00\nE: DEVNAME=/dev/{name}\nE: SUBSYSTEM=tty\nL: device=../../../{place}:1.0\n\n")


REPLICATOR = usb_device("1-1", 2, 0x23C1, 0xD314, CDC, {
    "serial": "74134373733351C0C1D2", "manufacturer": "MakerBot Industries", "product": "The Replicator"})
BRIDGE = usb_device("1-2.3", 4, 0x0525, 0xA4A8, PRINTER_CLASS, {"serial": "B-1", "product": "Print bridge"})
STRANGER = usb_device("1-3", 5, 0x046D, 0xC077, VENDOR_CLASS, {})
HUB = usb_device("1-2", 3, 0x05E3, 0x0608, 9, {}, device_class=9)


class Devices(unittest.TestCase):
    def devices(self, description, *arguments):
        with tempfile.TemporaryDirectory(prefix="packmerger-devices-") as folder:
            file = pathlib.Path(folder) / "devices.umockdev"
            file.write_text(description)
            environment = {**os.environ, "PACKMERGER_SOCKET": f"{folder}/no-daemon"}
            return subprocess.run(["umockdev-run", "-d", file, "--", program.binary(), "devices", *arguments],
                                  capture_output=True, text=True, timeout=60, env=environment)

    def told(self, description):
        result = self.devices(description, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_a_printer_on_a_serial_port(self):
        told = self.told(REPLICATOR + serial_port("1-1", "ttyACM0"))
        self.assertEqual(told["usb"], [], "told once, as the serial port")
        [port] = told["serial"]
        expected = {"port": "/dev/ttyACM0", "usb_id": "23c1:d314", "serial_number": "74134373733351C0C1D2",
                    "manufacturer": "MakerBot Industries", "product": "The Replicator", "driver": "cdc_acm",
                    "profiles": ["replicator"], "printer": None, "link": "/dev/serial/by-id/usb-printer-if00"}
        self.assertEqual({key: port[key] for key in expected}, expected)

    def test_printers_and_others_on_usb(self):
        told = self.told(HUB + BRIDGE + STRANGER)
        self.assertEqual(told["serial"], [])
        bridge, stranger = told["usb"]
        self.assertEqual((bridge["at"], bridge["usb_id"], bridge["is_printer"]), ("1-2.3", "0525:a4a8", True))
        self.assertEqual((bridge["serial_number"], bridge["product"], bridge["manufacturer"]), ("B-1", "Print bridge", None))
        self.assertEqual((stranger["at"], stranger["usb_id"], stranger["is_printer"]), ("1-3", "046d:c077", False))
        self.assertEqual((stranger["profiles"], stranger["serial_number"]), ([], None))

    def test_the_table(self):
        result = self.devices(REPLICATOR + serial_port("1-1", "ttyACM0") + HUB + BRIDGE)
        self.assertEqual(result.returncode, 0, result.stderr)
        heading, replicator, bridge = result.stdout.splitlines()[:3]
        self.assertEqual(heading.split()[:3], ["AT", "USB", "ID"])
        for word in ("/dev/ttyACM0", "23c1:d314", "The Replicator", "cdc_acm", "replicator"):
            self.assertIn(word, replicator)
        self.assertIn("(printer class)", bridge)
        self.assertIn("/dev/ttyACM0 stays /dev/serial/by-id/usb-printer-if00", result.stdout)

    def test_nothing_is_there(self):
        result = self.devices("")
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
        self.assertIn("Connect a printer", result.stderr)


if __name__ == "__main__":
    unittest.main()
