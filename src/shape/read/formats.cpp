#include "shape/read/formats.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <numeric>
#include <utility>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr std::int64_t kMaxTriangles = 30'000'000;
constexpr std::int64_t kMaxPoints = 3 * kMaxTriangles;
// Cutting ears takes time with the square of the corners; longer polygons become fans.
constexpr std::size_t kMaxEarCorners = 1000;

constexpr std::string_view kBlanks = " \t\v\f\r\n";

[[noreturn]] void refuse_size() {
  throw Error(Fault::kBadInput, "The model has more than 30 million triangles",
              "Reduce it in a mesh editor (decimate) and try again.");
}

// Twice the signed area of abc as seen against the normal.
double turn(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
  return (b - a).cross(c - b).dot(normal);
}

bool holds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& p, const Vec3& normal) {
  return turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0;
}

class PolygonCutter {
 public:
  PolygonCutter(const std::vector<Vec3>& points, std::vector<std::array<int, 3>>& triangles)
      : points_(points), triangles_(triangles) {}

  void cut(std::vector<int> corners) {
    const Vec3 normal = newell_normal(corners);
    if (corners.size() > 3 && corners.size() <= kMaxEarCorners) {
      std::size_t tried = 0;
      // From the second corner on: what is convex becomes the fan from its first, as in slicers. A
      // corner that lies off the plane of the others is then where they have it too.
      for (std::size_t i = 1; corners.size() > 3 && tried < corners.size();) {
        i %= corners.size();
        if (is_ear(corners, i, normal)) {
          emit(corners, i);
          corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(i));
          tried = 0;
        } else {
          ++i;
          ++tried;
        }
      }
    }
    for (std::size_t i = 2; i < corners.size(); ++i)
      triangles_.push_back({corners[0], corners[i - 1], corners[i]});
  }

 private:
  const Vec3& at(const std::vector<int>& corners, std::size_t i) const {
    return points_[static_cast<std::size_t>(corners[i % corners.size()])];
  }

  Vec3 newell_normal(const std::vector<int>& corners) const {
    Vec3 normal = Vec3::Zero();
    const Vec3& first = at(corners, 0);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
      normal += (at(corners, i) - first).cross(at(corners, i + 1) - first);
    return normal;
  }

  // Corner i and its two neighbours; the triangle is an ear when it is convex and holds no corner.
  bool is_ear(const std::vector<int>& corners, std::size_t i, const Vec3& normal) const {
    const std::size_t count = corners.size();
    const Vec3& a = at(corners, i + count - 1);
    const Vec3& b = at(corners, i);
    const Vec3& c = at(corners, i + 1);
    if (!(turn(a, b, c, normal) > 0)) return false;
    for (std::size_t k = 2; k + 1 < count; ++k)
      if (holds(a, b, c, at(corners, i + k), normal)) return false;
    return true;
  }

  void emit(const std::vector<int>& corners, std::size_t i) {
    const std::size_t count = corners.size();
    triangles_.push_back({corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]});
  }

  const std::vector<Vec3>& points_;
  std::vector<std::array<int, 3>>& triangles_;
};

template <typename Number>
std::optional<Number> parsed(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace

void refuse_file(const std::string& why) {
  throw Error(Fault::kBadInput, "The model file is damaged: " + why,
              "Export the model again from the program that made it.");
}

void SoupBuilder::add_point(const Vec3& point) {
  if (point_count() >= kMaxPoints) refuse_size();
  points_.push_back(point);
}

void SoupBuilder::add_polygon(std::span<const std::int64_t> corners) {
  if (corners.size() < 3) return;  // points and lines, which some formats call faces
  triangles_ += static_cast<std::int64_t>(corners.size()) - 2;
  if (triangles_ > kMaxTriangles) refuse_size();
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  sizes_.push_back(static_cast<std::int32_t>(corners.size()));
}

TriangleSoup SoupBuilder::finish() {
  for (const std::int64_t corner : corners_)
    if (corner < 0 || corner >= point_count())
      refuse_file("a face names point " + std::to_string(corner) + " of " +
                  std::to_string(point_count()));
  TriangleSoup soup;
  soup.points = std::move(points_);
  soup.triangles.reserve(static_cast<std::size_t>(triangles_));
  PolygonCutter cutter(soup.points, soup.triangles);
  auto corner = corners_.begin();
  for (const std::int32_t size : sizes_) {
    cutter.cut(std::vector<int>(corner, corner + size));
    corner += size;
  }
  *this = SoupBuilder();
  return soup;
}

std::optional<std::string_view> LineReader::next() {
  if (rest_.empty()) return std::nullopt;
  const std::size_t end = rest_.find_first_of("\r\n");
  const std::string_view line = rest_.substr(0, end);
  if (end == std::string_view::npos) {
    rest_ = {};
  } else {
    const bool both = rest_[end] == '\r' && end + 1 < rest_.size() && rest_[end + 1] == '\n';
    rest_.remove_prefix(end + (both ? 2 : 1));
  }
  ++line_;
  return line;
}

std::optional<std::string_view> LineReader::next_with_content() {
  while (auto line = next()) {
    const std::string_view content = line->substr(0, line->find('#'));
    if (content.find_first_not_of(kBlanks) != std::string_view::npos) return content;
  }
  return std::nullopt;
}

std::string_view take_word(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) {
    text = {};
    return {};
  }
  text.remove_prefix(begin);
  const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
  text.remove_prefix(word.size());
  return word;
}

std::optional<double> to_double(std::string_view word) { return parsed<double>(word); }

std::optional<std::int64_t> to_integer(std::string_view word) { return parsed<std::int64_t>(word); }

Vec3 take_point(std::string_view& text, int line_number) {
  Vec3 point;
  for (int axis = 0; axis < 3; ++axis) {
    const auto number = to_double(take_word(text));
    if (!number) refuse_file("three numbers were expected in line " + std::to_string(line_number));
    point[axis] = *number;
  }
  return point;
}

}  // namespace packmerger
