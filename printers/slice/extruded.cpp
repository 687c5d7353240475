#include "printers/slice/extruded.h"

#include "gcode/gcode_motion.h"

namespace packmerger {

Extruded extruded(std::string_view gcode, GcodeRules rules) {
  constexpr std::string_view kType = ";TYPE:";
  Extruded sum;
  bool support = false;
  GcodeMotion motion(rules);
  for_each_line(gcode, [&](std::string_view text, int) {
    if (text.starts_with(kType)) {
      support = text.substr(kType.size()).starts_with("Support material");
      return true;
    }
    const GcodeStep step = motion.follow(GcodeLine(text, rules));
    if (step.moves && step.filament_mm > 0 && (step.named[0] || step.named[1] || step.arc))
      (support ? sum.support_mm : sum.model_mm) += step.filament_mm;
    return true;
  });
  return sum;
}

}  // namespace packmerger
