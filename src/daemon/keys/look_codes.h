// Codes that let a page look, once: they travel in a link from the daemon to the browser beside it.
#pragma once

#include <mutex>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

// Thread-safe. Forgotten when the daemon ends.
class LookCodes {
 public:
  static constexpr double kGoodFor_s = 15 * 60;

  // Makes a code of 128 random bits; the oldest of eight goes. now_s: a clock that never goes back.
  std::string add(double now_s);
  // Whether it is one that is still good; it is no longer afterwards.
  bool take(std::string_view code, double now_s);

 private:
  struct Code {
    std::string sha256;  // of its text
    double until_s = 0;
  };

  std::mutex mutex_;  // guards codes_
  std::vector<Code> codes_;
};

}  // namespace packmerger
