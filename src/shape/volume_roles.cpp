#include "shape/volume_roles.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "shape/formats.h"

namespace packmerger {
namespace {

constexpr std::array<const char*, 2> kSettings = {"Metadata/Slic3r_PE_model.config",
                                                  "Metadata/model_settings.config"};

VolumeRole role_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, VolumeRole>, 11> kNames = {{
      {"", VolumeRole::kPart},
      {"ModelPart", VolumeRole::kPart},
      {"normal_part", VolumeRole::kPart},
      {"NegativeVolume", VolumeRole::kNegative},
      {"negative_part", VolumeRole::kNegative},
      {"ParameterModifier", VolumeRole::kModifier},
      {"modifier_part", VolumeRole::kModifier},
      {"SupportBlocker", VolumeRole::kSupportHelper},
      {"support_blocker", VolumeRole::kSupportHelper},
      {"SupportEnforcer", VolumeRole::kSupportHelper},
      {"support_enforcer", VolumeRole::kSupportHelper},
  }};
  for (const auto& [known, role] : kNames)
    if (known == name) return role;
  throw Error(Fault::kBadInput,
              "The 3MF project holds a volume of a kind that is not known (" +
                  std::string(name.substr(0, 40)) + ")",
              "Export the model from the slicer as STL.");
}

VolumeRole role_of(const pugi::xml_node& volume) {
  std::string name = volume.attribute("subtype").value();
  bool is_modifier = false;  // as projects before PrusaSlicer 1.41 say it
  for (const pugi::xml_node& metadata : volume.children("metadata")) {
    const std::string_view key = metadata.attribute("key").value();
    if (key == "volume_type") name = metadata.attribute("value").value();
    if (key == "modifier") is_modifier = metadata.attribute("value").as_bool();
  }
  return name.empty() && is_modifier ? VolumeRole::kModifier : role_named(name);
}

void add(const pugi::xml_node& volume, ObjectRoles& object) {
  const VolumeRole role = role_of(volume);
  const pugi::xml_attribute first = volume.attribute("firstid");
  if (!first) {
    object.components[volume.attribute("id").value()] = role;
    return;
  }
  const auto from = to_integer(first.value());
  const auto to = to_integer(volume.attribute("lastid").value());
  if (!from || !to) refuse_file("its settings give a range of triangles that is none");
  object.ranges.push_back({*from, *to, role});
}

}  // namespace

VolumeRole ObjectRoles::of_triangle(std::int64_t triangle) const {
  // As they are written, one after the other.
  const auto after = std::upper_bound(
      ranges.begin(), ranges.end(), triangle,
      [](std::int64_t wanted, const Range& range) { return wanted < range.first; });
  if (after == ranges.begin()) return VolumeRole::kPart;
  const Range& range = *std::prev(after);
  return triangle <= range.last ? range.role : VolumeRole::kPart;
}

std::map<std::string, ObjectRoles> read_volume_roles(Archive3mf& archive) {
  std::map<std::string, ObjectRoles> objects;
  for (const char* name : kSettings) {
    const auto settings = archive.part(name);
    if (!settings) continue;
    for (const pugi::xml_node& object : settings->tree.child("config").children("object"))
      for (const pugi::xml_node& volume : object.children()) {
        const std::string_view kind = volume.name();
        if (kind == "volume" || kind == "part")
          add(volume, objects[object.attribute("id").value()]);
      }
  }
  for (auto& entry : objects) {
    std::vector<ObjectRoles::Range>& ranges = entry.second.ranges;
    std::sort(ranges.begin(), ranges.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  return objects;
}

}  // namespace packmerger
