#include "shape/read/volume_roles.h"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "shape/read/formats.h"
#include "shape/read/unread_3mf.h"

namespace packmerger {
namespace {

constexpr std::string_view kCura = "http://software.ultimaker.com/xml/cura/3mf/2015/10";

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
  refuse_unknown_role(name);
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

ObjectRoles::Range range_of(const pugi::xml_attribute& first, const pugi::xml_attribute& last,
                            VolumeRole role) {
  const auto from = to_integer(first.value());
  const auto to = to_integer(last.value());
  if (!from || !to) refuse_file("its settings give a range of triangles that is none");
  return {*from, *to, role};
}

void add(const pugi::xml_node& volume, ObjectRoles& object) {
  const VolumeRole role = role_of(volume);
  const pugi::xml_attribute first = volume.attribute("firstid");
  if (!first) {
    object.components[volume.attribute("id").value()] = role;
    return;
  }
  object.ranges.push_back(range_of(first, volume.attribute("lastid"), role));
}

void add_slic3r_roles(const pugi::xml_node& object, std::map<std::string, ObjectRoles>& objects) {
  const pugi::xml_node volumes = child_named(child_named(object, "mesh"), "volumes");
  for (const pugi::xml_node& volume : volumes.children())
    if (volume.attribute("modifier").as_bool())
      objects[object.attribute("id").value()].ranges.push_back(
          range_of(volume.attribute("ts"), volume.attribute("te"), VolumeRole::kModifier));
}

// A setting's name without the prefix that stands for Cura; empty where it is another program's.
std::string_view cura_name(std::string_view name, const pugi::xml_node& model) {
  const std::size_t colon = name.find(':');
  if (colon == std::string_view::npos) return name;
  const std::string prefix(name.substr(0, colon));
  const bool is_cura =
      prefix == "cura" || model.attribute(("xmlns:" + prefix).c_str()).value() == kCura;
  return is_cura ? name.substr(colon + 1) : "";
}

VolumeRole role_of_setting(std::string_view name) {
  // An infill mesh changes the infill of what it overlaps, a cutting mesh takes from that what is
  // its own: neither is printed beyond the others, nor takes matter away.
  if (name == "infill_mesh" || name == "cutting_mesh") return VolumeRole::kModifier;
  if (name == "anti_overhang_mesh" || name == "support_mesh") return VolumeRole::kSupportHelper;
  if (name.ends_with("_mesh")) refuse_unknown_role(name);
  return VolumeRole::kPart;
}

// The component that an object's settings are for, where Cura gave its mesh to a component because
// others hang on it.
std::string mesh_component(const pugi::xml_node& object) {
  for (const pugi::xml_node& metadata : child_named(object, "metadatagroup").children())
    if (std::string_view(metadata.attribute("name").value()) == "mesh_node_objectid")
      return metadata.text().get();
  return "";
}

void add_cura_role(const pugi::xml_node& object, const pugi::xml_node& model,
                   std::map<std::string, ObjectRoles>& objects) {
  const std::string id = object.attribute("id").value();
  const VolumeRole role = cura_role(object, model);
  if (role == VolumeRole::kPart) return;
  if (child_named(object, "mesh"))
    objects[id].ranges = {{0, std::numeric_limits<std::int64_t>::max(), role}};
  if (!child_named(object, "components")) return;
  const std::string component = mesh_component(object);
  if (component.empty()) refuse_unknown_role("for a group of models");
  objects[id].components[component] = role;
}

}  // namespace

VolumeRole cura_role(const pugi::xml_node& owner, const pugi::xml_node& model) {
  VolumeRole role = VolumeRole::kPart;
  const auto read = [&](const char* group, const char* key) {
    for (const pugi::xml_node& setting : child_named(owner, group).children()) {
      const std::string_view name = cura_name(setting.attribute(key).value(), model);
      if (name.empty() || !setting.text().as_bool()) continue;
      if (name == "mold_enabled") refuse_mould(owner);
      if (role == VolumeRole::kPart) role = role_of_setting(name);
    }
  };
  read("settings", "key");  // as the first versions wrote it
  read("metadatagroup", "name");
  return role;
}

VolumeRole ObjectRoles::of_triangle(std::int64_t triangle) const {
  // As they are written, one after the other.
  const auto after = std::upper_bound(
      ranges.begin(), ranges.end(), triangle,
      [](std::int64_t wanted, const Range& range) { return wanted < range.first; });
  if (after == ranges.begin()) return VolumeRole::kPart;
  const Range& range = *std::prev(after);
  return triangle <= range.last ? range.role : VolumeRole::kPart;
}

std::map<std::string, ObjectRoles> read_volume_roles(Archive3mf& archive,
                                                     const pugi::xml_node& model) {
  std::map<std::string, ObjectRoles> objects;
  for (const pugi::xml_node& object : child_named(model, "resources").children())
    if (local_name(object.name()) == "object") {
      add_slic3r_roles(object, objects);
      add_cura_role(object, model, objects);
    }
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
