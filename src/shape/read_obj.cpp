// Wavefront OBJ: the points and faces of all groups; everything else in it does not concern shape.
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "shape/formats.h"

namespace packmerger {
namespace {

constexpr int kCheckEvery = 1 << 16;

// "7", "7/1", "7//3" or "-1": the point's number, from 1, or from the end where negative.
std::int64_t point_index(std::string_view corner, std::int64_t points, int line) {
  const auto number = to_integer(corner.substr(0, corner.find('/')));
  if (!number || *number == 0)
    refuse_file("a face's corner is not a number in line " + std::to_string(line));
  return *number > 0 ? *number - 1 : points + *number;
}

// The next line with more on it than blanks and comments; lines that end in a backslash go on in
// the next. joined: room for such lines; the view may point into it.
std::optional<std::string_view> next_statement(LineReader& lines, std::string& joined) {
  constexpr std::string_view kLineBlanks = " \t";
  auto line = lines.next_with_content();
  joined.clear();
  while (line) {
    const std::size_t last = line->find_last_not_of(kLineBlanks);
    if (last == line->npos || (*line)[last] != '\\') break;
    joined += line->substr(0, last);
    joined += ' ';
    line = lines.next();
    if (line) line = line->substr(0, line->find('#'));
  }
  if (joined.empty()) return line;
  if (line) joined += *line;
  return joined;
}

}  // namespace

TriangleSoup read_obj(std::string_view bytes, const Progress& progress) {
  SoupBuilder soup;
  LineReader lines(bytes);
  std::vector<std::int64_t> face;
  std::string joined;
  while (auto line = next_statement(lines, joined)) {
    if (lines.line_number() % kCheckEvery == 0) progress.check();
    std::string_view text = *line;
    const std::string_view key = take_word(text);
    if (key == "v") soup.add_point(take_point(text, lines.line_number()));
    if (key != "f") continue;
    face.clear();
    for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
      face.push_back(point_index(word, soup.point_count(), lines.line_number()));
    }
    soup.add_polygon(face);
  }
  return soup.finish();
}

}  // namespace packmerger
