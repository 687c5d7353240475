#include "printers/slice/slicer_settings.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "gcode/gcode_line.h"
#include "printers/check/check_moves.h"

namespace packmerger {
namespace {

// What PrusaSlicer takes when nothing is said.
constexpr double kNozzleMm = 0.4;
constexpr double kSkirtDistanceMm = 6;
constexpr double kFirstLayerGrowthMm = 3;  // of support on the plate

constexpr double kSupportSpacingMm = 2.5;
constexpr double kLineNozzles = 1.3;  // a first layer's line, generously

constexpr std::array<std::string_view, 8> kDerived{"bed_shape",
                                                   "max_print_height",
                                                   "layer_height",
                                                   "start_gcode",
                                                   "end_gcode",
                                                   "support_material_threshold",
                                                   "use_relative_e_distances",
                                                   "gcode_comments"};

// What PrusaSlicer would run when it has sliced.
constexpr std::string_view kRunsPrograms = "post_process";

std::optional<double> number(std::string_view text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

bool is_empty(std::string_view value) {
  return value.find_first_not_of(" \t\r\n\";") == std::string_view::npos;
}

double option(const Profile& profile, const std::string& name, double otherwise) {
  const auto found = profile.slicer.options.find(name);
  if (found == profile.slicer.options.end()) return otherwise;
  return number(found->second).value_or(otherwise);
}

Error bad_option(const std::string& name, const std::string& why) {
  return Error(Fault::kBadProfile, "slicer.options." + name + " " + why,
               "Correct the profile; PrusaSlicer's documentation lists its options.");
}

// Line ends as PrusaSlicer writes them in its files.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n')
      result += "\\n";
    else if (c == '\\')
      result += "\\\\";
    else if (c != '\r')
      result += c;
  }
  return result;
}

std::string bed_shape(const Profile& profile) {
  const Box3 volume = machine_volume(profile);
  const Vec3& a = volume.min();
  const Vec3& b = volume.max();
  if (!profile.plate_mm.empty()) {
    std::string corners;
    for (const Vec2& at : profile.plate_mm)
      corners +=
          fmt::format("{}{:g}x{:g}", corners.empty() ? "" : ",", a.x() + at.x(), a.y() + at.y());
    return corners;
  }
  return fmt::format("{:g}x{:g},{:g}x{:g},{:g}x{:g},{:g}x{:g}", a.x(), a.y(), b.x(), a.y(), b.x(),
                     b.y(), a.x(), b.y());
}

std::string flavour_name(const Profile& profile, SliceFlavour flavour) {
  if (flavour == SliceFlavour::kFigures) return "marlin";
  const ProgramLanguage* language = profile.language();
  if (language != nullptr && !language->gcode_flavor.empty())
    return std::string(language->gcode_flavor);
  const auto named = profile.slicer.options.find("gcode_flavor");
  return named == profile.slicer.options.end() ? "marlin" : named->second;
}

// Support is laid where a facet lies flatter than this; 0 would mean "choose yourself".
int threshold_deg(const Profile& profile) {
  return std::clamp(static_cast<int>(std::lround(90 - profile.support_angle_deg)), 1, 90);
}

// Leaves out what has no room: support's broader first layer, then the skirt.
void fit_into(double room_mm, const Profile& profile, SlicerConfig& config) {
  const double nozzle_mm = option(profile, "nozzle_diameter", kNozzleMm);
  const double support_mm = slicer_margin_mm(profile);
  double growth_mm = option(profile, "raft_first_layer_expansion", kFirstLayerGrowthMm);
  if (support_mm > 0 && room_mm < support_mm + growth_mm) {
    growth_mm = std::max(0.0, room_mm - support_mm);
    config.values["raft_first_layer_expansion"] = fmt::format("{:.3g}", growth_mm);
  }
  const double skirts = option(profile, "skirts", 1);
  const double reach_mm =
      (support_mm > 0 ? support_mm + growth_mm : 0) + option(profile, "brim_width", 0) +
      option(profile, "skirt_distance", kSkirtDistanceMm) + skirts * kLineNozzles * nozzle_mm;
  if (skirts > 0 && room_mm < reach_mm) {
    config.values["skirts"] = "0";
    config.skirt_left_out = true;
  }
}

// "10%", "10" and "10.0" are one value, and so are a text and the same text in quotes.
bool same_value(std::string_view a, std::string_view b) {
  const auto bare = [](std::string_view text) {
    if (text.size() >= 2 && text.front() == '"' && text.back() == '"')
      text = text.substr(1, text.size() - 2);
    if (!text.empty() && text.back() == '%') text.remove_suffix(1);
    return text;
  };
  const std::string_view x = bare(a);
  const std::string_view y = bare(b);
  if (x == y) return true;
  const std::optional<double> m = number(x);
  const std::optional<double> n = number(y);
  return m && n && std::abs(*m - *n) <= 1e-6 * std::max(std::abs(*m), std::abs(*n));
}

}  // namespace

// The slicer fills whole cells of a grid with support: cells as wide as the space between two lines
// and a line.
double slicer_margin_mm(const Profile& profile) {
  if (!profile.is_sliced()) return 0;
  if (option(profile, "support_material", 0) == 0) return 0;
  return option(profile, "support_material_spacing", kSupportSpacingMm) +
         kLineNozzles * option(profile, "nozzle_diameter", kNozzleMm);
}

SlicerConfig slicer_config(const Profile& profile, SliceFlavour flavour, double room_mm) {
  SlicerConfig config;
  for (const auto& [name, value] : profile.slicer.options) {
    if (std::find(kDerived.begin(), kDerived.end(), name) != kDerived.end())
      throw bad_option(name, "follows from the profile's other keys and may not be set");
    if (name.empty() ||
        name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != std::string::npos)
      throw bad_option(name, "is no name of an option");
    if (name == kRunsPrograms) {
      if (is_empty(value)) continue;
      throw bad_option(name, "would run other programs whenever something is sliced");
    }
    config.values[name] = value.find('\n') == std::string::npos ? value : escaped(value);
  }
  config.values["bed_shape"] = bed_shape(profile);
  config.values["max_print_height"] = fmt::format("{:g}", profile.build_mm[2]);
  config.values["layer_height"] = fmt::format("{:g}", profile.layer_mm);
  config.values.emplace("first_layer_height", fmt::format("{:g}", profile.layer_mm));
  config.values["support_material_threshold"] = fmt::format("{}", threshold_deg(profile));
  config.values["gcode_flavor"] = flavour_name(profile, flavour);
  config.values["use_relative_e_distances"] = "0";
  config.values["gcode_comments"] = "0";
  // an empty text would be replaced by the slicer's own
  const bool figures = flavour == SliceFlavour::kFigures;
  config.values["start_gcode"] =
      figures ? "; start" : escaped("; start\n" + profile.slicer.start_gcode);
  config.values["end_gcode"] = figures ? "; end" : escaped(profile.slicer.end_gcode + "\n; end");
  fit_into(room_mm, profile, config);
  return config;
}

std::string ini_text(const SlicerConfig& config) {
  std::string text;
  for (const auto& [name, value] : config.values) text += name + " = " + value + "\n";
  return text;
}

std::map<std::string, std::string> settings_used(std::string_view gcode) {
  std::map<std::string, std::string> used;
  const std::size_t start = gcode.rfind("; prusaslicer_config = begin");
  if (start == std::string_view::npos) return used;
  for_each_line(gcode.substr(start), [&](std::string_view line, int) {
    const std::size_t equals = line.find(" = ");
    if (line.starts_with("; ") && equals != std::string_view::npos)
      used.emplace(line.substr(2, equals - 2), line.substr(equals + 3));
    return true;
  });
  return used;
}

void check_settings_used(const Profile& profile, const std::map<std::string, std::string>& used) {
  for (const auto& [name, value] : profile.slicer.options) {
    if (name == "gcode_flavor" || name == "skirts" || name == "raft_first_layer_expansion" ||
        name == kRunsPrograms)
      continue;  // may be ours, or was not passed on
    const auto found = used.find(name);
    if (found == used.end()) throw bad_option(name, "is not known to PrusaSlicer");
    if (!same_value(found->second, escaped(value)) && !same_value(found->second, value))
      throw bad_option(name, fmt::format("= \"{}\" was not understood: PrusaSlicer took \"{}\"",
                                         value, found->second));
  }
}

}  // namespace packmerger
