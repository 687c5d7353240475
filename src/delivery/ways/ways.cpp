// The table of the ways of delivery: a row a dialect.
#include "delivery/way.h"
#include "delivery/ways/hand_over.h"
#include "delivery/ways/serial_gcode.h"
#include "delivery/ways/serial_s3g.h"
#include "delivery/ways/usb_printer_class.h"

namespace packmerger {
namespace {

struct WayRow {
  Dialect dialect;
  const DeliveryWay* way;
};

constexpr std::array<WayRow, kDialects.size()> kWays = {{
    {Dialect::kHandoff, &kHandOver},
    {Dialect::kGcode, &kSerialGcode},
    {Dialect::kS3g, &kSerialS3g},
    {Dialect::kUsb, &kUsbPrinterClass},
}};
static_assert(has_every_dialect(kWays), "a dialect has no way of delivery");

}  // namespace

const DeliveryWay& way_of(Dialect dialect) { return *kWays[static_cast<std::size_t>(dialect)].way; }

}  // namespace packmerger
