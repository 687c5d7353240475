// The program's end where nothing else helps.
#pragma once

namespace packmerger {

// Ends the program at once, whatever its threads are doing: kills the groups of its children,
// removes its temporary folders, and leaves everything else as it is. For what cannot be
// interrupted otherwise.
[[noreturn]] void end_without_remains(int exit_code);

}  // namespace packmerger
