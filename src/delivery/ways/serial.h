// What the ways over a serial port share: finding the port and opening it.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "delivery/way.h"
#include "firmware_io/ports/port.h"

namespace packmerger {

// As DeliveryWay has them: a port is a device, usb:VID:PID:SERIAL of one behind a serial port, or
// tcp:HOST:PORT, of which nobody knows whether it is there.
std::string find_serial_printer(const Profile& profile);
std::optional<bool> is_serial_connected(const std::string& port,
                                        const std::optional<Devices>& devices);

// Throws as find_port() and open_port() do.
std::unique_ptr<Port> open_serial(const Delivery& delivery);

}  // namespace packmerger
