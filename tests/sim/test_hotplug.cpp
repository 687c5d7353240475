// Devices that come and go while they are watched.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <thread>

#include "firmware_io/ports/hotplug.h"
#include "sim/usb_bed.h"

namespace packmerger::test {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kNeverRescan_s = 1e6;

// Watches on a thread of its own, which ends with the object.
class Watcher {
 public:
  explicit Watcher(double rescan_s) : thread_([this, rescan_s] { watch(rescan_s); }) {}
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;
  ~Watcher() {
    stop_ = true;
    thread_.join();
  }

  // Whether so many USB devices were told last, within ten seconds.
  bool sees(std::size_t count) {
    std::unique_lock lock(mutex_);
    return told_.wait_for(lock, std::chrono::seconds(10),
                          [&] { return times_ > 0 && devices_.usb.size() == count; });
  }

  int times() {
    const std::lock_guard lock(mutex_);
    return times_;
  }

 private:
  void watch(double rescan_s) {
    const auto changed = [this](const Devices& devices) {
      const std::lock_guard lock(mutex_);
      devices_ = devices;
      ++times_;
      told_.notify_all();
    };
    const auto failed = [](const Error& error) { ADD_FAILURE() << error.what(); };
    watch_devices(stop_, rescan_s, {changed, failed});
  }

  std::mutex mutex_;
  std::condition_variable told_;
  Devices devices_;
  int times_ = 0;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

// Nothing but libusb's hotplug can tell.
TEST(Hotplug, DevicesThatComeAndGoAreTold) {
  UsbBed bed;
  Watcher watcher(kNeverRescan_s);
  ASSERT_TRUE(watcher.sees(0));
  for (int round = 0; round < 2; ++round) {
    bed.plug_printer();
    EXPECT_TRUE(watcher.sees(1)) << round;
    bed.unplug_printer();
    EXPECT_TRUE(watcher.sees(0)) << round;
  }
}

TEST(Hotplug, WhatStaysIsToldOnce) {
  UsbBed bed;
  bed.plug_printer();
  Watcher watcher(0.01);
  ASSERT_TRUE(watcher.sees(1));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_EQ(watcher.times(), 1);
}

// The system reports nothing, as in some containers.
TEST(Hotplug, RescanFindsWhatWasNotReported) {
  UsbBed bed;
  bed.plug_printer();
  Watcher watcher(0.2);
  ASSERT_TRUE(watcher.sees(1));
  UsbPrinterTraits other;
  other.place = "1-2";
  bed.plug(usb_description(other, 9), {});
  EXPECT_TRUE(watcher.sees(2));
}

TEST(Hotplug, EndsSoon) {
  UsbBed bed;
  const auto begin = Clock::now();
  { Watcher watcher(kNeverRescan_s); }
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 5);
}

}  // namespace
}  // namespace packmerger::test
