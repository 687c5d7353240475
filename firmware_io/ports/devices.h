// Which serial ports and USB devices are connected, as libserialport, libusb and Linux's /sys tell.
#pragma once

#include <string>
#include <vector>

namespace packmerger {

// What is not told is empty.
struct UsbIdentity {
  bool operator==(const UsbIdentity&) const = default;

  std::string id;  // "23c1:d314": vendor and product, lower-case hex
  std::string serial_number;
  std::string manufacturer;
  std::string product;
};

struct SerialDevice {
  bool operator==(const SerialDevice&) const = default;

  std::string port;    // "/dev/ttyACM0": another one when it is plugged in again
  std::string link;    // "/dev/serial/by-id/…": stays the same; empty where there is none
  std::string driver;  // of the kernel
  UsbIdentity usb;     // of the device behind the port; empty where it is not on USB
  bool may_open = false;
};

struct UsbDevice {
  bool operator==(const UsbDevice&) const = default;

  std::string at;  // "1-4.2": bus and ports, as Linux names the device
  UsbIdentity usb;
  bool is_printer = false;  // has an interface of the printer class
  bool may_open = false;
};

struct Devices {
  bool operator==(const Devices&) const = default;

  std::vector<SerialDevice> serial;  // by port
  std::vector<UsbDevice> usb;        // by place; no hubs, and none that is a serial port
};

// Opens and disturbs nothing. Throws Error{kIo} when the system does not tell.
Devices connected_devices();

// Its serial ports alone.
std::vector<SerialDevice> connected_serial_ports();

// Whether both names lead to one device that is there.
bool is_same_device(const std::string& a, const std::string& b);

}  // namespace packmerger
