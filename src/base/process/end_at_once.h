// The program's end where nothing else helps.
#pragma once

namespace packmerger {

// Ends the program at once, whatever its threads are doing: kills the groups of its children,
// removes its temporary folders, and leaves everything else as it is. For what cannot be
// interrupted otherwise.
[[noreturn]] void end_without_remains(int exit_code);

// Returns at once, or where that end has begun never: what fails then fails because its folder
// vanished or its child was killed, and must neither be told as the reason nor decide the exit
// code.
void yield_to_an_end();

}  // namespace packmerger
