// What was measured before, so that a long table can be stopped and goes on: a small JSON file for
// each run.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/files.h"

namespace packmerger::bench {

struct Seeds {
  std::uint64_t instance = 1;  // of what is packed
  std::uint64_t search = 1;
};

// What a measurement holds for: the commit of the source tree, the bytes of this program, and the
// machine. Nothing where files of the tree differ from its commit, or where there is none: such
// runs are neither kept nor taken from what is kept.
std::optional<nlohmann::ordered_json> measured_for(const fs::path& source);

class KeptRuns {
 public:
  // folder: made where it is missing; empty: nothing is kept.
  KeptRuns(fs::path folder, std::optional<nlohmann::ordered_json> measured_for);

  std::optional<nlohmann::ordered_json> find(const std::string& row, const std::string& packer,
                                             const Seeds& seeds) const;
  void keep(const std::string& row, const std::string& packer, const Seeds& seeds,
            const nlohmann::ordered_json& run) const;

 private:
  fs::path file(const std::string& row, const std::string& packer, const Seeds& seeds) const;

  fs::path folder_;
  std::optional<nlohmann::ordered_json> measured_for_;
};

}  // namespace packmerger::bench
