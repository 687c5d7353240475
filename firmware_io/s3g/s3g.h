// The bytes of s3g, the MakerBot protocol, after its published specification and the Sailfish
// source: packets with checksums, and the actions that an x3g file is made of. No port is known
// here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace packmerger::s3g {

inline constexpr std::uint8_t kHeader = 0xD5;
inline constexpr std::size_t kMaxPayload = 32;

// Queries: answered at once.
enum Query : std::uint8_t {
  kVersion = 0x00,
  kInit = 0x01,
  kFreeBuffer = 0x02,
  kAbort = 0x07,
  kPause = 0x08,  // and go on: it toggles
  kToolQuery = 0x0A,
  kIsFinished = 0x0B,
  kPosition = 0x15,
  kBoardStatus = 0x17,
  kBuildStatistics = 0x18,
  kAdvancedVersion = 0x1B
};

// Actions that a link must know by name; all are buffered and executed in order.
enum Action : std::uint8_t {
  kFindMinimum = 0x83,
  kFindMaximum = 0x84,
  kDelay = 0x85,
  kWaitForTool = 0x87,
  kMoveTo = 0x8B,  // at a rate
  kSetPosition = 0x8C,
  kWaitForPlatform = 0x8D,
  kRecallHome = 0x90,
  kFactoryReset = 0x98,
  kBuildStart = 0x99,
  kBuildEnd = 0x9A,
  kMoveIn = 0x8E,    // a time
  kMoveAlong = 0x9B  // a way at a speed
};

enum Response : std::uint8_t {
  kGenericError = 0x80,  // a byte outside a packet; repeated without end until a packet comes
  kOk = 0x81,
  kBufferFull = 0x82,  // the action was dropped whole
  kChecksumMismatch = 0x83,
  kTooLong = 0x84,  // no packet of ours is: its length was damaged on the way
  kUnknownQuery = 0x85,
  kCancelled = 0x89,  // at the printer's panel
  kBuildingFromCard = 0x8A,
  kOverheated = 0x8B,
  kPacketTimeout = 0x8C  // a packet that did not come to its end
};

enum class BuildState : std::uint8_t {
  kNone = 0,
  kRunning = 1,
  kFinished = 2,
  kPaused = 3,
  kCancelled = 4,
  kCancelling = 5
};

// Dallas/Maxim iButton CRC-8: polynomial x^8 + x^5 + x^4 + 1 reflected, start value 0.
std::uint8_t crc8(std::string_view bytes);

// Header, length, payload, checksum. payload: at most kMaxPayload bytes.
std::string packet(std::string_view payload);

struct Reply {
  bool intact = true;   // the checksum was right
  std::string payload;  // a response code and what it brings
  std::uint8_t code() const { return static_cast<std::uint8_t>(payload[0]); }
};

// Finds replies in a stream of bytes; what lies outside a packet is passed over.
class ReplyReader {
 public:
  void push(std::string_view bytes) { bytes_ += bytes; }
  std::optional<Reply> next();
  // Drops what was read, half a packet included.
  void clear() { bytes_.clear(); }

 private:
  std::string bytes_;
};

// The length of the action that `bytes` begins with; 0 for an action that is unknown or cut short.
std::size_t action_length(std::string_view bytes);

// The same of the action at `offset`, which lies in the program. Throws Error{kBadInput} as
// check_x3g() promises.
std::size_t checked_action_length(std::string_view program, std::size_t offset);

// Payload of a build start; the name is cut to what a packet holds.
std::string build_start(std::string_view name);
std::string build_end();

// Little-endian integers of 1 to 4 bytes.
std::uint32_t read_integer(std::string_view bytes);

}  // namespace packmerger::s3g
