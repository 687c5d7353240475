// One line of G-code taken apart, for the checks and sums of this folder.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace packmerger {

class GcodeLine {
 public:
  // Line numbers, checksums and both kinds of comments are left out; letters may be small.
  explicit GcodeLine(std::string_view text);

  // The command: letter 'G', 'M' or 'T' with its number ("G92.1": 92 and 1); letter 0 for a line
  // without one.
  char letter() const { return letter_; }
  int number() const { return number_; }
  int sub_number() const { return sub_number_; }
  bool is(char letter, int number) const {
    return letter_ == letter && number_ == number && sub_number_ == 0;
  }

  // Whether the word is there, and its value (empty where it stands alone, as in "G28 X").
  bool has(char word) const { return (present_ >> (word - 'A') & 1U) != 0; }
  std::optional<double> value(char word) const;

  // False where something stands behind the command that is no word, as the text of M117.
  bool readable() const { return readable_; }

 private:
  char letter_ = 0;
  int number_ = 0;
  int sub_number_ = 0;
  bool readable_ = true;
  std::uint32_t present_ = 0;
  std::uint32_t valued_ = 0;
  std::array<double, 26> values_{};
};

// Calls visit(line, number) for each line, numbered from 1, without its line end; visit returns
// false to stop.
template <typename Visit>
void for_each_line(std::string_view text, const Visit& visit) {
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (!visit(line, ++number)) return;
  }
}

}  // namespace packmerger
