// Times as people read them.
#pragma once

#include <string>

namespace packmerger {

// "0:12:34": hours, minutes and seconds. seconds: 0 or more.
std::string duration_text(double seconds);

}  // namespace packmerger
