// What 3MF files written by hand are read as.
#pragma once

#include <string>

#include "fixtures/fault_of.h"
#include "fixtures/models.h"
#include "shape/read/read_model.h"
#include "unit/shape/written.h"

namespace packmerger::written {

inline TriangleSoup read(const std::string& bytes) {
  return read_model_bytes(bytes, "", Progress()).soup;
}

inline std::string refusal(const std::string& bytes) {
  return fixtures::refusal_of([&] { read(bytes); });
}

// A cube of one unit.
inline std::string cube_object(const std::string& attributes) {
  return "<object " + attributes + ">" + mesh_xml(fixtures::cube(1)) + "</object>";
}

}  // namespace packmerger::written
