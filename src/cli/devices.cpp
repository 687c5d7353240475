#include <fmt/format.h>

#include <map>
#include <memory>

#include "base/error.h"
#include "cli/daemon_verb.h"
#include "cli/verb.h"
#include "delivery/find_port.h"
#include "firmware_io/ports/devices.h"
#include "model/printer.h"

namespace packmerger::cli {
namespace {

using nlohmann::json;

// By USB id the profiles that name it as theirs. Chips that many machines have are among them.
using ProfilesByUsbId = std::map<std::string, std::vector<std::string>>;

ProfilesByUsbId profiles_by_usb_id() {
  ProfilesByUsbId profiles;
  for (const std::string& id : profile_ids())
    for (const std::string& usb_id : read_profile(id).link.usb_ids) profiles[usb_id].push_back(id);
  return profiles;
}

// The daemon's printers; none where no daemon runs.
json configured_printers(const DaemonArguments& arguments) {
  try {
    return ask(arguments, {{"verb", "printers.list"}});
  } catch (const Error& error) {
    if (error.fault() != Fault::kUnavailable) throw;
    return json::array();
  }
}

// The configured printer that this device is; null: none.
template <typename Device>
json printer_at(const Device& device, const json& printers) {
  for (const json& printer : printers)
    if (is_at(text_of(printer, "port"), device)) return printer.at("name");
  return nullptr;
}

json usb_json(const UsbIdentity& usb, const ProfilesByUsbId& profiles) {
  const auto or_null = [](const std::string& text) { return text.empty() ? json() : json(text); };
  const auto known = profiles.find(usb.id);
  return {{"usb_id", or_null(usb.id)},
          {"serial_number", or_null(usb.serial_number)},
          {"manufacturer", or_null(usb.manufacturer)},
          {"product", or_null(usb.product)},
          {"profiles", known == profiles.end() ? std::vector<std::string>{} : known->second}};
}

json devices_json(const Devices& devices, const json& printers) {
  const ProfilesByUsbId profiles = profiles_by_usb_id();
  json serial = json::array();
  for (const SerialDevice& device : devices.serial) {
    json one = usb_json(device.usb, profiles);
    one["port"] = device.port;
    one["address"] = stable_address(device);
    one["link"] = device.link.empty() ? json() : json(device.link);
    one["driver"] = device.driver.empty() ? json() : json(device.driver);
    one["may_open"] = device.may_open;
    one["printer"] = printer_at(device, printers);
    serial.push_back(std::move(one));
  }
  json usb = json::array();
  for (const UsbDevice& device : devices.usb) {
    json one = usb_json(device.usb, profiles);
    one["at"] = device.at;
    one["address"] = stable_address(device);
    one["is_printer"] = device.is_printer;
    one["may_open"] = device.may_open;
    one["printer"] = printer_at(device, printers);
    usb.push_back(std::move(one));
  }
  return {{"serial", serial}, {"usb", usb}};
}

std::string or_dash(const std::string& text) { return text.empty() ? "-" : text; }

std::vector<std::string> row_of(const json& device, const char* place, const std::string& driver) {
  return {text_of(device, place),
          or_dash(text_of(device, "usb_id")),
          or_dash(text_of(device, "serial_number")),
          or_dash(text_of(device, "product")),
          or_dash(driver),
          or_dash(fmt::format("{}", fmt::join(device.at("profiles"), ", "))),
          or_dash(text_of(device, "printer"))};
}

void print_text(const json& told) {
  std::vector<std::vector<std::string>> rows = {
      {"AT", "USB ID", "SERIAL NUMBER", "PRODUCT", "DRIVER", "PROFILE", "PRINTER"}};
  for (const json& device : told.at("serial"))
    rows.push_back(row_of(device, "port", text_of(device, "driver")));
  for (const json& device : told.at("usb"))
    rows.push_back(row_of(device, "at", device.at("is_printer") ? "(printer class)" : ""));
  if (rows.size() == 1) {
    fmt::print(stderr,
               "No serial port and no USB device is here. Connect a printer, switch it on "
               "and try again.\n");
    return;
  }
  print_table(rows);
  for (const json& device : told.at("serial")) {
    if (text_of(device, "address") != text_of(device, "port"))
      fmt::print("{} stays {}\n", text_of(device, "port"), text_of(device, "address"));
    if (!device.at("may_open").get<bool>())
      fmt::print(stderr,
                 "You may not open {}: add your user to the group that owns it (on Debian: "
                 "dialout).\n",
                 text_of(device, "port"));
  }
  for (const json& device : told.at("usb"))
    if (device.at("is_printer").get<bool>())
      fmt::print("{} stays {}\n", text_of(device, "at"), text_of(device, "address"));
}

}  // namespace

void add_devices(CLI::App& program) {
  auto arguments = std::make_shared<DaemonArguments>();
  CLI::App* verb = program.add_subcommand(
      "devices", "The serial ports and USB devices here, and the profile that each matches");
  add_daemon_options(*verb, *arguments);
  verb->callback([arguments] {
    const json told = devices_json(connected_devices(), configured_printers(*arguments));
    if (arguments->json) return print_json(told);
    print_text(told);
  });
}

}  // namespace packmerger::cli
