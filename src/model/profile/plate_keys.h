// What plate_mm and keep_out_mm must be together with build_mm.
#pragma once

#include <string>

#include "model/printer.h"

namespace packmerger {

// "plate_mm must be a simple polygon: …", or empty.
std::string wrong_with_plate(const Profile& profile);

}  // namespace packmerger
