#include "firmware_io/s3g/s3g_time_marks.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_actions.h"

namespace packmerger {
namespace {

double seconds_of(std::string_view action) {
  const auto integer = [&](std::size_t at, std::size_t size) {
    return static_cast<double>(s3g::read_integer(action.substr(at, size)));
  };
  switch (static_cast<std::uint8_t>(action[0])) {
    case s3g::kDelay:
      return integer(1, 4) / 1000;
    case s3g::kMoveIn:
      return integer(21, 4) / 1e6;
    case s3g::kMoveAlong: {
      float way_mm = 0;
      const std::uint32_t bits = s3g::read_integer(action.substr(26, 4));
      std::memcpy(&way_mm, &bits, sizeof way_mm);
      const double speed_mm_s = integer(30, 2) / 64;
      return speed_mm_s > 0 && std::isfinite(way_mm) ? std::abs(way_mm) / speed_mm_s : 0;
    }
    default:
      return 0;
  }
}

}  // namespace

std::vector<TimeMark> time_marks(const s3g::Actions& actions) {
  TimeMarks marks(actions.size());
  double expected_s = 0;
  for (std::size_t i = 0; i < actions.size(); ++i) {
    expected_s += seconds_of(actions[i]);
    marks.add(actions.done(i), expected_s, i + 1 == actions.size());
  }
  return marks.take();
}

}  // namespace packmerger
