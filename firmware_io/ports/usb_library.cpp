#include "firmware_io/ports/usb_library.h"

#include <array>
#include <cstdint>

#include "base/error.h"

namespace packmerger::usb {

namespace {

[[noreturn]] void throw_untold(int result) {
  throw Error(Fault::kIo, "The system does not tell its USB devices: " + message_of(result),
              "Check that /sys and /dev/bus/usb are there.");
}

}  // namespace

std::string message_of(int result) { return libusb_strerror(static_cast<libusb_error>(result)); }

Context open_context() {
  libusb_context* context = nullptr;
  if (const int failed = libusb_init(&context); failed != 0) throw_untold(failed);
  return {context, libusb_exit};
}

std::vector<Device> devices_of(libusb_context* context) {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context, &list);
  if (count < 0) throw_untold(static_cast<int>(count));
  std::vector<Device> devices;
  for (ssize_t i = 0; i < count; ++i) devices.emplace_back(list[i], libusb_unref_device);
  libusb_free_device_list(list, 0);
  return devices;
}

Configuration configuration_of(libusb_device* device) {
  libusb_config_descriptor* found = nullptr;
  if (libusb_get_active_config_descriptor(device, &found) != 0 &&
      libusb_get_config_descriptor(device, 0, &found) != 0)
    found = nullptr;
  return {found, libusb_free_config_descriptor};
}

std::string place_of(libusb_device* device) {
  constexpr int kMostTiers = 7;  // of a USB tree
  std::array<std::uint8_t, kMostTiers> ports;
  const int count = libusb_get_port_numbers(device, ports.data(), kMostTiers);
  std::string place;
  for (int i = 0; i < count; ++i) {
    place += place.empty() ? std::to_string(libusb_get_bus_number(device)) + "-" : ".";
    place += std::to_string(ports[static_cast<std::size_t>(i)]);
  }
  return place;
}

}  // namespace packmerger::usb
