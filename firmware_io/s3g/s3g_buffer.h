// What the printer's buffer may hold: actions leave it whole and in order, so how full it is tells
// what it was given.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

namespace packmerger::s3g {

class Buffer {
 public:
  // The printer said that its buffer is empty, and then how much is free in it.
  void emptied(std::uint32_t free_bytes);

  // An action of this length is in it, for certain.
  void add(std::size_t length);

  // So much is free, and all that was given to it is certain.
  void observe(std::uint32_t free_bytes);

  // How many actions are still in it where so much is free; nothing where that cannot be.
  std::optional<std::size_t> actions(std::uint32_t free_bytes) const;

  // So much is free, and it is not known whether an action of this length was taken behind the
  // others: true or false where only one of the two leaves so much.
  std::optional<bool> tells(std::uint32_t free_bytes, std::size_t length) const;

 private:
  bool may_hold(std::size_t bytes, std::size_t last) const;

  std::size_t capacity_ = 0;         // 0: never seen empty
  std::deque<std::size_t> lengths_;  // of what may still be in it, oldest first
  std::size_t bytes_ = 0;            // their sum
};

}  // namespace packmerger::s3g
