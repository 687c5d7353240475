#include "daemon/keys/look_codes.h"

#include "base/files.h"
#include "daemon/keys/random_text.h"

namespace packmerger {
namespace {

constexpr std::size_t kCodeBytes = 16;
constexpr std::size_t kMostCodes = 8;

}  // namespace

std::string LookCodes::add(double now_s) {
  const std::string code = random_text(kCodeBytes);
  const std::lock_guard lock(mutex_);
  if (codes_.size() >= kMostCodes) codes_.erase(codes_.begin());
  codes_.push_back({sha256_hex(code), now_s + kGoodFor_s});
  return code;
}

// What is compared is a hash, so how long it takes tells nothing about the code.
bool LookCodes::take(std::string_view code, double now_s) {
  const std::string hash = sha256_hex(code);
  const std::lock_guard lock(mutex_);
  return std::erase_if(codes_, [&](const Code& known) {
           return known.sha256 == hash && known.until_s > now_s;
         }) > 0;
}

}  // namespace packmerger
