// What changed, told to every browser that watches: to some as changes, each with a number, to
// others as the whole state again, of which the newest counts and older ones may be left out.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "base/queue.h"

namespace packmerger {

// Thread-safe.
class WebEvents {
 public:
  WebEvents();

  // The loop looked at what there is now. change: since the look before, as JSON text; empty: none.
  // state gives all of it; it is asked only where somebody wants that.
  void publish(const std::string& change, const std::function<std::string()>& state);
  // Readable while a stream waits for the whole state, which is then wanted at once: what was
  // published before it began may be old.
  int fd() const { return begun_.fd(); }
  // Whether one does; then not again until the next begins.
  bool take_begun();
  // Whether somebody watches, so that the loop need not look for nobody.
  bool watched() const;
  void end_streams();  // ends those there are
  void close();        // and lets none begin

  // A stream of server-sent events (HTML Living Standard, section 9.2) for one client: the state
  // now, then every change, and a comment after ten quiet seconds, so that a client that went away
  // is noticed. Nothing where too many watch already. The stream must not outlive this object.
  std::function<std::optional<std::string>()> stream();
  // The same, told as changes: the state first and again where some were missed, and its number or
  // the change's as the event's id. last_id: the Last-Event-ID of the client; where all that
  // came after it is still known, it goes on there. Empty or any other text: from the beginning.
  std::function<std::optional<std::string>()> changes(std::string_view last_id);

 private:
  struct Reader {
    bool wants_changes = false;
    std::uint64_t since = 0;  // looks when it began to wait for a state; one after that counts
    std::uint64_t round = 0;
    std::optional<std::uint64_t> seen;  // the number of what it was told last
    bool goes_on = false;               // from an id; told at once, so that it knows
  };
  std::function<std::optional<std::string>()> begin(Reader reader);
  std::optional<std::string> next(Reader& reader);
  void want_state(Reader& reader);
  bool is_kept(std::uint64_t seen) const;
  bool has_changes_for(const Reader& reader) const;
  std::string changes_for(Reader& reader);
  std::string event(const char* name, std::uint64_t number, const std::string& data) const;

  const std::string run_;  // begins every id: a daemon's numbers are not those of the one before
  Queue<char> begun_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> changes_;  // the newest, the last of which has number_
  std::size_t change_bytes_ = 0;     // of all those
  std::uint64_t number_ = 0;
  std::string state_;               // the newest that was asked for
  std::uint64_t state_number_ = 0;  // the changes that are in it
  std::uint64_t state_look_ = 0;
  std::uint64_t looks_ = 0;
  std::uint64_t round_ = 0;    // streams of an earlier one end
  bool state_wanted_ = false;  // by one that waits for it
  int streams_ = 0;
  int state_streams_ = 0;  // of these, that are told states only
  bool closed_ = false;
};

}  // namespace packmerger
