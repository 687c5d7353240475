// The one exception of the house. Thrown by any folder, caught in four places only: command
// line, daemon worker, link thread, web handler. Ordinary outcomes are values, not errors.
#pragma once

#include <stdexcept>
#include <string>

namespace packmerger {

// The value is the process exit code of the command-line contract.
enum class Fault {
  kUsage = 2,         // a bad option or value
  kBadInput = 65,     // the model cannot be used, or nothing fits any tray
  kNoInput = 66,      // no such file
  kUnavailable = 69,  // device not there, or the wrong printer
  kInternal = 70,     // a bug in PackMerger or in a library it calls
  kCannotWrite = 73,  // an output could not be written
  kIo = 74,           // reading failed, or a print failed
  kBusy = 75,         // try again later
  kBadProfile = 78,   // the profile or the daemon's settings are wrong
  kInterrupted = 130  // the user or the daemon asked to stop
};

// what(): one plain sentence saying what happened, without a trailing full stop.
// hint(): one plain sentence saying what the user can do next; empty only for kInterrupted.
class Error : public std::runtime_error {
 public:
  Error(Fault fault, const std::string& what, std::string hint)
      : std::runtime_error(what), fault_(fault), hint_(std::move(hint)) {}

  Fault fault() const { return fault_; }
  const std::string& hint() const { return hint_; }
  int exit_code() const { return static_cast<int>(fault_); }

 private:
  Fault fault_;
  std::string hint_;
};

}  // namespace packmerger
