// Preparing a program that somebody else made: it is checked and estimated, never changed.
#pragma once

#include "base/files.h"
#include "base/progress.h"
#include "model/printer.h"
#include "tray/program_folder.h"

namespace packmerger {

// Reads and checks it. G-code for a printer of dialect s3g is converted; everything else is kept
// byte for byte. The time is what the program tells of itself, or is counted from its moves;
// fdm.start_s is added, as to a slicer's figures. Material comes from the comments, or from what is
// extruded; an x3g program tells none. A move that leaves the build volume, or cannot be judged, is
// the warning `moves_not_judged`; what a Replicator has nothing like, `left_out`. Throws
// Error{kBadInput} where the printer cannot be sent such a program (delivery/way.h) or the
// wire cannot carry it (firmware_io/gcode/gcode_link.h, s3g_link.h), what to_x3g() throws
// (printers/program/x3g.h), Error{kNoInput}, Error{kInterrupted}.
ReadyProgram read_ready_program(const Profile& profile, const fs::path& file,
                                const Progress& progress);

// What prepare tells of it: a sentence or two.
std::string told_of(const ReadyProgram& program);

}  // namespace packmerger
