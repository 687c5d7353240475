#include "bench/packing_table/kept_runs.h"

#include <fmt/format.h>

#include <fstream>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/process/process.h"

namespace packmerger::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr double kLongestGit_s = 60;

// What git says, less the end of its last line; nothing where it fails.
std::optional<std::string> git(const fs::path& source, std::vector<std::string> arguments) {
  ProcessSpec spec;
  spec.argv = {"git", "-C", source.string()};
  spec.argv.insert(spec.argv.end(), arguments.begin(), arguments.end());
  try {
    ProcessResult result = run_process(spec, kLongestGit_s, Progress());
    if (!result.status.ok()) return std::nullopt;
    while (!result.out.empty() && result.out.back() == '\n') result.out.pop_back();
    return result.out;
  } catch (const Error&) {  // no git
    return std::nullopt;
  }
}

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  return "unknown";
}

}  // namespace

std::optional<Json> measured_for(const fs::path& source) {
  const auto commit = git(source, {"rev-parse", "HEAD"});
  const auto changed = git(source, {"status", "--porcelain", "--untracked-files=no"});
  if (!commit || !changed || !changed->empty()) return std::nullopt;
  return Json{{"commit", *commit},
              {"program", sha256_hex_of_file(fs::read_symlink("/proc/self/exe"))},
              {"processor", processor_name()},
              {"cores", std::thread::hardware_concurrency()}};
}

KeptRuns::KeptRuns(fs::path folder, std::optional<Json> measured_for)
    : folder_(std::move(folder)), measured_for_(std::move(measured_for)) {
  if (!folder_.empty()) fs::create_directories(folder_);
}

fs::path KeptRuns::file(const std::string& row, const std::string& packer,
                        const Seeds& seeds) const {
  return folder_ / fmt::format("{}.{}.{}.{}.json", row, packer, seeds.instance, seeds.search);
}

std::optional<Json> KeptRuns::find(const std::string& row, const std::string& packer,
                                   const Seeds& seeds) const {
  const fs::path path = file(row, packer, seeds);
  if (folder_.empty() || !measured_for_ || !fs::exists(path)) return std::nullopt;
  const Json kept = Json::parse(read_file(path, kMostBytes), nullptr, false);
  if (kept.is_discarded() || kept.value("measured_for", Json()) != *measured_for_)
    return std::nullopt;
  return kept.at("run");
}

void KeptRuns::keep(const std::string& row, const std::string& packer, const Seeds& seeds,
                    const Json& run) const {
  if (folder_.empty() || !measured_for_) return;
  write_file_whole(file(row, packer, seeds),
                   Json{{"measured_for", *measured_for_}, {"run", run}}.dump(2) + "\n");
}

}  // namespace packmerger::bench
