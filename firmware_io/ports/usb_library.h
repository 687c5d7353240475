// What libusb hands out, as objects that give it back. Only the files that speak libusb include
// this.
#pragma once

#include <libusb.h>

#include <memory>
#include <string>
#include <vector>

namespace packmerger::usb {

using Context = std::unique_ptr<libusb_context, void (*)(libusb_context*)>;
using Device = std::unique_ptr<libusb_device, void (*)(libusb_device*)>;
using Handle = std::unique_ptr<libusb_device_handle, void (*)(libusb_device_handle*)>;
using Configuration =
    std::unique_ptr<libusb_config_descriptor, void (*)(libusb_config_descriptor*)>;

// "Entity not found": what libusb calls a result.
std::string message_of(int result);

// Throws Error{kIo} where the system has no USB.
Context open_context();

// Everything on the buses now. Throws Error{kIo}.
std::vector<Device> devices_of(libusb_context* context);

// The configuration that the device is in, or else its first; null where it tells neither.
Configuration configuration_of(libusb_device* device);

// "1-4.2": bus and ports, as Linux names the device; empty for a bus's own hub.
std::string place_of(libusb_device* device);

}  // namespace packmerger::usb
