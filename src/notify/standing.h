// How somebody who is told stands with the daemon: one thread tries, any other may look.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "base/trouble.h"

namespace packmerger {

class Standing {
 public:
  // One more try was in vain, and the next one comes after pause_s; 0: nobody knows.
  void failed(const std::string& what, double pause_s);
  void lasts();  // nobody tries it now, and it is no better
  void works();

  std::optional<Trouble> trouble() const;

 private:
  mutable std::mutex mutex_;
  std::optional<Trouble> trouble_;
};

}  // namespace packmerger
