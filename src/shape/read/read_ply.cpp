// PLY: ASCII, binary little and big endian. Elements other than "vertex", "face" and "tristrips"
// are skipped; a scan's range grid, which gives points and no surface, is refused by name.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/error.h"
#include "shape/read/formats.h"
#include "shape/read/ply_header.h"

namespace packmerger {
namespace {

constexpr std::int64_t kCheckEvery = 1 << 16;
constexpr std::int64_t kMaxListLength = 1 << 24;

using ply::Coding;
using ply::Element;
using ply::Header;
using ply::Property;
using ply::Type;

std::size_t size_of(Type type) {
  static constexpr std::array<std::size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
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

// corners: where lists of points go; null for elements that are skipped.
void read_other(Body& body, const Element& element, std::vector<std::int64_t>* corners) {
  for (const Property& property : element.properties) {
    if (!property.length_type)
      body.take(property.type);
    else
      take_list(body, property, property.names_points() ? corners : nullptr);
  }
}

// Strips of triangles, ended by -1: each corner from the third on makes a triangle with the two
// before it, and every other triangle is turned. A corner that is repeated makes none, but counts.
void add_strips(const std::vector<std::int64_t>& corners, SoupBuilder& soup) {
  constexpr std::int64_t kEnds = -1;
  constexpr std::int64_t kEndsUnsigned = std::numeric_limits<std::uint32_t>::max();
  std::array<std::int64_t, 3> triangle{};
  int in_strip = 0;
  for (const std::int64_t corner : corners) {
    if (corner == kEnds || corner == kEndsUnsigned) {
      in_strip = 0;
      continue;
    }
    triangle = {triangle[1], triangle[2], corner};
    if (++in_strip < 3) continue;
    const auto& [a, b, c] = triangle;
    if (a == b || b == c || c == a) continue;
    const bool is_turned = in_strip % 2 == 0;
    soup.add_polygon(is_turned ? std::array{b, a, c} : triangle);
  }
}

}  // namespace

TriangleSoup read_ply(std::string_view bytes, const Progress& progress) {
  const Header header = ply::read_header(bytes);
  Body body(header);
  SoupBuilder soup;
  std::vector<std::int64_t> corners;
  for (const Element& element : header.elements) {
    if (!body.could_hold(element))
      refuse_file("its header declares " + std::to_string(element.count) +
                  " elements, more than the file could hold");
    if (element.properties.empty()) continue;
    const bool is_strips = element.name == "tristrips";
    const bool is_face = element.name == "face";
    for (std::int64_t i = 0; i < element.count; ++i) {
      if (i % kCheckEvery == 0) progress.check();
      if (element.name == "vertex") {
        read_vertex(body, element, soup);
        continue;
      }
      corners.clear();
      read_other(body, element, is_strips || is_face ? &corners : nullptr);
      if (is_strips)
        add_strips(corners, soup);
      else
        soup.add_polygon(corners);
    }
  }
  return soup.finish();
}

}  // namespace packmerger
