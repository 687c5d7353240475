// Which device a printer is: addresses as people write them, held against what is connected.
//
//   usb:VID:PID, usb:VID:PID:SERIAL   vendor and product in hex, and the serial number: a printer
//   of
//                                     the USB printer class, or the serial port of a device on USB
//   /dev/serial/by-id/…, /dev/ttyS0   a serial port or a pseudo-terminal
//   tcp:HOST:PORT                     a serial server
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware_io/ports/devices.h"

namespace packmerger {

bool is_usb(const std::string& address);

// Throws Error{kUsage} for what begins with usb: and goes on otherwise.
void check_address(const std::string& address);

// Whether the address is this device's.
bool is_at(const std::string& address, const SerialDevice& device);
bool is_at(const std::string& address, const UsbDevice& device);

// The address of a device that stays the same wherever it is plugged in; a serial port's own name
// where it has none. Without a serial number, usb:VID:PID is every device of the kind.
std::string stable_address(const SerialDevice& device);
std::string stable_address(const UsbDevice& device);

// The port of the one device at the address, or, where that is empty, with one of these USB ids;
// any other address is returned as it is. The other one: the same for printers of the printer
// class. Both throw Error{kUnavailable} where there is none, or where a device with another USB id
// is there; where there are several, an error that names them: Error{kUsage} for an empty address,
// otherwise Error{kUnavailable}. Without an address and ids: Error{kUsage}.
std::string find_port(const std::vector<SerialDevice>& devices, const std::string& address,
                      const std::vector<std::string>& usb_ids);
UsbDevice find_usb_printer(const std::vector<UsbDevice>& devices, const std::string& address,
                           const std::vector<std::string>& usb_ids);

// What to write instead of a port whose number depends on what was plugged in first (/dev/ttyUSB0,
// /dev/ttyACM0): a sentence for people. Nothing for addresses that stay.
std::optional<std::string> advice_on(const std::string& address,
                                     const std::vector<SerialDevice>& devices);

}  // namespace packmerger
