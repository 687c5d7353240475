#include "delivery/ways/serial_gcode.h"

#include "base/error.h"
#include "delivery/ways/port_settings.h"
#include "delivery/ways/serial.h"
#include "firmware_io/gcode/gcode_link.h"

namespace packmerger {
namespace {

constexpr std::array<std::string_view, 2> kSimulated = {"marlin-2.1", "marlin-1.1"};

void check_program(const Profile& profile, FileKind kind) {
  if (kind == FileKind::kX3g)
    throw Error(Fault::kBadInput, "The " + profile.name + " speaks G-code, and this is x3g",
                "Drop the G-code that the .x3g was made of.");
}

void give(const Delivery& delivery, const PrintListener& listener, PrintControl& control) {
  check_gcode(delivery.program);
  print_gcode(*open_serial(delivery), delivery.program, delivery.options, listener, control);
}

}  // namespace

constinit const DeliveryWay kSerialGcode = {
    .hands_over = false,
    .has_bed = true,
    .tells_end = true,
    .unit = "line",
    .simulated = kSimulated,
    .fault_of_settings = fault_of_port_settings,
    .check_program = check_program,
    .find_printer = find_serial_printer,
    .is_connected = is_serial_connected,
    .give = give,
};

}  // namespace packmerger
