#include "firmware_io/s3g_link.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/error.h"
#include "firmware_io/conversation.h"
#include "firmware_io/s3g.h"
#include "firmware_io/s3g_channel.h"
#include "firmware_io/s3g_print.h"

namespace packmerger {

namespace {

bool holds(const std::vector<std::string_view>& actions, std::uint8_t code) {
  return std::any_of(actions.begin(), actions.end(), [&](std::string_view action) {
    return static_cast<std::uint8_t>(action[0]) == code;
  });
}

}  // namespace

void check_x3g(std::string_view program) { s3g::split_actions(program); }

void print_x3g(Port& port, std::string_view program, const StreamOptions& options,
               const PrintListener& listener, PrintControl& control) {
  std::vector<std::string_view> actions = s3g::split_actions(program);
  const std::string start = s3g::build_start(options.build_name);
  const std::string end = s3g::build_end();
  if (!holds(actions, s3g::kBuildStart)) actions.insert(actions.begin(), start);
  if (!holds(actions, s3g::kBuildEnd)) actions.push_back(end);
  std::vector<std::size_t> counted;
  counted.reserve(actions.size());
  for (std::size_t done = 0; const std::string_view action : actions) {
    if (action.data() != start.data() && action.data() != end.data()) done += action.size();
    counted.push_back(done);
  }

  Reporter reporter(port, listener, options, program.size(),
                    RemainingTime(time_marks(actions, counted)));
  s3g::Channel channel(port, options.timeout_s);
  s3g::Print print(channel, reporter, control);
  print.connect(options.boot_wait_s, options.machine);
  try {
    print.run(actions, counted);
  } catch (...) {
    print.abort_quietly();
    throw;
  }
  reporter.state(PrintState::kDone);
}

}  // namespace packmerger
