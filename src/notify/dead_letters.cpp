#include "notify/dead_letters.h"

#include <fcntl.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "base/descriptor.h"
#include "base/time/wall_clock.h"

namespace packmerger {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;

}  // namespace

bool DeadLetters::keep(const std::string& to, const std::string& why, const std::string& body) {
  using nlohmann::json;
  const json line = {{"at_s", unix_now_s()},
                     {"to", to},
                     {"why", why},
                     {"message", json::parse(body, nullptr, false)}};
  const std::string text = line.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(mutex_);
  std::error_code ignored;
  const std::uintmax_t size = std::filesystem::file_size(file_, ignored);
  if (!ignored && size + text.size() > kMostBytes)
    std::filesystem::rename(file_, file_.string() + ".old", ignored);
  const Descriptor file(::open(file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600));
  return ::write(file.get(), text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

}  // namespace packmerger
