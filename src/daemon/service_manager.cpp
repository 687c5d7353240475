#include "daemon/service_manager.h"

#include <systemd/sd-daemon.h>
#include <time.h>

#include <cstdint>

namespace packmerger {
namespace {

// Where systemd does not hear us there is nobody to tell.
void tell(const std::string& text) { (void)::sd_notify(0, text.c_str()); }

std::string monotonic_us() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::to_string(std::int64_t{now.tv_sec} * 1000000 + now.tv_nsec / 1000);
}

}  // namespace

ServiceManager::ServiceManager() {
  std::uint64_t interval_us = 0;
  if (::sd_watchdog_enabled(0, &interval_us) > 0)
    alive_every_s_ = static_cast<double>(interval_us) / 4e6;
}

void ServiceManager::ready() { tell("READY=1"); }

// The time is asked for by Type=notify-reload of later versions.
void ServiceManager::reloading() { tell("RELOADING=1\nMONOTONIC_USEC=" + monotonic_us()); }

void ServiceManager::stopping() { tell("STOPPING=1"); }

void ServiceManager::status(const std::string& text) {
  if (text != status_) tell("STATUS=" + text);
  status_ = text;
}

void ServiceManager::alive(double now_s) {
  if (alive_every_s_ == 0 || now_s < alive_at_s_) return;
  alive_at_s_ = now_s + alive_every_s_;
  tell("WATCHDOG=1");
}

}  // namespace packmerger
