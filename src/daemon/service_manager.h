// What the daemon tells systemd that it was started by (sd_notify(3)). Where it was not, every
// call does nothing. Only the loop's thread uses it.
#pragma once

#include <string>

namespace packmerger {

class ServiceManager {
 public:
  ServiceManager();

  // Everything is recovered and answered from now on; also the end of a reload.
  void ready();
  void reloading();
  void stopping();

  // What it does, for people (systemctl status). Sent when it changed.
  void status(const std::string& text);

  // The loop goes round. To be called at least every second; sent four times in the time after
  // which systemd takes the daemon for hung ($WATCHDOG_USEC, at least two seconds).
  void alive(double now_s);

 private:
  double alive_every_s_ = 0;  // 0: nobody waits for it
  double alive_at_s_ = 0;
  std::string status_;
};

}  // namespace packmerger
