#include "daemon/key_ring.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "daemon/foreman.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kLongestName = 64;
constexpr std::uint64_t kMostBytes = 1 << 20;

std::string random_key() {
  constexpr std::string_view kLetters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::array<unsigned char, kKeyBytes> bytes;
  if (RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) != 1)
    throw Error(Fault::kInternal, "The system gives no random numbers", "Try again.");
  std::string text = "pm_";
  unsigned held = 0;
  int bits = 0;
  for (const unsigned char byte : bytes) {
    held = held << 8 | byte;
    for (bits += 8; bits >= 6; bits -= 6) text += kLetters[held >> (bits - 6) & 63];
  }
  return text + kLetters[held << (6 - bits) & 63];
}

bool is_name(std::string_view name) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_. ").find(c) != std::string_view::npos;
  };
  return !name.empty() && name.size() <= kLongestName &&
         std::all_of(name.begin(), name.end(), fits);
}

}  // namespace

KeyRing::KeyRing(std::filesystem::path file) : file_(std::move(file)) {
  std::error_code ignored;
  if (!fs::exists(file_, ignored)) return;
  const json keys = json::parse(read_file(file_, kMostBytes), nullptr, false);
  const auto damaged = [&] {
    throw Error(Fault::kIo, "The list of keys is damaged: " + file_.string(),
                "Remove it and add the keys again with packmerger keys add NAME.");
  };
  if (!keys.is_array()) damaged();
  for (const json& key : keys) {
    if (!key.is_object() || !key.contains("name") || !key["name"].is_string() ||
        !key.contains("sha256") || !key["sha256"].is_string() || !key.contains("made_s") ||
        !key["made_s"].is_number())
      damaged();
    keys_.push_back({key["name"], key["sha256"], key["made_s"]});
  }
}

void KeyRing::save(const std::vector<WebKey>& keys) const {
  json list = json::array();
  for (const WebKey& key : keys)
    list.push_back({{"name", key.name}, {"sha256", key.sha256}, {"made_s", key.made_s}});
  write_file_whole(file_, list.dump(2) + "\n");
}

std::string KeyRing::add(const std::string& name) {
  if (!is_name(name))
    throw Error(Fault::kUsage, "A key's name has letters, digits, spaces, '-', '_' and '.'",
                "Name it after the program or person that will use it.");
  const std::lock_guard lock(mutex_);
  std::vector<WebKey> keys = keys_;
  for (const WebKey& key : keys)
    if (key.name == name)
      throw Error(Fault::kUsage, "There is a key named " + name + " already",
                  "Revoke it first, or choose another name.");
  const std::string text = random_key();
  keys.push_back({name, sha256_hex(text), wall_clock_s()});
  save(keys);
  keys_ = std::move(keys);
  return text;
}

void KeyRing::revoke(const std::string& name) {
  const std::lock_guard lock(mutex_);
  std::vector<WebKey> keys = keys_;
  if (std::erase_if(keys, [&](const WebKey& key) { return key.name == name; }) == 0)
    throw Error(Fault::kNoInput, "There is no such key", "packmerger keys list shows them.");
  save(keys);
  keys_ = std::move(keys);
}

std::vector<WebKey> KeyRing::list() const {
  const std::lock_guard lock(mutex_);
  return keys_;
}

std::optional<std::string> KeyRing::owner(std::string_view text) const {
  const std::string hash = sha256_hex(text);
  std::optional<std::string> owner;
  for (const WebKey& key : list())
    if (key.sha256.size() == hash.size() &&
        CRYPTO_memcmp(key.sha256.data(), hash.data(), hash.size()) == 0)
      owner = key.name;
  return owner;
}

}  // namespace packmerger
