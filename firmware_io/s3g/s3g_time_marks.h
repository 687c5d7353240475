// The time that an x3g program is expected to take, mark by mark.
#pragma once

#include <vector>

#include "firmware_io/remaining_time.h"

namespace packmerger {

namespace s3g {
class Actions;
}

// From the moves and delays of an x3g program. done: its bytes.
std::vector<TimeMark> time_marks(const s3g::Actions& actions);

}  // namespace packmerger
