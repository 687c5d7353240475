// A stop that is obeyed although the program is deep in a library that knows of none.
#pragma once

namespace packmerger::cli {

// For what only computes, never for a print: while one is there and goes on to be there a second
// after stop_asked(), the program is ended there and then, with the exit code of an interruption
// and without its temporary folders and children.
class LateStop {
 public:
  LateStop();
  LateStop(const LateStop&) = delete;
  LateStop& operator=(const LateStop&) = delete;
  ~LateStop();
};

// Async-signal-safe. Without a watch nothing happens.
void stop_asked();

}  // namespace packmerger::cli
