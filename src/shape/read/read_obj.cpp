// Wavefront OBJ: the points and faces of all groups. Free-form surfaces are refused by name;
// everything else in it does not concern shape.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "shape/read/formats.h"

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

void refuse_free_form(std::string_view key, int line) {
  constexpr std::array<std::string_view, 4> kPatches = {"surf", "bzp", "bsp", "cdp"};
  if (std::find(kPatches.begin(), kPatches.end(), key) == kPatches.end()) return;
  throw Error(Fault::kBadInput,
              "The model file holds free-form surfaces (line " + std::to_string(line) +
                  "), which are not supported",
              "Export the model as a mesh, for example as STL or 3MF.");
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
    refuse_free_form(key, lines.line_number());
    if (key == "v") soup.add_point(take_point(text, lines.line_number()));
    if (key != "f" && key != "fo") continue;  // fo: a face's outline, before version 3
    face.clear();
    for (std::string_view word = take_word(text); !word.empty(); word = take_word(text)) {
      face.push_back(point_index(word, soup.point_count(), lines.line_number()));
    }
    soup.add_polygon(face);
  }
  return soup.finish();
}

}  // namespace packmerger
