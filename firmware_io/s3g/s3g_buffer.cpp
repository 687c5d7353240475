#include "firmware_io/s3g/s3g_buffer.h"

namespace packmerger::s3g {

void Buffer::emptied(std::uint32_t free_bytes) {
  capacity_ = free_bytes;
  lengths_.clear();
  bytes_ = 0;
}

void Buffer::add(std::size_t length) {
  if (capacity_ == 0) return;
  lengths_.push_back(length);
  bytes_ += length;
  while (bytes_ > capacity_) {  // the oldest must have left it
    bytes_ -= lengths_.front();
    lengths_.pop_front();
  }
}

void Buffer::observe(std::uint32_t free_bytes) {
  if (capacity_ == 0) return;
  while (!lengths_.empty() && bytes_ + free_bytes > capacity_) {
    bytes_ -= lengths_.front();
    lengths_.pop_front();
  }
  // It holds what it was not given, or has grown: it tells nothing until it is seen empty again.
  if (bytes_ + free_bytes != capacity_) capacity_ = 0;
}

std::optional<std::size_t> Buffer::actions(std::uint32_t free_bytes) const {
  std::size_t left = bytes_;
  std::size_t count = lengths_.size();
  for (const std::size_t length : lengths_) {
    if (left + free_bytes == capacity_) return count;
    left -= length;
    --count;
  }
  if (left + free_bytes == capacity_) return count;
  return std::nullopt;
}

std::optional<bool> Buffer::tells(std::uint32_t free_bytes, std::size_t length) const {
  if (free_bytes > capacity_) return std::nullopt;
  const std::size_t held = capacity_ - free_bytes;
  const bool without = may_hold(held, 0);
  const bool with = may_hold(held, length);
  if (with == without) return std::nullopt;
  return with;
}

// Whether `bytes` are left of the lengths, and of `last` behind them, once some have gone.
bool Buffer::may_hold(std::size_t bytes, std::size_t last) const {
  std::size_t left = bytes_ + last;
  if (left == bytes) return true;
  for (const std::size_t length : lengths_) {
    left -= length;
    if (left == bytes) return true;
  }
  return bytes == 0;
}

}  // namespace packmerger::s3g
