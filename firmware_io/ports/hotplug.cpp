#include "firmware_io/ports/hotplug.h"

#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include "base/time/clock.h"
#include "firmware_io/ports/usb_library.h"

namespace packmerger {

namespace {

constexpr double kSlice_s = 0.25;
// A serial port and its links are made some time after the device behind them came.
constexpr double kSettle_s = 3;

// libusb's hotplug; where the system has none it only waits.
class Hotplug {
 public:
  Hotplug() {
    if (libusb_init(&context_) != 0) context_ = nullptr;
    if (context_ == nullptr || libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return;
    constexpr int kBoth = LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT;
    constexpr int kAny = LIBUSB_HOTPLUG_MATCH_ANY;
    works_ = libusb_hotplug_register_callback(context_, kBoth, 0, kAny, kAny, kAny, &Hotplug::note,
                                              this, nullptr) == 0;
  }
  Hotplug(const Hotplug&) = delete;
  Hotplug& operator=(const Hotplug&) = delete;
  ~Hotplug() {
    if (context_ != nullptr) libusb_exit(context_);
  }

  // True when a device came or went meanwhile.
  bool wait(double seconds) {
    constexpr double kMicroseconds = 1e6;
    timeval slice{0, static_cast<suseconds_t>(seconds * kMicroseconds)};
    if (!works_ || libusb_handle_events_timeout_completed(context_, &slice, nullptr) != 0)
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    return std::exchange(noted_, false);
  }

 private:
  static int LIBUSB_CALL note(libusb_context*, libusb_device*, libusb_hotplug_event, void* self) {
    static_cast<Hotplug*>(self)->noted_ = true;
    return 0;
  }

  libusb_context* context_ = nullptr;
  bool works_ = false;
  bool noted_ = false;  // on the thread that waits
};

// What was told last.
class Teller {
 public:
  explicit Teller(const DeviceListener& listener) : listener_(listener) {}

  void look() {
    try {
      Devices devices = connected_devices();
      failed_ = false;
      if (told_ == devices) return;
      told_ = std::move(devices);
      listener_.changed(*told_);
    } catch (const Error& error) {
      told_.reset();
      if (!std::exchange(failed_, true)) listener_.failed(error);
    }
  }

 private:
  const DeviceListener& listener_;
  std::optional<Devices> told_;
  bool failed_ = false;
};

}  // namespace

void watch_devices(const std::atomic<bool>& stop, double rescan_s, const DeviceListener& listener) {
  Hotplug hotplug;
  Teller teller(listener);
  double look_at_s = 0;
  double settled_at_s = 0;
  while (!stop) {
    const double now = steady_now_s();
    if (now >= look_at_s) {
      teller.look();
      look_at_s = now + (now < settled_at_s ? kSlice_s : rescan_s);
    }
    if (!hotplug.wait(kSlice_s)) continue;
    look_at_s = steady_now_s();
    settled_at_s = look_at_s + kSettle_s;
  }
}

}  // namespace packmerger
