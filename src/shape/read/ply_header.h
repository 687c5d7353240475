// What the header of a PLY file declares (Turk, The PLY Polygon File Format, 1994). Only
// read_ply.cpp and ply_header.cpp include it.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace packmerger::ply {

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

struct Property {
  std::string_view name;
  Type type = Type::kFloat;
  std::optional<Type> length_type;  // of a list

  // A list of points by their numbers: the corners of a face, or of strips of triangles.
  bool names_points() const {
    return length_type && (name == "vertex_indices" || name == "vertex_index");
  }
};

struct Element {
  std::string_view name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

enum class Coding { kAscii, kLittle, kBig };

struct Header {
  Coding coding = Coding::kAscii;
  std::vector<Element> elements;
  std::string_view body;  // what comes after it
};

// The views point into bytes. Refuses what is no header (Error{kBadInput}), and one that declares
// nothing a surface could be made of.
Header read_header(std::string_view bytes);

}  // namespace packmerger::ply
