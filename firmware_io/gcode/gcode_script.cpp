#include "firmware_io/gcode/gcode_script.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/error.h"
#include "firmware_io/gcode/gcode.h"

namespace packmerger {

GcodeScript::GcodeScript(std::string_view program) : program_(program) {
  if (program.size() >= kOwn)
    throw Error(Fault::kBadInput, "The program is larger than 4 GiB", "Divide it.");
  for (const GcodeCommand& command : gcode_commands(program))
    places_.push_back({static_cast<std::uint32_t>(command.text.data() - program.data()),
                       static_cast<std::uint32_t>(command.text.size())});
}

std::string_view GcodeScript::operator[](std::size_t index) const {
  const Place place = places_[index];
  if (place.length == kOwn) return own_[place.begin];
  return program_.substr(place.begin, place.length);
}

std::size_t GcodeScript::program_lines(std::size_t count) const {
  count = std::min(count, places_.size());
  return count - static_cast<std::size_t>(std::lower_bound(own_at_.begin(), own_at_.end(), count) -
                                          own_at_.begin());
}

GcodeScript::Place GcodeScript::keep(std::string line) {
  const auto known = std::find(own_.begin(), own_.end(), line);
  const auto index = static_cast<std::uint32_t>(known - own_.begin());
  if (known == own_.end()) own_.push_back(std::move(line));
  return {index, kOwn};
}

void GcodeScript::append(std::string line) {
  own_at_.push_back(places_.size());
  places_.push_back(keep(std::move(line)));
}

void GcodeScript::insert(std::size_t index, const std::vector<std::string>& lines) {
  std::vector<Place> places;
  for (const std::string& line : lines) places.push_back(keep(line));
  places_.insert(places_.begin() + static_cast<std::ptrdiff_t>(index), places.begin(),
                 places.end());
  const auto behind = std::lower_bound(own_at_.begin(), own_at_.end(), index);
  std::for_each(behind, own_at_.end(), [&](std::size_t& at) { at += lines.size(); });
  std::vector<std::size_t> at(lines.size());
  std::iota(at.begin(), at.end(), index);
  own_at_.insert(behind, at.begin(), at.end());
}

void GcodeScript::replace(std::size_t index, std::string line) {
  places_[index] = keep(std::move(line));
}

void GcodeScript::shorten(std::size_t size) {
  places_.resize(std::min(size, places_.size()));
  own_at_.erase(std::lower_bound(own_at_.begin(), own_at_.end(), size), own_at_.end());
}

std::vector<std::string> GcodeScript::modes(std::size_t count) const {
  std::size_t positions = count;  // the last G90 or G91
  std::size_t extrusion = count;  // the last M82 or M83
  std::string feed;
  for (std::size_t i = count;
       i-- > 0 && (positions == count || extrusion == count || feed.empty());) {
    const std::string_view text = (*this)[i];
    const std::string_view word = gcode_word(text);
    if (positions == count && (word == "G90" || word == "G91")) positions = i;
    if (extrusion == count && (word == "M82" || word == "M83")) extrusion = i;
    const std::size_t at = text.find(" F");
    const bool moves = word == "G0" || word == "G1" || word == "G2" || word == "G3";
    if (feed.empty() && moves && at != std::string_view::npos)
      feed = text.substr(at + 1, text.find(' ', at + 1) - at - 1);
  }
  std::vector<std::string> lines;
  for (const std::size_t i : {std::min(positions, extrusion), std::max(positions, extrusion)})
    if (i < count) lines.emplace_back((*this)[i]);
  if (!feed.empty()) lines.push_back("G1 " + feed);
  return lines;
}

std::size_t GcodeScript::bytes() const {
  std::size_t bytes = places_.size() * sizeof(Place) + own_at_.size() * sizeof own_at_[0];
  for (const std::string& line : own_) bytes += sizeof line + line.capacity();
  return bytes;
}

}  // namespace packmerger
