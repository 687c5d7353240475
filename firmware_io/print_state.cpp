#include "firmware_io/print_state.h"

namespace packmerger {

std::string_view print_state_name(PrintState state) {
  switch (state) {
    case PrintState::kConnecting:
      return "connecting";
    case PrintState::kHeating:
      return "heating";
    case PrintState::kPrinting:
      return "printing";
    case PrintState::kPaused:
      return "paused";
    case PrintState::kWaiting:
      return "waiting";
    case PrintState::kCancelling:
      return "cancelling";
    case PrintState::kDone:
      return "done";
  }
  return "";
}

}  // namespace packmerger
