// A way of delivery: how printers of a dialect are given their jobs. One constant of this type a
// way, each in a file of its own below src/delivery/ways; src/delivery/ways/ways.cpp registers
// them. Whoever sends, watches or configures a printer asks here, and never which dialect it has.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/files.h"
#include "firmware_io/ports/devices.h"
#include "firmware_io/print_state.h"
#include "model/files/file_format.h"
#include "model/printer.h"

namespace packmerger {

// One tray on its way to a printer; of a way that hands over, the whole job.
struct Delivery {
  const fs::path& folder;         // the job folder
  const Profile& profile;         // that it was prepared with
  int trays;                      // that it has
  const std::string& tray_files;  // as hash_trays() (job_folder.h) told; empty: not known
  // where it goes: an address (find_port.h), or a folder and the name of the one to make in it
  std::string to;
  std::string name = {};
  // what a way that hands over has no use for
  fs::path file = {};        // what the printer is given
  std::string program = {};  // the file's bytes; empty where it is a document
  StreamOptions options = {};
};

struct DeliveryWay {
  // What it needs of a printer's settings in packmergerd.toml: the folder that finished trays are
  // put into (handoff_folder), or else a port.
  bool hands_over;

  // Whether somebody has to clear a bed before the next tray.
  bool has_bed;

  // Whether the printer tells when the print is over, and with it how long it took; otherwise
  // give() returns when the tray was taken.
  bool tells_end;

  // What progress is counted in: "line" or "byte".
  std::string_view unit;

  // The simulated firmwares that stand for such a printer (firmware_io/simulated/firmwares.h), the
  // usual one first.
  std::span<const std::string_view> simulated;

  // What is wrong with a printer's settings, a phrase that goes on after the printer's name: "needs
  // the key port". Nothing where all is well.
  std::optional<std::string> (*fault_of_settings)(const std::string& port,
                                                  const fs::path& handoff_folder);

  // Throws Error{kBadInput}, in words for people, where a printer of this profile cannot be sent a
  // program of this kind.
  void (*check_program)(const Profile& profile, FileKind kind);

  // The address of the one printer of this profile that is connected now; empty for a way without
  // ports. Throws as find_port() does (find_port.h).
  std::string (*find_printer)(const Profile& profile);

  // Whether the printer at the port is there; nothing where that is not known. devices: what is
  // connected; nothing where that is not known either.
  std::optional<bool> (*is_connected)(const std::string& port,
                                      const std::optional<Devices>& devices);

  // Gives the printer the delivery and returns when the print is over (see tells_end). The listener
  // is told how it stands; pausing, resuming, cancelling and stopping at once are asked for by the
  // control, and obeyed as firmware_io/print_state.h says. Throws what send_tray() and hand_over()
  // say (send.h).
  void (*give)(const Delivery& delivery, const PrintListener& listener, PrintControl& control);
};

const DeliveryWay& way_of(Dialect dialect);
inline const DeliveryWay& way_of(const Profile& profile) { return way_of(profile.dialect); }

}  // namespace packmerger
