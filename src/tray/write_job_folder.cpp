#include "tray/write_job_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <set>

#include "base/error.h"
#include "base/parallel.h"
#include "model/files/job_folder_names.h"
#include "model/stl.h"
#include "picture/gltf.h"
#include "picture/page_scene.h"
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

using Writes = std::vector<std::function<void()>>;

// tray and folder must outlive what is added to writes.
void add_tray(const TrayContent& tray, int number, const fs::path& folder, Writes& writes) {
  for (std::size_t i = 0; i < tray.parts.size(); ++i)
    writes.emplace_back([&tray, &folder, i] {
      write_file_whole(folder / part_file(tray.parts[i]->id), binary_stl({&tray.placed[i]}));
    });
  writes.emplace_back([&tray, &folder, number] {
    std::vector<const Mesh*> placed;
    for (const Mesh& part : tray.placed) placed.push_back(&part);
    write_file_whole(folder / tray_file(kTrayStem, number, "stl"), binary_stl(placed));
  });
  writes.emplace_back([&tray, &folder, number] {
    std::vector<ThreeMfPart> objects;
    for (const JobPart* part : tray.parts)
      objects.push_back({part_name(*part), &part->surface, part->pose, part_colour(part->id - 1)});
    write_file_whole(folder / tray_file(kTrayStem, number, "3mf"), three_mf_bytes(objects));
  });
}

// Trays after the first stand to its right, a tenth of a plate apart.
Vec3 aside_on_tray(const Job& job, const JobPart& part) {
  return {1.1 * job.profile.build_mm[0] * (part.tray - 1), 0, 0};
}

// Models after the first stand to its right, so that copies do not hide each other.
std::vector<Vec3> models_aside(const Job& job) {
  std::vector<Box3> boxes(job.inputs.size());
  for (const JobPart& part : job.parts)
    boxes[static_cast<std::size_t>(part.model)].extend(bounding_box(part.surface));
  std::vector<Vec3> aside(boxes.size(), Vec3::Zero());
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    const Box3& before = boxes[i - 1];
    const double apart = 0.1 * std::max(before.sizes().x(), boxes[i].sizes().x());
    aside[i].x() = aside[i - 1].x() + before.max().x() - boxes[i].min().x() + apart;
  }
  return aside;
}

std::string preview_glb(const Job& job) {
  std::vector<GltfPart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({part_name(part), &part.surface, part.pose, part_colour(part.id - 1),
                     aside_on_tray(job, part)});
  return glb_bytes(parts);
}

std::string assembly_glb(const Job& job) {
  const std::vector<Vec3> aside = models_aside(job);
  std::vector<GltfPart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({part_name(part), &part.surface, Pose::Identity(), part_colour(part.id - 1),
                     aside[static_cast<std::size_t>(part.model)]});
  return glb_bytes(parts);
}

std::string page_scene(const Job& job) {
  const std::vector<Vec3> aside = models_aside(job);
  std::vector<PagePart> parts;
  for (const JobPart& part : job.parts)
    parts.push_back({part.id, &part.surface, part.pose, aside_on_tray(job, part),
                     aside[static_cast<std::size_t>(part.model)], part_colour(part.id - 1)});
  return page_glb(parts);
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
  fs::create_directory(folder.path() / kPartsFolder);

  const std::vector<TrayContent> all = contents(job, trays.size());
  Writes writes{
      [&] { write_file_whole(folder.path() / kPictureFile, png_bytes(preview_picture(job))); },
      [&] { write_file_whole(folder.path() / kPreviewScene, preview_glb(job)); },
      [&] { write_file_whole(folder.path() / kAssemblyScene, assembly_glb(job)); },
      [&] { write_file_whole(folder.path() / kPageScene, page_scene(job)); },
      [&] { write_file_whole(folder.path() / kProfileFile, profile_toml(job.profile)); },
      [&] { write_file_whole(folder.path() / kReportFile, report_text(job_json(job))); }};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    add_tray(all[i], number, folder.path(), writes);
    if (!trays[i].program_extension) continue;
    writes.emplace_back([&, i, number] {
      write_file_whole(folder.path() / tray_file(kProgramStem, number, *trays[i].program_extension),
                       trays[i].program);
    });
  }
  std::atomic<std::size_t> written = 0;
  progress.report("writing", 0);
  parallel_tasks(writes.size(), [&](std::size_t i) {
    writes[i]();
    progress.report("writing", static_cast<double>(++written) / static_cast<double>(writes.size()));
  });
  folder.publish(out);
}

}  // namespace packmerger
