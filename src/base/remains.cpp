#include "base/remains.h"

namespace packmerger {

Remains& remains() {
  static Remains& all = *new Remains;  // outlives every thread
  return all;
}

}  // namespace packmerger
