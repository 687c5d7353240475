// The readers of the single formats, and what they share. Only read_model.cpp and they include it.
// Every reader throws Error{kBadInput}; the caller checks coordinates and that triangles are there.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/progress.h"
#include "model/mesh.h"

namespace packmerger {

TriangleSoup read_stl(std::string_view bytes, const Progress& progress);
TriangleSoup read_obj(std::string_view bytes, const Progress& progress);
TriangleSoup read_ply(std::string_view bytes, const Progress& progress);
TriangleSoup read_off(std::string_view bytes, const Progress& progress);

// What a 3MF holds besides matter that is to be printed; counts.
struct LeftOut3mf {
  int modifiers = 0;        // volumes of a slicer's project
  int support_helpers = 0;  // its support blockers and enforcers
  int support_objects = 0;
  int other_objects = 0;  // of type "other"
  int unprinted_items = 0;
};

struct Parts3mf {
  TriangleSoup soup;  // mm
  LeftOut3mf left_out;
};
Parts3mf read_3mf(std::string_view bytes, const Progress& progress);

// Whether the length is that of a binary STL with the count it declares.
bool has_binary_stl_length(std::string_view bytes);

// The refusal of a damaged file, with the common hint.
[[noreturn]] void refuse_file(const std::string& why);

// Collects points and polygons within the limits of read_model.h.
class SoupBuilder {
 public:
  void add_point(const Vec3& point);
  // Indices from 0; checked in finish(), since some formats name points before they give them.
  void add_polygon(std::span<const std::int64_t> corners);
  std::int64_t point_count() const { return static_cast<std::int64_t>(points_.size()); }
  // Cuts the polygons into triangles. Leaves the builder empty.
  TriangleSoup finish();

 private:
  std::vector<Vec3> points_;
  std::vector<std::int64_t> corners_;  // of all polygons, one after the other
  std::vector<std::int32_t> sizes_;
  std::int64_t triangles_ = 0;
};

// Lines of text, ended by LF, CR or both.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {}
  std::optional<std::string_view> next();
  // The next line with more on it than blanks and a # comment, without the comment.
  std::optional<std::string_view> next_with_content();
  std::string_view rest() const { return rest_; }
  int line_number() const { return line_; }

 private:
  std::string_view rest_;
  int line_ = 0;
};

// Cuts the next word (no blanks) off text; empty at its end.
std::string_view take_word(std::string_view& text);

// The number a word spells, whole, "+" allowed; "nan" and "inf" are numbers here.
std::optional<double> to_double(std::string_view word);
std::optional<std::int64_t> to_integer(std::string_view word);

// The next three words as a point, or a refusal naming the line.
Vec3 take_point(std::string_view& text, int line_number);

}  // namespace packmerger
