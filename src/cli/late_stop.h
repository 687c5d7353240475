// A stop that is obeyed although the program is deep in a library that knows of none.
#pragma once

namespace packmerger::cli {

// For verbs that only compute, never for one that prints: if the program still runs a second after
// stop_asked(), it is ended there and then, with the exit code of an interruption and without its
// temporary folders and children.
void watch_for_late_stop();

// Async-signal-safe. Without a watch nothing happens.
void stop_asked();

}  // namespace packmerger::cli
