// Little-endian integers in the packets of the simulated Replicator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace packmerger::simulated {

using Bytes = std::basic_string<std::uint8_t>;

inline Bytes little_endian(std::uint32_t value, int bytes) {
  Bytes result;
  for (int i = 0; i < bytes; ++i) result += static_cast<std::uint8_t>(value >> (8 * i));
  return result;
}

// What lies behind the end reads as zero.
inline std::uint32_t u32(const Bytes& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (at + i < bytes.size()) value |= static_cast<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

inline std::uint16_t u16(const Bytes& bytes, std::size_t at) {
  return static_cast<std::uint16_t>(u32(bytes, at) & 0xFFFFU);
}

}  // namespace packmerger::simulated
