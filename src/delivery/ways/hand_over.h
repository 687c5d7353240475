// The trays' documents in a folder, for printers whose maker's own program takes them from there.
#pragma once

#include "delivery/way.h"

namespace packmerger {

extern const DeliveryWay kHandOver;

}  // namespace packmerger
