#include "job/comparison_key.h"

#include <fmt/format.h>

#include "base/files.h"
#include "base/process.h"

namespace packmerger {
namespace {

// Its figures are the slicer's, whose bytes count then.
std::string slicer_sha256(const Profile& profile) {
  if (!profile.is_sliced()) return "";
  const std::optional<fs::path> slicer = program_in_path("prusa-slicer");
  return slicer ? sha256_hex_of_file(*slicer) : "";
}

}  // namespace

std::string comparison_sha256(const Profile& profile, const PlanOptions& options,
                              const std::vector<std::string>& model_sha256) {
  const Sizing& sizing = options.sizing;
  std::string text =
      fmt::format("PackMerger {}\nslicer {}\nunit {} scale {} size {}\n", PACKMERGER_VERSION,
                  slicer_sha256(profile), sizing.unit_mm, sizing.scale, sizing.size_mm.value_or(0));
  text += fmt::format("split {} hollow {} seed {} budget {}\n", options.split, options.hollow,
                      options.seed, options.budget_s);
  for (const std::string& sha256 : model_sha256) text += "model " + sha256 + "\n";
  return sha256_hex(text + profile_toml(profile));
}

}  // namespace packmerger
