// What finished prints are to the estimator: their trays measured, or the slicer's figures of them.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "cli/daemon_verb.h"
#include "cli/stated_prints.h"
#include "job/calibrate/calibrate.h"
#include "model/printer.h"
#include "model/warning.h"

namespace packmerger::cli {

// The prints that the daemon saw to their end, newest first: those of one printer, or where
// `printer` is empty those prepared with this profile. Prints that stood still for an hour or more
// are left out, and those whose folder cannot be read, with a warning. Throws what ask() throws.
std::vector<StatedPrint> prints_of_daemon(const Profile& profile, const DaemonArguments& daemon,
                                          const std::string& printer, Warnings& warnings);

// A job folder is measured as it was prepared: its parts, or for a sliced profile the time it was
// predicted; a model file as it stands in its file. Throws Error{kNoInput}, Error{kBadInput} where
// the print says nothing about this profile, and what reading and slicing throw.
CalibrationPrint measured_print(const Profile& profile, const StatedPrint& print,
                                Warnings& warnings, const Progress& progress);

}  // namespace packmerger::cli
