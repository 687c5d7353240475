// Telling when devices are connected or go.
#pragma once

#include <atomic>
#include <functional>

#include "base/error.h"
#include "firmware_io/ports/devices.h"

namespace packmerger {

struct DeviceListener {
  // Called with what is connected: once at the start, and whenever it is something else.
  std::function<void(const Devices&)> changed;
  // The system does not tell what is connected: called once, until it tells again.
  std::function<void(const Error&)> failed;
};

// Watches on the calling thread until `stop` is true, which it sees within half a second. USB
// devices are noticed at once where libusb has hotplug; everything is looked at every rescan_s all
// the same, because serial ports that are not on USB report nothing. Opens and disturbs no device.
void watch_devices(const std::atomic<bool>& stop, double rescan_s, const DeviceListener& listener);

}  // namespace packmerger
