// What changed, told to every browser that watches: the newest state counts, older ones may be
// left out.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/queue.h"

namespace packmerger {

// Thread-safe.
class WebEvents {
 public:
  // The loop tells the state as JSON text. Who was told the same last is not told again.
  void publish(std::string state);
  // Readable while a stream waits for its first state, which is then wanted at once: what was
  // published before it began may be old.
  int fd() const { return begun_.fd(); }
  // Whether one does; then not again until the next begins.
  bool take_begun();
  // Whether somebody watches, so that the loop need not make a text for nobody.
  bool watched() const;
  void end_streams();  // ends those there are
  void close();        // and lets none begin

  // A stream of server-sent events for one client: the state now, then every change, and a comment
  // after ten quiet seconds, so that a client that went away is noticed. Nothing where too many
  // watch already. The stream must not outlive this object.
  std::function<std::optional<std::string>()> stream();

 private:
  struct Reader {
    std::uint64_t since = 0;  // published when it began
    std::uint64_t round = 0;
    std::uint64_t seen = 0;  // the version
  };
  std::optional<std::string> next(Reader& reader);

  Queue<char> begun_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::string state_;
  std::uint64_t version_ = 0;    // of the state
  std::uint64_t published_ = 0;  // times, the same again too
  std::uint64_t round_ = 0;      // streams of an earlier one end
  int streams_ = 0;
  bool closed_ = false;
};

}  // namespace packmerger
