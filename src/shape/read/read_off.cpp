// OFF in ASCII, with or without the colours, normals and texture of its variants (STCNOFF and
// less).
#include <vector>

#include "base/error.h"
#include "shape/read/formats.h"

namespace packmerger {
namespace {

constexpr int kCheckEvery = 1 << 16;

std::string_view next_line(LineReader& lines) {
  const auto line = lines.next_with_content();
  if (!line) refuse_file("it ends after line " + std::to_string(lines.line_number()));
  return *line;
}

std::int64_t take_count(std::string_view& text, int line) {
  const auto count = to_integer(take_word(text));
  if (!count || *count < 0) refuse_file("a count was expected in line " + std::to_string(line));
  return *count;
}

}  // namespace

TriangleSoup read_off(std::string_view bytes, const Progress& progress) {
  LineReader lines(bytes);
  std::string_view text = next_line(lines);
  std::string_view after_word = text;
  if (const std::string_view word = take_word(after_word); word.ends_with("OFF")) {
    if (word.find_first_not_of("STCNOF") != word.npos)
      throw Error(Fault::kBadInput,
                  "OFF files whose points have other than three coordinates are not supported",
                  "Export the model as OFF, STL or 3MF.");
    text = after_word;
  }
  if (std::string_view peek = text; take_word(peek) == "BINARY")
    throw Error(Fault::kBadInput, "Binary OFF files are not supported",
                "Export the model as ASCII OFF, STL or 3MF.");
  if (std::string_view peek = text; take_word(peek).empty()) text = next_line(lines);
  const std::int64_t points = take_count(text, lines.line_number());
  const std::int64_t faces = take_count(text, lines.line_number());

  // Each element takes a line: the loops end with the file whatever the counts say.
  SoupBuilder soup;
  for (std::int64_t i = 0; i < points; ++i) {
    if (i % kCheckEvery == 0) progress.check();
    text = next_line(lines);
    soup.add_point(take_point(text, lines.line_number()));
  }
  std::vector<std::int64_t> face;
  for (std::int64_t i = 0; i < faces; ++i) {
    if (i % kCheckEvery == 0) progress.check();
    text = next_line(lines);
    const std::int64_t corners = take_count(text, lines.line_number());
    face.clear();
    for (std::int64_t k = 0; k < corners; ++k) {
      const std::string_view word = take_word(text);
      const auto index = to_integer(word);
      if (!index)
        refuse_file("a face's corner is missing in line " + std::to_string(lines.line_number()));
      face.push_back(*index);
    }
    soup.add_polygon(face);
  }
  return soup.finish();
}

}  // namespace packmerger
