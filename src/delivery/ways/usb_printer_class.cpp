#include "delivery/ways/usb_printer_class.h"

#include <algorithm>

#include "base/error.h"
#include "delivery/find_port.h"
#include "delivery/ways/port_settings.h"
#include "firmware_io/usb/usb_link.h"

namespace packmerger {
namespace {

std::optional<std::string> fault_of_settings(const std::string& port,
                                             const fs::path& handoff_folder) {
  if (!port.empty() && !is_usb(port))
    return "needs a port usb:VID:PID or usb:VID:PID:SERIAL: its dialect is usb";
  return fault_of_port_settings(port, handoff_folder);
}

void refuse_programs(const Profile& profile, FileKind) {
  throw Error(Fault::kBadInput, "The " + profile.name + " is sent documents, and no programs",
              "Drop the model itself: it is prepared for this printer.");
}

std::string find_printer(const Profile& profile) {
  return stable_address(find_usb_printer(connected_devices().usb, "", profile.link.usb_ids));
}

std::optional<bool> is_connected(const std::string& port, const std::optional<Devices>& devices) {
  if (!devices) return std::nullopt;
  return std::any_of(devices->usb.begin(), devices->usb.end(),
                     [&](const UsbDevice& device) { return is_at(port, device); });
}

void give(const Delivery& delivery, const PrintListener& listener, PrintControl& control) {
  const UsbDevice device =
      find_usb_printer(connected_devices().usb, delivery.to, delivery.profile.link.usb_ids);
  print_usb(*open_usb_port(device, delivery.to), delivery.file, delivery.options, listener,
            control);
}

}  // namespace

constinit const DeliveryWay kUsbPrinterClass = {
    .hands_over = false,
    .has_bed = true,
    .tells_end = false,
    .unit = "byte",
    .simulated = {},
    .fault_of_settings = fault_of_settings,
    .check_program = refuse_programs,
    .find_printer = find_printer,
    .is_connected = is_connected,
    .give = give,
};

}  // namespace packmerger
