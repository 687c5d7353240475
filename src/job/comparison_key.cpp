#include "job/comparison_key.h"

#include <fmt/format.h>

#include "base/files.h"
#include "base/process/process.h"

namespace packmerger {
namespace {

// Whatever a build's number says. An upgrade may lay others in these places while this one runs.
std::string own_sha256() {
  static const std::string sha256 = sha256_hex_of_file("/proc/self/exe");
  return sha256;
}

std::string sha256_if_there(const fs::path& program) {
  std::error_code ignored;
  return fs::is_regular_file(program, ignored) ? sha256_hex_of_file(program) : "";
}

// Its figures are the slicer's, whose bytes count then.
std::string slicer_sha256(const Profile& profile) {
  if (!profile.is_sliced()) return "";
  const std::optional<fs::path> slicer = program_in_path("prusa-slicer");
  return slicer ? sha256_hex_of_file(*slicer) : "";
}

}  // namespace

std::string comparison_sha256(const Profile& profile, const PlanOptions& options,
                              const std::vector<JobInput>& inputs) {
  const Sizing& sizing = options.sizing;
  std::string text =
      fmt::format("program {}\nTetGen {}\nslicer {}\n", own_sha256(),
                  sha256_if_there(helper_program("packmerger-tetgen")), slicer_sha256(profile));
  text += fmt::format("unit {} scale {} size {}\n", sizing.unit_mm, sizing.scale,
                      sizing.size_mm.value_or(0));
  text += fmt::format("split {} hollow {} seed {} budget {}\n", options.split, options.hollow,
                      options.seed, options.budget_s);
  for (const JobInput& input : inputs)  // its ending says how it is read, warnings name it
    text += fmt::format("model {} {}\n", input.sha256, sha256_hex(input.file));
  return sha256_hex(text + profile_toml(profile));
}

}  // namespace packmerger
