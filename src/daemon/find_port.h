// Which serial port a printer is at, as Linux tells it in /sys/class/tty.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace packmerger {

// "23c1:d314" (lower-case hex) of the USB device behind a port; empty for what is not on USB.
// Links (/dev/serial/by-id/…) are followed. sys: /sys/class/tty, or a copy of it for tests.
std::string usb_id_of_port(const std::filesystem::path& port,
                           const std::filesystem::path& sys = "/sys/class/tty");

// The one port of a USB device with one of these ids. Throws Error{kUnavailable} when there is
// none, Error{kUsage} naming them when there are several, or when usb_ids is empty.
std::string find_port(const std::vector<std::string>& usb_ids,
                      const std::filesystem::path& sys = "/sys/class/tty");

// Throws Error{kUnavailable} when the port belongs to a USB device that is none of usb_ids.
// Ports that are not on USB, and profiles without ids, are accepted.
void check_port(const std::filesystem::path& port, const std::vector<std::string>& usb_ids,
                const std::filesystem::path& sys = "/sys/class/tty");

}  // namespace packmerger
