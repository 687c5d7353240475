// Giving a prepared job to its printer: streaming a tray's program, or its document to a
// printer of dialect usb, or handing the document over in a folder where the printer takes no job
// by wire.
#pragma once

#include <string>

#include "base/files.h"
#include "firmware_io/print_state.h"

namespace packmerger {

// Streams the program of one tray (from 1) to the printer at `port` (delivery/find_port.h) and
// returns when the printer has executed all of it; a printer of dialect usb, when it has taken its
// document. Reads job.json and profile.toml of the folder; the profile's dialect,
// baud rate and limits apply. Throws
//   Error{kNoInput}      no job folder, no such tray, or its file is not there;
//   Error{kBadInput}     the program cannot be sent, or is not what was prepared;
//   Error{kUsage}        the printer of this profile takes no job by wire;
//   Error{kUnavailable}  no such port, nobody answers, or another printer is there;
//   Error{kBusy}         the port or the printer is in use;
//   Error{kCannotWrite}  told_file;
//   Error{kIo}           the print failed; Error{kInterrupted} cancelled and stopped.
// kUnavailable and kBusy are thrown before anything was printed, and so is what is wrong with the
// program. tray_files: what hash_trays() (job_folder.h) gave when the job was prepared, to which
// the tray's bytes must be true; empty: not known, nothing is compared. told_file says from
// before the first line on how far the printer was told to go (progress_file.h).
void send_tray(const fs::path& job_folder, int tray, const std::string& port,
               const fs::path& told_file, const PrintListener& listener, PrintControl& control,
               const std::string& tray_files = {});

// Puts the profile's document of every tray, job.json and preview.png into `to/name`: through a
// temporary name, fsync and rename, so that the folder is whole or absent. Returns its path.
// Where a folder of that name already holds this very job, nothing is done. Throws Error{kNoInput}
// when job_folder is no job folder or a tray's document is not there, Error{kBadInput} when one is
// not what tray_files tells (as in send_tray), Error{kUsage} when its printer is sent its jobs,
// Error{kCannotWrite} when `to` cannot be written to or the name is taken by something else.
fs::path hand_over(const fs::path& job_folder, const fs::path& to, const std::string& name,
                   const std::string& tray_files = {});

}  // namespace packmerger
