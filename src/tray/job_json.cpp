#include "tray/job_json.h"

#include <fmt/format.h>

#include "base/files.h"
#include "model/files/job_folder_names.h"
#include "model/profile/profile_keys.h"
#include "tray/known_ways.h"
#include "tray/warnings_json.h"

namespace packmerger {
namespace {

using Json = nlohmann::json;

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json points_json(const Polygon& polygon) {
  Json points = Json::array();
  for (const Vec2& at : polygon) points.push_back({at.x(), at.y()});
  return points;
}

Json areas_json(const std::vector<Polygon>& areas) {
  Json json = Json::array();
  for (const Polygon& area : areas) json.push_back(points_json(area));
  return json;
}

struct SettingJson {
  Json operator()(const NumberKey& key) const { return *key.value; }
  Json operator()(const IntegerKey& key) const { return *key.value; }
  Json operator()(const TextKey& key) const { return *key.value; }
  Json operator()(const ChoiceKey& key) const { return key.names[key.get()]; }
  Json operator()(const Numbers3Key& key) const { return *key.value; }
  Json operator()(const PolygonKey& key) const { return points_json(*key.value); }
  Json operator()(const PolygonsKey& key) const { return areas_json(*key.value); }
  Json operator()(const TextsKey& key) const { return *key.value; }
  Json operator()(const TextTableKey& key) const { return *key.value; }
};

// Every key of the profile that stands above its tables, but not what the machine is called.
Json settings_json(Profile profile) {
  Json settings = Json::object();
  for (const Key& key : keys_of(profile))
    if (key.name.find('.') == std::string::npos && key.name != "id" && key.name != "name")
      settings[key.name] = std::visit(SettingJson{}, key.kind);
  return settings;
}

Json transform_json(const Pose& pose) {
  Json numbers = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(pose(row, column));
  return numbers;
}

Json part_json(const JobPart& part) {
  Json neighbours = Json::array();
  for (const JobNeighbour& neighbour : part.neighbours)
    neighbours.push_back({{"id", neighbour.id}, {"glue_area_mm2", neighbour.glue_area_mm2}});
  return {{"id", part.id},
          {"model", part.model},
          {"tray", part.tray},
          {"file", part_file(part.id)},
          {"volume_mm3", part.volume_mm3},
          {"transform", transform_json(part.pose)},
          {"neighbours", neighbours}};
}

Json inputs_json(const Job& job) {
  Json list = Json::array();
  for (std::size_t i = 0; i < job.inputs.size(); ++i) {
    const JobInput& input = job.inputs[i];
    list.push_back({{"file", input.file},
                    {"sha256", input.sha256},
                    {"scale", input.scale},
                    {"size_mm", vector_json(bounding_box(job.models[i]).sizes())}});
  }
  return list;
}

Json removal_paths_json(const std::map<int, std::vector<Vec3>>& paths) {
  Json all = Json::object();
  for (const auto& [id, steps] : paths) {
    Json path = Json::array();
    for (const Vec3& step : steps) path.push_back(vector_json(step));
    all[std::to_string(id)] = path;
  }
  return all;
}

Json packing_json(const Job& job) {
  return {{"weight", job.profile.pack.weight},  {"cost", job.cost},
          {"bbox_mm3", job.bbox_mm3},           {"support_mm3", job.support_mm3},
          {"height_mm", job.height_mm},         {"gap_mm", job.profile.pack.gap_mm},
          {"grid_mm", job.profile.pack.grid_mm}};
}

}  // namespace

Json printer_json(const Profile& profile) {
  const Json settings = settings_json(profile);
  return {{"name", profile.name},
          {"technology", settings["technology"]},
          {"dialect", settings["dialect"]},
          {"build_mm", profile.build_mm},
          {"plate_mm", points_json(profile.plate_mm)},
          {"keep_out_mm", areas_json(profile.keep_out_mm)},
          {"support_angle_deg", profile.support_angle_deg}};
}

Json job_json(const Job& job) {
  Json report = {
      {"version", 1},
      {"inputs", inputs_json(job)},
      {"profile", {{"id", job.profile.id}, {"sha256", sha256_hex(profile_toml(job.profile))}}},
      {"seed", job.seed},
      {"variant", job.variant},
      {"settings", settings_json(job.profile)},
      {"printer", printer_json(job.profile)},
      {"shell", {{"volume_mm3", job.shell_volume_mm3}, {"wall_mm", job.profile.shape.wall_mm}}},
      {"segments",
       {{"tetrahedra", job.tetrahedra},
        {"clusters", job.clusters},
        {"after_premerge", job.after_premerge},
        {"final", job.final_segments}}},
      {"packing", packing_json(job)},
      {"parts", Json::array()},
      {"removal_order", job.removal_order},
      {"estimates", comparison_json(job.estimates)},
      {"advice", advice_json(job.advised, job.advice)},
      {"timings_s", Json::object()},
      {"compared", compared_json(job.compared)},
      {"warnings", warnings_json(job.warnings)}};
  for (const JobPart& part : job.parts) report["parts"].push_back(part_json(part));
  if (!job.removal_paths.empty()) report["removal_path"] = removal_paths_json(job.removal_paths);
  if (job.resample_tolerance_mm) report["resample_tolerance_mm"] = *job.resample_tolerance_mm;
  for (const auto& [stage, seconds] : job.timings_s) report["timings_s"][stage] = seconds;
  return report;
}

std::string report_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace packmerger
