// A printer profile: everything PackMerger knows of one machine, as data. Profiles are TOML files;
// docs/PROFILES lists every key with unit, range and meaning. Code branches on the abilities
// declared here (technology, dialect, port), never on a machine's name.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/geometry.h"
#include "model/dialect.h"
#include "model/plate.h"

namespace packmerger {

enum class Technology { kPolyjet, kFdm, kPowder };
enum class Objective { kPaper, kPrinter, kHeight };  // what the packer minimises
enum class Placement { kDrop, kAnywhere };           // how parts come to their places
enum class Segmentation { kPaper, kPrinter };        // how the shell is divided
enum class Origin { kFrontLeft, kCenter };           // of the machine's own coordinates
enum class FdmTime { kDeposition, kToolpath };       // which FDM estimator fits the machine
enum class HandoffDocument { kTrayStl, kTray3mf };

// The geometry of a job: sections 3 to 6 of the paper.
struct ShapeSettings {
  double wall_mm = 3;
  double voxel_mm = 1;                     // of the distance grid
  double min_cavity_mm3 = 500;             // smaller cavities stay solid
  double resample_tolerance_mm = 0.3;      // furthest a re-sampled surface may lie from the model
  std::string tetgen_flags = "pYq1.6a";    // documented in docs/PROFILES
  double max_tetrahedron_fraction = 5e-4;  // of V_o in one tetrahedron
  int clusters = 100;                      // seeds are grown to 1/clusters of V_o
  int cluster_rounds = 50;
  double cluster_epsilon_mm = 1e-3;
  double min_glue_area_mm2 = 10;
  double min_volume_fraction = 0.05;  // of V_o
  int smooth_rounds = 10;
  Segmentation segmentation = Segmentation::kPrinter;
  int parts = 12;  // most parts aimed at where planes divide
};

struct PackSettings {
  double gap_mm = 1;
  double grid_mm = 1;
  double rotation_step_deg = 30;
  Objective objective = Objective::kPrinter;
  Placement placement = Placement::kDrop;
  double weight = 0.75;  // w of equation (1)
  int tabu_memory = 3;
  int tabu_patience = 10;
  int tabu_samples = 6;
  double search_grid_mm = 3;
};

// docs/ESTIMATES gives the formulas.
struct PolyjetSettings {
  double start_s = 0;
  double layer_s = 0;
  double swath_s = 0;
  double swath_mm = 50.8;
  double per_mm_x_s = 0;
  double support_g_per_cm3 = 0;   // effective: coat, pedestal and purge included
  double model_waste_factor = 1;  // deposited mass over the model's mass
};

// Parts that a laser or a lamp fuses in a bed of powder (SLS, MJF): nothing needs support.
struct PowderSettings {
  double start_s = 0;           // warming up, and cooling until the next tray may begin
  double layer_s = 0;           // spreading and fusing
  double refresh_fraction = 0;  // of a new bed's mass: powder that was never heated
};

struct FdmSettings {
  FdmTime time = FdmTime::kToolpath;
  double start_s = 0;
  // kDeposition
  double deposition_cm3_h = 0;  // model and support
  double layer_s = 0;
  // kToolpath
  double line_width_mm = 0.45;
  int shells = 2;
  int solid_layers = 4;
  double infill_fraction = 0.1;
  double external_speed_mm_s = 40;
  double speed_mm_s = 80;
  double acceleration_mm_s2 = 2000;
  double jerk_mm_s = 15;
  double min_layer_s = 12;
  double min_speed_mm_s = 24;
  double support_spacing_mm = 2.5;
  double overhead_factor = 0.22;      // k
  double support_time_factor = 4.1;   // c_s
  double interface_s_per_mm2 = 0.8;   // c_i, per layer-mm² of interface
  double support_fill_fraction = 1;   // of V_s that is really deposited
  double level_support_fraction = 1;  // of that, below level facets, where slicers bridge
};

struct MaterialSettings {
  std::string model_name;
  std::string support_name;
  double model_density_g_cm3 = 1;
  double support_density_g_cm3 = 1;
};

struct CostSettings {
  std::string currency = "EUR";
  double model_price_per_g = 0;
  double support_price_per_g = 0;
  double machine_price_per_h = 0;
  double labour_price_per_h = 0;
  double glue_min_per_joint = 0;  // minutes of gluing for one pair of neighbours
  double clean_min_per_tray = 0;  // minutes of clearing and cleaning for one tray
};

// How a Program is made (dialects gcode and s3g).
struct SlicerSettings {
  std::map<std::string, std::string> options;  // PrusaSlicer's own names and values
  std::string start_gcode;
  std::string end_gcode;
  std::string gpx_machine;  // gpx -m; dialect s3g
};

// How it is sent (dialects gcode, s3g and usb).
struct LinkSettings {
  int baud = 115200;
  double timeout_s = 30;             // silence after which the printer counts as gone
  double boot_wait_s = 2;            // after opening, for boards that reset
  std::vector<std::string> usb_ids;  // "vvvv:pppp", lower-case hex
  std::string safe_gcode;            // sent after a failure or a cancel: heaters off
  std::string pause_gcode;           // executed once a print stands paused; dialect gcode
  std::string resume_gcode;          // executed before it goes on; dialect gcode
  int window_bytes = 0;              // unacknowledged at most; 0: one line at a time
  std::string machine;               // must be in what the machine says of itself; may be empty
};

struct Profile {
  std::string id;  // the file's name without .toml
  std::string name;
  Technology technology = Technology::kFdm;
  Dialect dialect = Dialect::kHandoff;
  HandoffDocument document = HandoffDocument::kTrayStl;
  std::array<double, 3> build_mm{};  // x, y, z of the volume that may be printed in
  // In the tray's coordinates: from the build volume's front left corner.
  Polygon plate_mm;                  // where parts may stand; empty: the whole rectangle
  std::vector<Polygon> keep_out_mm;  // where no part may, at any height
  Origin origin = Origin::kFrontLeft;
  double layer_mm = 0;
  double support_angle_deg = 0;  // 0..90 below the horizontal
  ShapeSettings shape;
  PackSettings pack;
  PolyjetSettings polyjet;
  FdmSettings fdm;
  PowderSettings powder;
  MaterialSettings material;
  CostSettings cost;
  SlicerSettings slicer;
  LinkSettings link;

  // Of the program that is made for it; nullptr: it is given the tray as a document.
  const ProgramLanguage* language() const { return row_of(dialect).language; }
  bool is_sliced() const { return language() != nullptr; }
  Vec3 build() const { return {build_mm[0], build_mm[1], build_mm[2]}; }
  Plate plate() const { return {plate_mm, keep_out_mm}; }
};

// The folders profiles are looked for in, best first: $PACKMERGER_PROFILES,
// $XDG_CONFIG_HOME/packmerger/profiles, /etc/packmerger/profiles,
// /usr/share/packmerger/profiles, and the source tree's profiles/ for a build that is not
// installed.
std::vector<std::filesystem::path> profile_folders();

// id_or_path: a profile's id, or the path of a .toml file (it contains a slash or ends in .toml).
// Resolves `base`. Throws Error{kBadProfile} with file, line and what was expected;
// Error{kNoInput} when there is no such profile.
Profile read_profile(std::string_view id_or_path);

// Applies "key=value" as --set does, with the same checks as a profile. Keys are the TOML's: those
// of ShapeSettings and PackSettings stand at the top level ("gap_mm=0", "build_mm=100,100,300"),
// those of the tables [polyjet], [fdm], [material], [cost], [slicer] and [link] carry the table's
// name and a dot ("fdm.start_s=60"). Throws Error{kUsage}.
void set_profile_key(Profile& profile, std::string_view assignment);

// To be called after the last set_profile_key: a new technology or dialect may demand keys that the
// profile does not have. Throws Error{kUsage}.
void check_settings(const Profile& profile);

// The whole profile with every key, as TOML that read_profile accepts.
std::string profile_toml(const Profile& profile);

// One key as docs/PROFILES shows it.
struct ProfileKey {
  std::string name;   // "gap_mm", "polyjet.swath_s"
  std::string type;   // "number", "integer", "text", "one of …", "3 numbers", "points", "lists of
                      // points", "table of texts", "texts"
  std::string unit;   // may be empty
  std::string range;  // may be empty
  std::string meaning;        // one sentence
  std::string default_value;  // as TOML; "required" where a profile must say it
};
std::vector<ProfileKey> profile_keys();

// The ids found in profile_folders(), sorted; the first folder that has an id wins.
std::vector<std::string> profile_ids();

}  // namespace packmerger
