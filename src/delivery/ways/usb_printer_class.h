// The tray's document to a printer of the USB printer class (docs/PROTOCOLS, "Documents over USB").
#pragma once

#include "delivery/way.h"

namespace packmerger {

extern const DeliveryWay kUsbPrinterClass;

}  // namespace packmerger
