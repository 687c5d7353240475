#include "job/prepare.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "job/plan_known.h"
#include "job/promises.h"
#include "job/timings.h"
#include "printers/estimate/packing_cost.h"
#include "printers/program/program.h"
#include "tray/write_job_folder.h"

namespace packmerger {
namespace {

std::string other_way(const Comparison& ways) {
  const std::optional<Variant> best = cheapest(ways);
  return best ? fmt::format(" Or use --variant {}.", variant_name(*best)) : "";
}

Arrangement take(Plan& plan, Variant variant) {
  std::optional<Arrangement>& way = variant == Variant::kSolid    ? plan.solid
                                    : variant == Variant::kHollow ? plan.hollow
                                                                  : plan.packed;
  if (way) return std::move(*way);
  const Comparison& ways = plan.job.estimates;
  if (const auto refused = ways.refused.find(variant_name(variant)); refused != ways.refused.end())
    throw Error(Fault::kBadInput, refused->second.what, refused->second.hint + other_way(ways));
  if (variant == Variant::kPacked && plan.not_packed) throw *plan.not_packed;
  throw Error(Fault::kBadInput, "The model does not fit the printer in one piece",
              "Use --variant packed, which divides it into parts that fit.");
}

// Whatever way was chosen: nothing is written that breaks a promise.
void prove(const Arrangement& arrangement, const Profile& profile, const Progress& progress) {
  progress.report("proving", 0);
  if (const auto broken =
          broken_promise(arrangement, profile.pack.gap_mm, whole_room(profile), progress))
    throw Error(Fault::kInternal, broken->what,
                "Nothing was written. Try another --seed or --variant, and report this model.");
}

Variant decide(Variant wanted, const Plan& plan) {
  if (wanted != Variant::kCheapest) return wanted;
  return cheapest(plan.job.estimates).value_or(Variant::kPacked);
}

void record(Job& job, Arrangement arrangement, const std::vector<Tray>& trays) {
  const Cost cost = packing_cost(job.profile);
  for (const Tray& tray : trays) {
    const TrayMeasure measured = measure(tray, job.profile);
    job.cost += cost.evaluate(measured);
    job.bbox_mm3 += measured.size_mm.prod();
    job.support_mm3 += measured.support_mm3;
    job.height_mm = std::max(job.height_mm, measured.size_mm.z());
  }
  // What is packed was cut from the shell, whose volume checks the cuts; anything else is printed
  // uncut, and is no shell where the variant is solid.
  if (job.variant != variant_name(Variant::kPacked)) {
    job.shell_volume_mm3 = 0;
    for (const JobPart& part : arrangement.parts) job.shell_volume_mm3 += part.volume_mm3;
  }
  job.final_segments = static_cast<int>(arrangement.parts.size());
  job.parts = std::move(arrangement.parts);
  job.removal_order = std::move(arrangement.removal_order);
  job.removal_paths = std::move(arrangement.removal_paths);
}

// Cavities trap nothing where the model is solid or open, and thin features are hard to assemble
// only where there is something to assemble. A warning does not tell its model.
void forget_what_does_not_apply(Job& job) {
  std::set<int> whole;
  for (const JobPart& part : job.parts)
    if (part.neighbours.empty()) whole.insert(part.model);
  const bool is_any_cut = std::any_of(job.parts.begin(), job.parts.end(), [&](const JobPart& part) {
    return !whole.contains(part.model);
  });
  const bool is_solid = job.variant == variant_name(Variant::kSolid);
  std::erase_if(job.warnings, [&](const Warning& warning) {
    return (warning.code == "sealed_cavity" && (is_solid || whole.empty())) ||
           (warning.code == "thin_features" && !is_any_cut);
  });
}

std::vector<TrayFiles> programs(Job& job, const std::vector<Tray>& trays,
                                const Progress& progress) {
  std::vector<TrayFiles> files;
  for (std::size_t i = 0; i < trays.size(); ++i) {
    if (job.profile.is_sliced())
      progress.report("slicing", static_cast<double>(i) / static_cast<double>(trays.size()));
    std::string name = std::filesystem::path(job.inputs.front().file).stem().string();
    if (trays.size() > 1) name += "-" + std::to_string(i + 1);
    std::optional<Program> program = make_program(job.profile, trays[i], name, progress);
    TrayFiles tray;
    if (program) {
      tray.program_extension = program->extension;
      tray.program = std::move(program->bytes);
      job.warnings.insert(job.warnings.end(), program->warnings.begin(), program->warnings.end());
    }
    files.push_back(std::move(tray));
  }
  return files;
}

}  // namespace

Job prepare(const Profile& profile, const PlanOptions& options, Variant variant,
            const std::filesystem::path& out, const Progress& progress,
            const std::optional<KnownWays>& known) {
  check_job_folder(out);
  std::optional<Plan> of_known;
  if (known) of_known = plan_known(profile, options, *known, variant, progress);
  Plan planned = of_known ? std::move(*of_known) : plan(profile, options, progress);
  const Variant chosen = decide(variant, planned);
  Arrangement arrangement = take(planned, chosen);
  const std::vector<Tray> trays = trays_of(arrangement);
  timed(planned.job.timings_s, "prove", [&] { prove(arrangement, profile, progress); });

  Job job = std::move(planned.job);
  job.variant = variant_name(chosen);
  const Advice advised = advice(job.estimates);
  if (advised.variant) job.advised = variant_name(*advised.variant);
  job.advice = advised.text;
  record(job, std::move(arrangement), trays);
  forget_what_does_not_apply(job);
  const std::vector<TrayFiles> files =
      timed(job.timings_s, "program", [&] { return programs(job, trays, progress); });
  write_job_folder(job, files, out, progress);
  return job;
}

}  // namespace packmerger
