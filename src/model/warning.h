// What the user should know about a job although it went on.
#pragma once

#include <string>
#include <vector>

namespace packmerger {

struct Warning {
  std::string code;  // stable, snake_case, listed in docs/JOB_FOLDER: "sealed_cavity"
  std::string text;  // one plain sentence with the figures
};

using Warnings = std::vector<Warning>;

}  // namespace packmerger
