// G-code over a serial port or a serial server, line by line (docs/PROTOCOLS, "Marlin").
#pragma once

#include "delivery/way.h"

namespace packmerger {

extern const DeliveryWay kSerialGcode;

}  // namespace packmerger
