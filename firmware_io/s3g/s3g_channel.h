// One packet, one reply: the s3g exchange (MakerBot, s3g protocol specification) over a port,
// and which answers end a print.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "firmware_io/ports/port.h"
#include "firmware_io/print_state.h"
#include "firmware_io/s3g/s3g.h"
#include "firmware_io/s3g/s3g_axes.h"

namespace packmerger::s3g {

enum class Verdict {
  kAccepted,  // in the printer's buffer
  kFull,      // dropped whole: wait for room
  kRejected,  // never understood: send it again
  kUnclear    // the answer got lost: it may have been taken or not
};

struct Statistics {
  BuildState state = BuildState::kNone;
  std::uint32_t actions = 0;  // executed since the build start, it not counted; 0: not counted
};

class Channel {
 public:
  // A reply is waited for at most a fifth of timeout_s and at most one second; once nobody waits
  // any longer (control.left()), nothing is asked again.
  Channel(Port& port, double timeout_s, const PrintControl& control);

  // A query is repeated up to five times. Returns what follows the response code; throws Error{kIo}
  // when nothing intact comes or the printer answers that its build is over.
  std::string query(std::string_view payload, std::size_t reply_size);

  // A query without result, sent once only; its answer, if any, is not looked at.
  void try_query(Query code);
  // The same without waiting for an answer.
  void tell(Query code);

  // "Sailfish 7.8", "MakerBot 7.5"; version: as the version query gave it.
  std::string firmware_name(std::uint32_t version);
  std::uint32_t free_buffer();
  // Its buffer is empty. Up to fifteen moves may still be on their way.
  bool is_finished();
  Steps position();
  std::uint8_t board_status();
  Statistics statistics();
  // tool: index; query_code: 0x02 or 0x20 (tool's temperature, target), 0x1E or 0x21 (platform's).
  int temperature(std::uint8_t tool, std::uint8_t query_code);

  // Sends an action once. Throws Error{kIo} for answers that end a print.
  Verdict try_action(std::string_view payload);

  // Takes what has come without being asked for.
  void hear_strays();

  // How often it was heard that an action was taken although nothing waited for an answer: one that
  // came late, or that of a packet taken twice.
  int surplus() const { return surplus_; }
  int take_surplus() { return std::exchange(surplus_, 0); }

  // True, once, when the answer to a query got lost: it may have told the end of the build.
  bool take_missed() { return std::exchange(missed_, false); }

  // A build that was cancelled is reported once to whoever speaks next.
  void tolerate_cancelled(bool tolerate) { tolerate_cancelled_ = tolerate; }

  // False once the printer said why it stopped; it must not be disturbed then.
  bool may_abort() const { return may_abort_; }

  void pause(double seconds);  // listening
  void resynchronize();        // reads until the line is quiet, and forgets what came

  double now_s() const { return port_.now_s(); }
  std::string name() const { return port_.name(); }

 private:
  enum class Outcome { kReply, kSilence, kGarbled, kNoise };
  using Expected = std::function<bool(const Reply&)>;

  Outcome exchange(std::string_view payload, const Expected& expected, std::string& reply);
  bool listen(double timeout_s);
  void notice_unexpected();
  void note_surplus(const Reply& reply);
  void throw_if_over(std::uint8_t code);

  Port& port_;
  const PrintControl& control_;
  double reply_wait_s_;
  ReplyReader reader_;
  int surplus_ = 0;
  bool missed_ = false;
  bool tolerate_cancelled_ = false;
  bool may_abort_ = true;
};

}  // namespace packmerger::s3g
