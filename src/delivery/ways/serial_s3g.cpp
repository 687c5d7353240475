#include "delivery/ways/serial_s3g.h"

#include "delivery/ways/port_settings.h"
#include "delivery/ways/serial.h"
#include "firmware_io/s3g/s3g_link.h"

namespace packmerger {
namespace {

constexpr std::array<std::string_view, 1> kSimulated = {"sailfish"};

// G-code is converted.
void take_every_program(const Profile&, FileKind) {}

void give(const Delivery& delivery, const PrintListener& listener, PrintControl& control) {
  check_x3g(delivery.program);
  print_x3g(*open_serial(delivery), delivery.program, delivery.options, listener, control);
}

}  // namespace

constinit const DeliveryWay kSerialS3g = {
    .hands_over = false,
    .has_bed = true,
    .tells_end = true,
    .unit = "byte",
    .simulated = kSimulated,
    .fault_of_settings = fault_of_port_settings,
    .check_program = take_every_program,
    .find_printer = find_serial_printer,
    .is_connected = is_serial_connected,
    .give = give,
};

}  // namespace packmerger
