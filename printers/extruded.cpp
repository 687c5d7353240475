#include "printers/extruded.h"

#include "printers/gcode_line.h"

namespace packmerger {

Extruded extruded(std::string_view gcode) {
  constexpr std::string_view kType = ";TYPE:";
  Extruded sum;
  bool support = false;
  bool relative = false;
  double e = 0;
  for_each_line(gcode, [&](std::string_view text, int) {
    if (text.starts_with(kType)) {
      support = text.substr(kType.size()).starts_with("Support material");
      return true;
    }
    const GcodeLine line(text);
    if (line.is('M', 82) || line.is('G', 90)) relative = false;
    if (line.is('M', 83) || line.is('G', 91)) relative = true;
    if (line.letter() != 'G' || !line.value('E')) return true;
    const double to = *line.value('E') + (relative && !line.is('G', 92) ? e : 0);
    if (!line.is('G', 92) && to > e && (line.has('X') || line.has('Y')))
      (support ? sum.support_mm : sum.model_mm) += to - e;
    e = to;
    return true;
  });
  return sum;
}

}  // namespace packmerger
