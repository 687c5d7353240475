// x3g over a serial port or a serial server, packet by packet (docs/PROTOCOLS, "s3g").
#pragma once

#include "delivery/way.h"

namespace packmerger {

extern const DeliveryWay kSerialS3g;

}  // namespace packmerger
