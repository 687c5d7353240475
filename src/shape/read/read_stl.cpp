// STL, binary and ASCII. It has no unit and no shared points: each triangle brings its own three.
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "base/error.h"
#include "shape/read/formats.h"

namespace packmerger {
namespace {

static_assert(std::endian::native == std::endian::little, "the bytes of STL are read as they are");

constexpr std::size_t kHeader = 84;    // 80 bytes of anything, then the count
constexpr std::size_t kTriangle = 50;  // normal, three points, two bytes of attributes
constexpr std::size_t kCheckEvery = 1 << 16;

std::uint64_t declared_triangles(std::string_view bytes) {
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, sizeof count);
  return count;
}

void add_triangle(SoupBuilder& soup) {
  const std::int64_t end = soup.point_count();
  soup.add_polygon(std::array{end - 3, end - 2, end - 1});
}

TriangleSoup read_binary(std::string_view bytes, const Progress& progress) {
  const std::uint64_t count = declared_triangles(bytes);
  if (count > (bytes.size() - kHeader) / kTriangle)
    refuse_file("its header declares " + std::to_string(count) +
                " triangles, but the file ends after " +
                std::to_string((bytes.size() - kHeader) / kTriangle));
  SoupBuilder soup;
  for (std::size_t i = 0; i < count; ++i) {
    if (i % kCheckEvery == 0) progress.check();
    std::array<float, 9> numbers{};
    std::memcpy(numbers.data(), bytes.data() + kHeader + i * kTriangle + 12, sizeof numbers);
    for (int corner = 0; corner < 3; ++corner)
      soup.add_point({numbers[3 * corner], numbers[3 * corner + 1], numbers[3 * corner + 2]});
    add_triangle(soup);
  }
  return soup.finish();
}

// Several solids are one soup. Names may hold anything, so only the first word of a line counts.
TriangleSoup read_ascii(std::string_view bytes, const Progress& progress) {
  SoupBuilder soup;
  LineReader lines(bytes);
  int corners = 0;
  while (auto line = lines.next()) {
    if (lines.line_number() % kCheckEvery == 0) progress.check();
    std::string_view text = *line;
    const std::string_view word = take_word(text);
    if (word == "vertex" || word == "VERTEX") {
      soup.add_point(take_point(text, lines.line_number()));
      ++corners;
    } else if (word == "endfacet" || word == "ENDFACET") {
      if (corners != 3)
        refuse_file("the facet that ends in line " + std::to_string(lines.line_number()) + " has " +
                    std::to_string(corners) + " corners");
      add_triangle(soup);
      corners = 0;
    }
  }
  if (corners != 0) refuse_file("it ends in the middle of a facet");
  return soup.finish();
}

bool looks_like_text(std::string_view bytes) {
  std::string_view text = bytes.substr(0, 1 << 16);
  const std::string_view first = take_word(text);
  return (first == "solid" || first == "SOLID") &&
         (text.find("facet") != text.npos || text.find("FACET") != text.npos ||
          text.find("endsolid") != text.npos);
}

}  // namespace

bool has_binary_stl_length(std::string_view bytes) {
  return bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * declared_triangles(bytes);
}

TriangleSoup read_stl(std::string_view bytes, const Progress& progress) {
  if (has_binary_stl_length(bytes)) return read_binary(bytes, progress);
  if (looks_like_text(bytes)) return read_ascii(bytes, progress);
  if (bytes.size() < kHeader) refuse_file("it is too short to be an STL file");
  return read_binary(bytes, progress);  // some programs append bytes of their own
}

}  // namespace packmerger
