#include "daemon/keys/key_ring.h"

#include <openssl/crypto.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/files.h"
#include "base/time/wall_clock.h"
#include "daemon/keys/random_text.h"

namespace packmerger {
namespace {

using nlohmann::json;

constexpr std::size_t kKeyBytes = 32;
constexpr std::size_t kLongestName = 64;
constexpr std::uint64_t kMostBytes = 1 << 20;
constexpr int kMostPages = 20;
constexpr unsigned kOwnerOnly = 0600;  // the file's mode

std::string page_name(int number) { return "page " + std::to_string(number); }

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
    const bool looks = key.contains("may");  // of this one's values "look" is the only one yet
    keys_.push_back({key["name"], key["sha256"], key["made_s"], looks});
  }
}

void KeyRing::keep(std::vector<WebKey> keys) {
  json list = json::array();
  for (const WebKey& key : keys) {
    list.push_back({{"name", key.name}, {"sha256", key.sha256}, {"made_s", key.made_s}});
    if (key.looks_only) list.back()["may"] = "look";
  }
  write_file_whole(file_, list.dump(2) + "\n", kOwnerOnly);
  keys_ = std::move(keys);
}

std::string KeyRing::keep_with(std::vector<WebKey> keys, const std::string& name,
                               const std::string& beginning, bool looks_only) {
  const std::string text = beginning + random_text(kKeyBytes);
  keys.push_back({name, sha256_hex(text), unix_now_s(), looks_only});
  keep(std::move(keys));
  return text;
}

std::string KeyRing::add(const std::string& name) {
  if (!is_name(name))
    throw Error(Fault::kUsage, "A key's name has letters, digits, spaces, '-', '_' and '.'",
                "Name it after the program or person that will use it.");
  const std::lock_guard lock(mutex_);
  for (const WebKey& key : keys_)
    if (key.name == name)
      throw Error(Fault::kUsage, "There is a key named " + name + " already",
                  "Revoke it first, or choose another name.");
  return keep_with(keys_, name, "pm_", false);
}

std::optional<std::string> KeyRing::look(std::string_view code, double now_s) {
  if (!codes_.take(code, now_s)) return std::nullopt;
  const std::lock_guard lock(mutex_);
  std::vector<WebKey> keys = keys_;
  const auto is_page = [](const WebKey& key) { return key.looks_only; };
  if (std::count_if(keys.begin(), keys.end(), is_page) >= kMostPages)
    keys.erase(std::find_if(keys.begin(), keys.end(), is_page));
  int number = 0;
  const auto is_taken = [&](const WebKey& key) { return key.name == page_name(number); };
  do ++number;
  while (std::any_of(keys.begin(), keys.end(), is_taken));
  return keep_with(std::move(keys), page_name(number), "pm_look_", true);
}

void KeyRing::revoke(const std::string& name) {
  const std::lock_guard lock(mutex_);
  std::vector<WebKey> keys = keys_;
  if (std::erase_if(keys, [&](const WebKey& key) { return key.name == name; }) == 0)
    throw Error(Fault::kNoInput, "There is no such key", "packmerger keys list shows them.");
  keep(std::move(keys));
}

bool KeyRing::empty() const {
  const std::vector<WebKey> keys = list();
  return std::all_of(keys.begin(), keys.end(), [](const WebKey& key) { return key.looks_only; });
}

std::vector<WebKey> KeyRing::list() const {
  const std::lock_guard lock(mutex_);
  return keys_;
}

std::optional<WebKey> KeyRing::find(std::string_view text) const {
  const std::string hash = sha256_hex(text);
  std::optional<WebKey> found;
  for (const WebKey& key : list())
    if (key.sha256.size() == hash.size() &&
        CRYPTO_memcmp(key.sha256.data(), hash.data(), hash.size()) == 0)
      found = key;
  return found;
}

}  // namespace packmerger
