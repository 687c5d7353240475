#include "daemon/keys/random_text.h"

#include <openssl/rand.h>

#include <string_view>
#include <vector>

#include "base/error.h"

namespace packmerger {

std::string random_text(std::size_t count) {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::vector<unsigned char> bytes(count);
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw Error(Fault::kInternal, "The system gives no random numbers", "Try again.");
  std::string text;
  unsigned held = 0;
  int bits = 0;
  for (const unsigned char byte : bytes) {
    held = held << 8 | byte;
    for (bits += 8; bits >= 6; bits -= 6) text += kLetters[held >> (bits - 6) & 63];
  }
  return bits > 0 ? text + kLetters[held << (6 - bits) & 63] : text;
}

}  // namespace packmerger
