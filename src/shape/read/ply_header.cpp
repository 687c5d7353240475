#include "shape/read/ply_header.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/error.h"
#include "shape/read/formats.h"

namespace packmerger::ply {
namespace {

std::optional<Type> type_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Type>, 16> kNames = {{
      {"char", Type::kInt8},
      {"int8", Type::kInt8},
      {"uchar", Type::kUint8},
      {"uint8", Type::kUint8},
      {"short", Type::kInt16},
      {"int16", Type::kInt16},
      {"ushort", Type::kUint16},
      {"uint16", Type::kUint16},
      {"int", Type::kInt32},
      {"int32", Type::kInt32},
      {"uint", Type::kUint32},
      {"uint32", Type::kUint32},
      {"float", Type::kFloat},
      {"float32", Type::kFloat},
      {"double", Type::kDouble},
      {"float64", Type::kDouble},
  }};
  for (const auto& [known, type] : kNames)
    if (known == name) return type;
  return std::nullopt;
}

Type take_type(std::string_view& text, int line) {
  const auto type = type_named(take_word(text));
  if (!type) refuse_file("an unknown type in line " + std::to_string(line) + " of its header");
  return *type;
}

Property read_property(std::string_view text, int line) {
  Property property;
  std::string_view rest = text;
  if (take_word(rest) == "list") {
    property.length_type = take_type(rest, line);
    text = rest;
  }
  property.type = take_type(text, line);
  property.name = take_word(text);
  return property;
}

void check_elements(const Header& header) {
  const auto holds = [&](std::string_view name) {
    return std::any_of(header.elements.begin(), header.elements.end(), [&](const Element& element) {
      return element.name == name && element.count > 0;
    });
  };
  if (holds("range_grid") && !holds("face") && !holds("tristrips"))
    throw Error(Fault::kBadInput, "The model file is a scan's range grid, not a mesh",
                "Make a closed mesh of the scan's views in the scanner's program, or in MeshLab, "
                "and give that.");
  for (const Element& element : header.elements) {
    const auto has = [&](std::string_view name) {
      return std::any_of(
          element.properties.begin(), element.properties.end(),
          [&](const Property& property) { return !property.length_type && property.name == name; });
    };
    if (element.count == 0) continue;
    if (element.name == "vertex" && !(has("x") && has("y") && has("z")))
      refuse_file("its points have no x, y and z");
    if ((element.name == "face" || element.name == "tristrips") &&
        std::count_if(element.properties.begin(), element.properties.end(),
                      [](const Property& property) { return property.names_points(); }) != 1)
      refuse_file("its faces have no list, or several, that could be vertex_indices");
  }
}

}  // namespace

Header read_header(std::string_view bytes) {
  Header header;
  LineReader lines(bytes);
  bool has_format = false;
  lines.next();  // "ply"
  while (auto line = lines.next()) {
    std::string_view text = *line;
    const std::string_view key = take_word(text);
    if (key == "end_header") {
      if (!has_format) refuse_file("its header does not name a format");
      header.body = lines.rest();
      check_elements(header);
      return header;
    }
    if (key == "format") {
      const std::string_view name = take_word(text);
      if (name != "ascii" && name != "binary_little_endian" && name != "binary_big_endian")
        refuse_file("its header names an unknown format");
      header.coding = name == "ascii"                  ? Coding::kAscii
                      : name == "binary_little_endian" ? Coding::kLittle
                                                       : Coding::kBig;
      has_format = true;
    } else if (key == "element") {
      const std::string_view name = take_word(text);
      const auto count = to_integer(take_word(text));
      if (!count || *count < 0) refuse_file("an element's count is not a number");
      header.elements.push_back({name, *count, {}});
    } else if (key == "property") {
      if (header.elements.empty()) refuse_file("a property stands before its element");
      header.elements.back().properties.push_back(read_property(text, lines.line_number()));
    }
  }
  refuse_file("its header does not end");
}

}  // namespace packmerger::ply
