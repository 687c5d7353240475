#include "firmware_io/s3g/s3g.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "base/error.h"

namespace packmerger::s3g {

namespace {

constexpr std::array<std::uint8_t, 256> make_crc_table() {
  std::array<std::uint8_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned crc = i;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0x8CU : crc >> 1U;
    table[i] = static_cast<std::uint8_t>(crc);
  }
  return table;
}

constexpr std::array<std::uint8_t, 256> kCrcTable = make_crc_table();

std::uint8_t byte_at(std::string_view bytes, std::size_t i) {
  return static_cast<std::uint8_t>(bytes[i]);
}

// Up to and including the terminating zero that must follow the first `fixed` bytes; 0 without one.
std::size_t text_length(std::string_view bytes, std::size_t fixed) {
  const std::size_t end = bytes.find('\0', fixed);
  return end == std::string_view::npos ? 0 : end + 1;
}

// Lengths with the action's code, of the actions that Replicators since 2012 know. 0: unknown.
std::size_t fixed_length(std::uint8_t action) {
  switch (action) {
    case kFindMinimum:
    case kFindMaximum:
      return 8;
    case 0x85:  // delay
    case 0x94:  // wait for a button
    case 0x9E:  // pause at a height
      return 5;
    case kWaitForTool:
    case kWaitForPlatform:
    case 0x92:  // light
    case 0x93:  // beep
      return 6;
    case 0x86:  // change tool
    case 0x89:  // enable or disable axes
    case 0x8F:  // store home position
    case kRecallHome:
    case 0x97:  // song
    case kFactoryReset:
    case kBuildEnd:
    case 0x9C:  // acceleration on or off
      return 2;
    case 0x91:  // motor current
    case 0x96:  // build percentage
      return 3;
    case kMoveTo:
      return 25;
    case kSetPosition:
    case 0x9D:  // x3g version
      return 21;
    case kMoveIn:
      return 26;
    case kMoveAlong:
      return 32;
    default:
      return 0;
  }
}

[[noreturn]] void refuse(std::size_t offset, const std::string& what) {
  throw Error(Fault::kBadInput, "At byte " + std::to_string(offset) + " the x3g program " + what,
              "Make the program again with a converter for this machine, such as gpx.");
}

std::string hex(std::uint8_t value) {
  char text[5];
  std::snprintf(text, sizeof text, "0x%02X", value);
  return text;
}

}  // namespace

std::uint8_t crc8(std::string_view bytes) {
  std::uint8_t crc = 0;
  for (char c : bytes) crc = kCrcTable[crc ^ static_cast<std::uint8_t>(c)];
  return crc;
}

std::string packet(std::string_view payload) {
  std::string bytes;
  bytes.reserve(payload.size() + 3);
  bytes += static_cast<char>(kHeader);
  bytes += static_cast<char>(payload.size());
  bytes += payload;
  bytes += static_cast<char>(crc8(payload));
  return bytes;
}

std::optional<Reply> ReplyReader::next() {
  // No reply to a query of ours is longer; a longer one is a header byte read in mid-packet.
  constexpr std::size_t kMaxReply = 64;
  while (true) {
    const std::size_t start = bytes_.find(static_cast<char>(kHeader));
    bytes_.erase(0, std::min(start, bytes_.size()));
    if (bytes_.size() < 2) return std::nullopt;
    const std::size_t length = byte_at(bytes_, 1);
    if (length == 0 || length > kMaxReply) {
      bytes_.erase(0, 1);
      continue;
    }
    if (bytes_.size() < length + 3) return std::nullopt;
    Reply reply;
    reply.payload = bytes_.substr(2, length);
    reply.intact = crc8(reply.payload) == byte_at(bytes_, length + 2);
    bytes_.erase(0, reply.intact ? length + 3 : 1);
    return reply;
  }
}

std::size_t action_length(std::string_view bytes) {
  if (bytes.empty()) return 0;
  const std::uint8_t action = byte_at(bytes, 0);
  std::size_t length = fixed_length(action);
  if (action == 0x88) length = bytes.size() < 4 ? 0 : 4U + byte_at(bytes, 3);  // tool action
  if (action == 0x95) length = text_length(bytes, 5);                          // message
  if (action == kBuildStart) length = text_length(bytes, 5);
  return length > bytes.size() ? 0 : length;
}

std::size_t checked_action_length(std::string_view program, std::size_t offset) {
  const std::string_view rest = program.substr(offset);
  const std::uint8_t action = byte_at(rest, 0);
  const std::size_t length = action_length(rest);
  const bool known =
      fixed_length(action) > 0 || action == 0x88 || action == 0x95 || action == kBuildStart;
  if (!known) refuse(offset, "holds the unknown action " + hex(action));
  if (action == kFactoryReset) refuse(offset, "would reset the printer to factory settings");
  if (length == 0) refuse(offset, "is cut short in action " + hex(action));
  if (length > kMaxPayload) refuse(offset, "holds an action too long for a packet");
  return length;
}

std::string build_start(std::string_view name) {
  constexpr std::size_t kMaxName = kMaxPayload - 6;
  std::string payload(5, '\0');
  payload[0] = static_cast<char>(kBuildStart);
  for (char c : name.substr(0, kMaxName)) payload += c >= ' ' && c <= '~' ? c : '_';
  payload += '\0';
  return payload;
}

std::string build_end() { return {static_cast<char>(kBuildEnd), '\0'}; }

std::uint32_t read_integer(std::string_view bytes) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < bytes.size() && i < 4; ++i)
    value |= static_cast<std::uint32_t>(byte_at(bytes, i)) << (8 * i);
  return value;
}

}  // namespace packmerger::s3g
