#include "firmware_io/s3g/s3g_link.h"

#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/s3g/s3g_actions.h"
#include "firmware_io/s3g/s3g_channel.h"
#include "firmware_io/s3g/s3g_print.h"
#include "firmware_io/s3g/s3g_time_marks.h"

namespace packmerger {

void check_x3g(std::string_view program) { s3g::Actions{program}; }

void print_x3g(Port& port, std::string_view program, const StreamOptions& options,
               const PrintListener& listener, PrintControl& control) {
  s3g::Actions actions(program);
  actions.complete(options.build_name);

  Reporter reporter(port, listener, options, program.size(), RemainingTime(time_marks(actions)));
  s3g::Channel channel(port, options.timeout_s, control);
  s3g::Print print(channel, reporter, control);
  print.connect(options.boot_wait_s, options.machine);
  try {
    print.run(actions);
  } catch (const Error& error) {
    print.end_by(error);
    throw;
  } catch (...) {
    print.abort_quietly();
    throw;
  }
  reporter.state(PrintState::kDone);
}

}  // namespace packmerger
