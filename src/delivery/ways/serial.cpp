#include "delivery/ways/serial.h"

#include <algorithm>

#include "delivery/find_port.h"

namespace packmerger {

std::string find_serial_printer(const Profile& profile) {
  return find_port(connected_serial_ports(), "", profile.link.usb_ids);
}

std::optional<bool> is_serial_connected(const std::string& port,
                                        const std::optional<Devices>& devices) {
  if (is_tcp(port)) return std::nullopt;
  if (!is_usb(port)) {
    std::error_code ignored;
    return fs::exists(port, ignored);
  }
  if (!devices) return std::nullopt;
  return std::any_of(devices->serial.begin(), devices->serial.end(),
                     [&](const SerialDevice& device) { return is_at(port, device); });
}

std::unique_ptr<Port> open_serial(const Delivery& delivery) {
  const LinkSettings& link = delivery.profile.link;
  return open_port(is_tcp(delivery.to)
                       ? delivery.to
                       : find_port(connected_serial_ports(), delivery.to, link.usb_ids),
                   link.baud);
}

}  // namespace packmerger
