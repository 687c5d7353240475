// PLY: ASCII, binary little and big endian. Elements other than "vertex" and "face" are skipped.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

#include "base/error.h"
#include "shape/formats.h"

namespace packmerger {
namespace {

constexpr std::int64_t kCheckEvery = 1 << 16;
constexpr std::int64_t kMaxListLength = 1 << 24;

enum class Type { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat, kDouble };

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

std::size_t size_of(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

struct Property {
  std::string_view name;
  Type type = Type::kFloat;
  std::optional<Type> length_type;  // of a list
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
  std::string_view body;
};

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

// Hands out the numbers of the body, one after the other.
class Body {
 public:
  explicit Body(const Header& header) : rest_(header.body), coding_(header.coding) {}

  double take(Type type) {
    if (coding_ == Coding::kAscii) {
      const auto number = to_double(take_word(rest_));
      if (!number) refuse_file("it ends too early or holds something that is not a number");
      return *number;
    }
    const std::size_t size = size_of(type);
    if (rest_.size() < size) refuse_file("it ends too early");
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), rest_.data(), size);
    rest_.remove_prefix(size);
    if ((coding_ == Coding::kBig) == (std::endian::native == std::endian::little))
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case Type::kInt8:
        return as<std::int8_t>(bytes);
      case Type::kUint8:
        return as<std::uint8_t>(bytes);
      case Type::kInt16:
        return as<std::int16_t>(bytes);
      case Type::kUint16:
        return as<std::uint16_t>(bytes);
      case Type::kInt32:
        return as<std::int32_t>(bytes);
      case Type::kUint32:
        return as<std::uint32_t>(bytes);
      case Type::kFloat:
        return static_cast<double>(as<float>(bytes));
      case Type::kDouble:
        return as<double>(bytes);
    }
    return 0;
  }

  std::int64_t take_whole(Type type) {
    const double number = take(type);
    if (!(std::abs(number) <= 0x1p53) || number != std::floor(number))
      refuse_file("a whole number was expected");
    return static_cast<std::int64_t>(number);
  }

  // Elements without properties take no bytes, so their count says nothing.
  bool could_hold(const Element& element) const {
    std::size_t least = 0;
    for (const Property& property : element.properties)
      least +=
          coding_ == Coding::kAscii ? 1 : size_of(property.length_type.value_or(property.type));
    return least == 0 || static_cast<std::uint64_t>(element.count) <= rest_.size() / least;
  }

 private:
  template <typename Number>
  static Number as(const std::array<char, 8>& bytes) {
    Number number{};
    std::memcpy(&number, bytes.data(), sizeof number);
    return number;
  }

  std::string_view rest_;
  Coding coding_;
};

void take_list(Body& body, const Property& property, std::vector<std::int64_t>* into) {
  const std::int64_t length = body.take_whole(*property.length_type);
  if (length < 0 || length > kMaxListLength) refuse_file("a list's length is out of range");
  for (std::int64_t i = 0; i < length; ++i) {
    if (into != nullptr)
      into->push_back(body.take_whole(property.type));
    else
      body.take(property.type);
  }
}

void read_vertex(Body& body, const Element& element, SoupBuilder& soup) {
  Vec3 point = Vec3::Zero();
  for (const Property& property : element.properties) {
    if (property.length_type) {
      take_list(body, property, nullptr);
      continue;
    }
    const double number = body.take(property.type);
    if (property.name == "x") point.x() = number;
    if (property.name == "y") point.y() = number;
    if (property.name == "z") point.z() = number;
  }
  soup.add_point(point);
}

void read_other(Body& body, const Element& element, std::vector<std::int64_t>* face) {
  for (const Property& property : element.properties) {
    const bool is_face = property.name == "vertex_indices" || property.name == "vertex_index";
    if (!property.length_type)
      body.take(property.type);
    else
      take_list(body, property, is_face ? face : nullptr);
  }
}

}  // namespace

TriangleSoup read_ply(std::string_view bytes, const Progress& progress) {
  const Header header = read_header(bytes);
  Body body(header);
  SoupBuilder soup;
  std::vector<std::int64_t> face;
  for (const Element& element : header.elements) {
    if (!body.could_hold(element))
      refuse_file("its header declares " + std::to_string(element.count) +
                  " elements, more than the file could hold");
    if (element.properties.empty()) continue;
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (i % kCheckEvery == 0) progress.check();
      face.clear();
      if (element.name == "vertex") {
        read_vertex(body, element, soup);
      } else {
        read_other(body, element, element.name == "face" ? &face : nullptr);
        soup.add_polygon(face);
      }
    }
  }
  return soup.finish();
}

}  // namespace packmerger
