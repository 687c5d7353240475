#include "tray/write_job_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "model/stl.h"
#include "picture/gltf.h"
#include "picture/part_colour.h"
#include "picture/preview.h"
#include "tray/job_json.h"
#include "tray/three_mf.h"

namespace packmerger {
namespace {

// What is written for one tray needs its parts twice: as they are, and where they stand.
struct TrayContent {
  std::vector<const JobPart*> parts;
  std::vector<Mesh> placed;  // tray coordinates, same order
};

[[noreturn]] void contradiction(const std::string& what) {
  throw Error(Fault::kInternal, "The job contradicts itself: " + what,
              "Please report this together with the model.");
}

void check(const Job& job, std::size_t trays) {
  if (job.parts.empty()) contradiction("it has no parts");
  std::set<int> ids;
  std::set<int> used;
  for (const JobPart& part : job.parts) {
    if (part.id < 1 || !ids.insert(part.id).second) contradiction("two parts have one id");
    if (part.tray < 1 || static_cast<std::size_t>(part.tray) > trays)
      contradiction("a part lies on a tray that is not there");
    if (part.model < 0 || static_cast<std::size_t>(part.model) >= job.inputs.size())
      contradiction("a part belongs to no input");
    used.insert(part.tray);
  }
  if (used.size() != trays) contradiction("a tray is empty");
}

std::vector<TrayContent> contents(const Job& job, std::size_t trays) {
  std::vector<TrayContent> all(trays);
  for (const JobPart& part : job.parts) {
    TrayContent& tray = all[static_cast<std::size_t>(part.tray) - 1];
    tray.parts.push_back(&part);
    tray.placed.push_back(transformed(part.surface, part.pose));
  }
  return all;
}

std::string part_name(const JobPart& part) { return fmt::format("part {:02}", part.id); }

void write_tray(const TrayContent& tray, int number, const fs::path& folder) {
  std::vector<const Mesh*> placed;
  std::vector<ThreeMfPart> objects;
  for (std::size_t i = 0; i < tray.parts.size(); ++i) {
    const JobPart& part = *tray.parts[i];
    placed.push_back(&tray.placed[i]);
    objects.push_back({part_name(part), &part.surface, part.pose, part_colour(part.id - 1)});
    write_file_whole(folder / part_file(part.id), binary_stl({&tray.placed[i]}));
  }
  write_file_whole(folder / tray_file("tray", number, "stl"), binary_stl(placed));
  write_file_whole(folder / tray_file("tray", number, "3mf"), three_mf_bytes(objects));
}

// Trays after the first stand to its right, a tenth of a plate apart.
std::string preview_glb(const Job& job) {
  std::vector<GltfPart> parts;
  for (const JobPart& part : job.parts) {
    const double aside = 1.1 * job.profile.build_mm[0] * (part.tray - 1);
    parts.push_back(
        {part_name(part), &part.surface, part.pose, part_colour(part.id - 1), Vec3(aside, 0, 0)});
  }
  return glb_bytes(parts);
}

// Models after the first stand to its right, so that copies do not hide each other.
std::string assembly_glb(const Job& job) {
  std::vector<Box3> boxes(job.inputs.size());
  for (const JobPart& part : job.parts)
    boxes[static_cast<std::size_t>(part.model)].extend(bounding_box(part.surface));
  std::vector<double> aside(boxes.size(), 0);
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    const Box3& before = boxes[i - 1];
    const double apart = 0.1 * std::max(before.sizes().x(), boxes[i].sizes().x());
    aside[i] = aside[i - 1] + before.max().x() - boxes[i].min().x() + apart;
  }
  std::vector<GltfPart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({part_name(part), &part.surface, Pose::Identity(), part_colour(part.id - 1),
                     Vec3(aside[static_cast<std::size_t>(part.model)], 0, 0)});
  return glb_bytes(parts);
}

}  // namespace

void check_job_folder(const fs::path& out) {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(out, ignored))) return;
  throw Error(Fault::kCannotWrite, fmt::format("\"{}\" is there already", out.string()),
              "Name a folder that does not exist yet, or remove this one first.");
}

void write_job_folder(const Job& job, const std::vector<TrayFiles>& trays, const fs::path& out,
                      const Progress& progress) {
  check(job, trays.size());
  check_job_folder(out);
  TemporaryFolder folder = TemporaryFolder::beside(out);
  fs::create_directory(folder.path() / "parts");

  const double steps = static_cast<double>(trays.size()) + 2;
  const std::vector<TrayContent> all = contents(job, trays.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    progress.report("writing", static_cast<double>(i) / steps);
    const int number = static_cast<int>(i) + 1;
    write_tray(all[i], number, folder.path());
    if (trays[i].program_extension)
      write_file_whole(folder.path() / tray_file("program", number, *trays[i].program_extension),
                       trays[i].program);
  }
  progress.report("writing", (steps - 2) / steps);
  write_file_whole(folder.path() / "preview.glb", preview_glb(job));
  write_file_whole(folder.path() / "assembly.glb", assembly_glb(job));
  progress.report("writing", (steps - 1) / steps);
  write_file_whole(folder.path() / "preview.png", png_bytes(preview_picture(job)));
  write_file_whole(folder.path() / "profile.toml", profile_toml(job.profile));
  write_file_whole(folder.path() / "job.json", json_text(job_json(job)));
  progress.report("writing", 1);
  folder.publish(out);
}

}  // namespace packmerger
