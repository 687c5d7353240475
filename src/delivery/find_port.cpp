#include "delivery/find_port.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr std::string_view kUsbPrefix = "usb:";
constexpr std::size_t kIdLength = 9;  // "23c1:d314"

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

struct UsbAddress {
  std::string id;
  std::string serial_number;  // empty: any
};

// Nothing for what is no such address.
std::optional<UsbAddress> read_usb(const std::string& address) {
  if (!is_usb(address)) return std::nullopt;
  const std::string rest = address.substr(kUsbPrefix.size());
  UsbAddress read{lower(rest.substr(0, kIdLength)), ""};
  const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  for (std::size_t i = 0; i < kIdLength; ++i)
    if (i >= read.id.size() || !(i == 4 ? read.id[i] == ':' : is_hex(read.id[i])))
      return std::nullopt;
  if (rest.size() == kIdLength) return read;
  if (rest[kIdLength] != ':' || rest.size() == kIdLength + 1) return std::nullopt;
  read.serial_number = rest.substr(kIdLength + 1);
  return read;
}

bool is_usb_device(const std::string& address, const UsbIdentity& usb) {
  const std::optional<UsbAddress> read = read_usb(address);
  return read && read->id == usb.id &&
         (read->serial_number.empty() || read->serial_number == usb.serial_number);
}

bool is_one_of(const std::string& id, const std::vector<std::string>& ids) {
  return std::find(ids.begin(), ids.end(), id) != ids.end();
}

std::string usb_address(const UsbIdentity& usb) {
  return std::string(kUsbPrefix) + usb.id + (usb.serial_number.empty() ? "" : ":") +
         usb.serial_number;
}

// For people who have to choose.
std::string name_of(const SerialDevice& device) { return stable_address(device); }
std::string name_of(const UsbDevice& device) { return stable_address(device) + " at " + device.at; }

bool is_candidate(const SerialDevice&) { return true; }
bool is_candidate(const UsbDevice& device) { return device.is_printer; }

template <typename Device>
Device find_one(const std::vector<Device>& devices, const std::string& address,
                const std::vector<std::string>& usb_ids) {
  if (address.empty() && usb_ids.empty())
    throw Error(Fault::kUsage, "The profile does not tell how to recognise the printer",
                "Name its port with --port; packmerger devices lists what is here.");
  std::vector<Device> found;
  std::vector<std::string> names;
  for (const Device& device : devices) {
    const bool wanted =
        address.empty() ? is_one_of(device.usb.id, usb_ids) : is_at(address, device);
    if (!wanted || !is_candidate(device)) continue;
    found.push_back(device);
    names.push_back(name_of(device));
  }
  if (found.empty())
    throw Error(Fault::kUnavailable,
                address.empty() ? fmt::format("No printer with the USB id {} is there",
                                              fmt::join(usb_ids, ", "))
                                : "No printer is at " + address,
                "Connect it and switch it on; packmerger devices lists what is here.");
  if (found.size() > 1)
    throw Error(address.empty() ? Fault::kUsage : Fault::kUnavailable,
                fmt::format("Several such printers are there: {}", fmt::join(names, ", ")),
                "Name one of them as the port.");
  return found.front();
}

void check_id(const std::string& address, const UsbIdentity& usb,
              const std::vector<std::string>& usb_ids) {
  if (usb.id.empty() || usb_ids.empty() || is_one_of(usb.id, usb_ids)) return;
  throw Error(Fault::kUnavailable,
              fmt::format("The device at {} is another one (USB id {} instead of {})", address,
                          usb.id, fmt::join(usb_ids, ", ")),
              "Name the port of the printer that the job was prepared for.");
}

// "/dev/ttyACM" and a number.
bool has_changing_number(const std::string& address) {
  for (const std::string_view driver : {"/dev/ttyUSB", "/dev/ttyACM"})
    if (address.starts_with(driver)) return true;
  return false;
}

}  // namespace

bool is_usb(const std::string& address) { return address.starts_with(kUsbPrefix); }

void check_address(const std::string& address) {
  if (is_usb(address) && !read_usb(address))
    throw Error(Fault::kUsage, address + " is no USB address",
                "Write usb:VID:PID or usb:VID:PID:SERIAL, such as usb:23c1:d314.");
}

bool is_at(const std::string& address, const SerialDevice& device) {
  return is_usb(address) ? is_usb_device(address, device.usb)
                         : is_same_device(address, device.port);
}

bool is_at(const std::string& address, const UsbDevice& device) {
  return is_usb_device(address, device.usb);
}

std::string stable_address(const SerialDevice& device) {
  if (!device.link.empty()) return device.link;
  return device.usb.serial_number.empty() ? device.port : usb_address(device.usb);
}

std::string stable_address(const UsbDevice& device) { return usb_address(device.usb); }

std::string find_port(const std::vector<SerialDevice>& devices, const std::string& address,
                      const std::vector<std::string>& usb_ids) {
  check_address(address);
  if (address.empty() || is_usb(address)) {
    const SerialDevice device = find_one(devices, address, usb_ids);
    check_id(address, device.usb, usb_ids);
    return device.port;
  }
  for (const SerialDevice& device : devices)
    if (is_at(address, device)) check_id(address, device.usb, usb_ids);
  return address;
}

UsbDevice find_usb_printer(const std::vector<UsbDevice>& devices, const std::string& address,
                           const std::vector<std::string>& usb_ids) {
  check_address(address);
  if (!address.empty() && !is_usb(address))
    throw Error(Fault::kUsage, address + " is no address of a printer of dialect usb",
                "Write usb:VID:PID or usb:VID:PID:SERIAL; packmerger devices lists what is here.");
  UsbDevice device = find_one(devices, address, usb_ids);
  check_id(address, device.usb, usb_ids);
  return device;
}

std::optional<std::string> advice_on(const std::string& address,
                                     const std::vector<SerialDevice>& devices) {
  if (!has_changing_number(address)) return std::nullopt;
  for (const SerialDevice& device : devices)
    if (is_at(address, device) && stable_address(device) != device.port)
      return address + " may be another device next time; write " + stable_address(device) +
             " instead";
  return address +
         " may be another device next time; packmerger devices tells a name that stays, once the "
         "printer is connected";
}

}  // namespace packmerger
