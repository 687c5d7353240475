// One line of G-code taken apart by the rules of the firmware that will execute it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace packmerger {

// Whose reading counts; docs/ESTIMATES has the table of differences.
enum class GcodeRules {
  kMarlin,  // the printer itself reads it
  kGpx      // gpx reads it, and writes x3g for a Replicator
};

class GcodeLine {
 public:
  // Line numbers, checksums and comments are left out. "(…)" is a comment for gpx alone; letters
  // may be small for gpx alone. Blanks may stand anywhere but within a number.
  GcodeLine(std::string_view text, GcodeRules rules);

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
  // "2" of "M115 P2", or what stands in for it.
  double value_or(char word, double otherwise) const { return value(word).value_or(otherwise); }

  // False where something stands behind the command that is no word, as the text of M117, or that
  // firmwares read differently.
  bool readable() const { return readable_; }
  bool is_empty() const { return letter_ == 0 && present_ == 0 && readable_; }

 private:
  void take_words(std::string_view text, GcodeRules rules);

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
