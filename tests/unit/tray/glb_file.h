// GLB files read again, and judged by the Khronos validator.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/process/process.h"

namespace packmerger {

using Json = nlohmann::json;

struct Glb {
  Json json;
  std::string binary;
};

inline Glb read_glb(const std::string& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(4), 2U);
  EXPECT_EQ(word(8), bytes.size());
  const std::size_t length = word(12);
  Glb glb;
  glb.json = Json::parse(bytes.substr(20, length));
  glb.binary = bytes.substr(20 + length + 8);
  return glb;
}

inline constexpr const char* kNoValidator =
    "node_modules/gltf-validator is missing: run `npm ci` in the source tree";

inline fs::path source_tree() {
  const char* told = std::getenv("PACKMERGER_SOURCE");
  return fs::absolute(told == nullptr ? "." : told);
}

// Where the validator lies; empty where it is not installed.
inline fs::path node_packages() {
  const fs::path packages = source_tree() / "node_modules";
  return fs::exists(packages / "gltf-validator") ? packages : fs::path();
}

// One report for each file.
inline Json validated(const fs::path& packages, const std::vector<fs::path>& files) {
  ProcessSpec spec;
  spec.argv = {"node", (source_tree() / "tests/unit/tray/validate_glb.js").string(),
               packages.string()};
  for (const fs::path& file : files) spec.argv.push_back(file.string());
  const ProcessResult result = run_process(spec, 60, Progress());
  EXPECT_TRUE(result.status.ok()) << result.err;
  return Json::parse(result.out);
}

}  // namespace packmerger
