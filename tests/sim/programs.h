// Programs to print, made by hand: no codec of the links is used.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace packmerger::test {

// "M104 S…", "M109 S…", "G28" and moves, each line different from all others.
std::vector<std::string> gcode_program(std::size_t commands);

std::string joined(const std::vector<std::string>& lines);

struct X3gProgram {
  std::string bytes;
  std::vector<std::string> actions;  // lower-case hex, as the simulated printer records them
};

// A build start, heating, homing, moves, a build end; each action different from all others.
X3gProgram x3g_program(std::size_t moves);

std::string hex(const std::string& bytes);

}  // namespace packmerger::test
