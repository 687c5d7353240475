// What fails again and again, as it is shown until it is over.
#pragma once

#include <map>
#include <string>

namespace packmerger {

struct Trouble {
  std::string what;    // one sentence
  double since_s = 0;  // Unix time of its first failure
  int tries = 0;       // in vain since then; 0: the first is still waited for
  double next_s = 0;   // Unix time of the next try; 0: nobody knows

  bool operator==(const Trouble&) const = default;
};

// By what has them.
using Troubles = std::map<std::string, Trouble>;

}  // namespace packmerger
