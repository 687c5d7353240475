#include "sim/programs.h"

#include <cstdint>
#include <cstring>

namespace packmerger::test {

namespace {

std::string little_endian(std::uint32_t value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xFFU);
  return text;
}

// A move of 2 mm at 40 mm/s.
std::string move(std::uint32_t x) {
  const float distance_mm = 2;
  std::uint32_t bits = 0;
  std::memcpy(&bits, &distance_mm, sizeof bits);
  return "\x9B" + little_endian(x, 4) + little_endian(50, 4) + little_endian(80, 4) +
         little_endian(0, 4) + little_endian(0, 4) + little_endian(3000, 4) + "\x18" +
         little_endian(bits, 4) + little_endian(40 * 64, 2);
}

}  // namespace

std::vector<std::string> gcode_program(std::size_t commands) {
  std::vector<std::string> lines = {"M104 S199", "M190 S45", "M109 S200", "G28 W", "G92 E0"};
  for (std::size_t i = 0; i < commands; ++i)
    lines.push_back("G1 X" + std::to_string(i) + ".5 Y" + std::to_string(i % 7) + " F6000");
  lines.emplace_back("M84");
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text = "; a program\n\n";
  for (const std::string& line : lines) text += "  " + line + " ; and a comment (\xC2\xB0)\r\n";
  return text;
}

X3gProgram x3g_program(std::size_t moves) {
  std::vector<std::string> actions = {
      std::string("\x99\0\0\0\0test\0", 10),  std::string("\x96\0\0", 3),
      std::string("\x88\0\x03\x02\xDC\0", 6), std::string("\x84\x03\x69\x01\0\0\x14\0", 8),
      std::string("\x87\0\x64\0\xFF\xFF", 6), std::string("\x95\0\0\0\0hello\0", 11)};
  for (std::uint32_t i = 0; i < moves; ++i) actions.push_back(move(1000 + 190 * i));
  actions.push_back(std::string("\x96\x64\0", 3));
  actions.push_back(std::string("\x9A\0", 2));
  X3gProgram program;
  for (const std::string& action : actions) {
    program.bytes += action;
    program.actions.push_back(hex(action));
  }
  return program;
}

std::string hex(const std::string& bytes) {
  std::string text;
  for (char c : bytes) {
    constexpr char kDigits[] = "0123456789abcdef";
    const auto byte = static_cast<unsigned char>(c);
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

}  // namespace packmerger::test
