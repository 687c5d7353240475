#include "firmware_io/simulated/traits.h"

#include <charconv>
#include <utility>

namespace packmerger::simulated {

namespace {

template <typename Traits>
using Names = std::vector<std::pair<std::string_view, bool Traits::*>>;

const Names<MarlinTraits>& names_of(const MarlinTraits&) {
  using T = MarlinTraits;
  static const Names<T> names = {{"doubled_silent", &T::doubled_silent},
                                 {"rx_overflow", &T::rx_overflow},
                                 {"emergency_parser", &T::emergency_parser},
                                 {"prompts", &T::prompts},
                                 {"busy", &T::busy},
                                 {"crlf", &T::crlf},
                                 {"m110_anywhere", &T::m110_anywhere},
                                 {"advanced_ok", &T::advanced_ok},
                                 {"idle_wait", &T::idle_wait},
                                 {"autoreport", &T::autoreport},
                                 {"reports_unasked", &T::reports_unasked},
                                 {"resend_error", &T::resend_error},
                                 {"resend_ok", &T::resend_ok},
                                 {"resend_short", &T::resend_short},
                                 {"filament_change", &T::filament_change},
                                 {"positions_unasked", &T::positions_unasked},
                                 {"chatters", &T::chatters},
                                 {"heats_quietly", &T::heats_quietly},
                                 {"doubled_ok", &T::doubled_ok},
                                 {"counts_lines", &T::counts_lines},
                                 {"checks_sums", &T::checks_sums},
                                 {"drops_garbled", &T::drops_garbled},
                                 {"counts_relative_e", &T::counts_relative_e},
                                 {"refuses_raw", &T::refuses_raw},
                                 {"macros", &T::macros},
                                 {"comment_blank", &T::comment_blank}};
  return names;
}

const std::vector<std::pair<std::string_view, std::size_t MarlinTraits::*>>& line_names() {
  using T = MarlinTraits;
  static const std::vector<std::pair<std::string_view, std::size_t T::*>> names = {
      {"stops_at", &T::stops_at}, {"fatal_at", &T::fatal_at}, {"refuses_at", &T::refuses_at}};
  return names;
}

const Names<ReplicatorTraits>& names_of(const ReplicatorTraits&) {
  using T = ReplicatorTraits;
  static const Names<T> names = {{"noise_endless", &T::noise_endless},
                                 {"unknown_accepted", &T::unknown_accepted},
                                 {"version_hidden", &T::version_hidden},
                                 {"counts_actions", &T::counts_actions},
                                 {"packet_timeout", &T::packet_timeout}};
  return names;
}

template <typename Traits>
bool set(Traits& traits, std::string_view text) {
  const std::size_t equals = text.find('=');
  const std::string_view value = equals == std::string_view::npos ? "on" : text.substr(equals + 1);
  if (value != "on" && value != "off") return false;
  for (const auto& [name, member] : names_of(traits)) {
    if (name != text.substr(0, equals)) continue;
    traits.*member = value == "on";
    return true;
  }
  return false;
}

// "stops_at=40". Lines are counted from 1.
bool set_line(MarlinTraits& traits, std::string_view text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos) return false;
  const std::string_view value = text.substr(equals + 1);
  std::size_t line = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), line);
  const bool is_line = error == std::errc() && end == value.data() + value.size() && line > 0;
  if (!is_line && value != "off") return false;
  for (const auto& [name, member] : line_names()) {
    if (name != text.substr(0, equals)) continue;
    traits.*member = line;
    return true;
  }
  return false;
}

template <typename Table>
std::vector<std::string> listed(const Table& table) {
  std::vector<std::string> names;
  for (const auto& [name, member] : table) names.emplace_back(name);
  return names;
}

}  // namespace

MarlinTraits marlin_1_1() {
  MarlinTraits traits;
  traits.version = "1.1.9";
  traits.doubled_silent = false;
  traits.rx_overflow = true;
  traits.emergency_parser = false;
  traits.prompts = false;
  traits.filament_change = false;
  return traits;
}

MarlinTraits klipper() {
  MarlinTraits traits;
  traits.counts_lines = traits.busy = traits.autoreport = traits.prompts = false;
  traits.emergency_parser = traits.filament_change = traits.crlf = false;
  traits.comment_blank = traits.heats_quietly = traits.macros = true;
  return traits;
}

bool set_trait(MarlinTraits& traits, std::string_view text) {
  return set(traits, text) || set_line(traits, text);
}
bool set_trait(ReplicatorTraits& traits, std::string_view text) { return set(traits, text); }
std::vector<std::string> marlin_trait_names() { return listed(names_of(MarlinTraits())); }
std::vector<std::string> marlin_line_trait_names() { return listed(line_names()); }
std::vector<std::string> replicator_trait_names() { return listed(names_of(ReplicatorTraits())); }

}  // namespace packmerger::simulated
