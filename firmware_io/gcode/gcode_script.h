// The lines that a print consists of, in as little memory as a long print allows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace packmerger {

// The program's commands are kept as places in its text, eight bytes each; what the link puts
// between and behind them is kept beside it.
class GcodeScript {
 public:
  // `program` outlives the script. Throws Error{kBadInput} for one of 4 GiB or more.
  explicit GcodeScript(std::string_view program);

  std::size_t size() const { return places_.size(); }
  std::string_view operator[](std::size_t index) const;  // until the next change
  // One that the link put there, or in the place of the program's.
  bool is_own(std::size_t index) const { return places_[index].length == kOwn; }
  // How many of the first `count` lines are the program's.
  std::size_t program_lines(std::size_t count) const;

  void append(std::string line);
  void insert(std::size_t index, const std::vector<std::string>& lines);
  void replace(std::size_t index, std::string line);
  void shorten(std::size_t size);  // to the first `size` lines

  // Commands that set again what the first `count` lines have set last: absolute or relative
  // positions (G90, G91) and extrusion (M82, M83), in their order, and the feed rate.
  std::vector<std::string> modes(std::size_t count) const;

  // What it holds beside the program's text.
  std::size_t bytes() const;

 private:
  struct Place {
    std::uint32_t begin = 0;   // in program_, or in own_
    std::uint32_t length = 0;  // kOwn: a line of own_
  };
  static_assert(sizeof(Place) == 8);
  static constexpr std::uint32_t kOwn = UINT32_MAX;

  Place keep(std::string line);

  std::string_view program_;
  std::deque<Place> places_;         // grows without being copied
  std::vector<std::string> own_;     // each text once
  std::vector<std::size_t> own_at_;  // indices of what was appended or inserted, rising
};

}  // namespace packmerger
