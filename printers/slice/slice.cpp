#include "printers/slice/slice.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/files.h"
#include "base/process/process.h"
#include "model/stl.h"
#include "printers/check/check_moves.h"
#include "printers/price.h"
#include "printers/slice/extruded.h"
#include "printers/slice/slicer_comments.h"
#include "printers/slice/slicer_settings.h"

namespace packmerger {
namespace {

constexpr double kTimeoutS = 3600;
constexpr std::uint64_t kMaxGcodeBytes = std::uint64_t{4} << 30;
constexpr std::size_t kMostSaid = 2000;  // bytes of what the slicer said that are passed on
constexpr double kOutsideMm = 0.01;      // what rounding may put a part outside by

// All shells as one STL, in the machine's own coordinates.
std::string stl_of(const Tray& tray, const Vec3& shift) {
  Pose pose = Pose::Identity();
  pose.translate(shift);
  std::vector<Mesh> moved;
  for (const Mesh& part : tray.parts) moved.push_back(transformed(part, pose));
  std::vector<const Mesh*> parts;
  for (const Mesh& part : moved) parts.push_back(&part);
  return binary_stl(parts);
}

Box3 contents_box(const Tray& tray) {
  Box3 box;
  for (const Mesh& part : tray.parts) box.extend(bounding_box(part));
  if (box.isEmpty())
    throw Error(Fault::kBadInput, "The tray is empty", "Put at least one part on it.");
  return box;
}

// The slicer neither notices parts outside its bed nor keeps an object above the plate.
void check_contents(const Profile& profile, const Box3& box) {
  const Vec3 build = profile.build();
  if ((box.min().array() < -kOutsideMm).any() ||
      (box.max().array() > build.array() + kOutsideMm).any())
    throw Error(
        Fault::kBadInput,
        fmt::format("The tray's contents reach from ({:.2f}, {:.2f}, {:.2f}) to ({:.2f}, "
                    "{:.2f}, {:.2f}) mm and leave the build volume of {:g} × {:g} × {:g} mm",
                    box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(),
                    box.max().z(), build.x(), build.y(), build.z()),
        "Scale the model down, split it, or choose a larger printer.");
  if (box.min().z() > kOutsideMm)
    throw Error(Fault::kBadInput,
                fmt::format("Nothing stands on the plate: the lowest part is {:.2f} mm above it",
                            box.min().z()),
                "Lower the tray's contents to z = 0.");
}

// What follows `label` on the last line that holds it.
std::string_view after(std::string_view gcode, std::string_view label) {
  const std::size_t at = gcode.rfind(label);
  if (at == std::string_view::npos)
    throw Error(Fault::kInternal, fmt::format("PrusaSlicer's G-code lacks \"{}\"", label),
                "Install the PrusaSlicer that comes with Debian 12 (2.5.0).");
  const std::string_view rest = gcode.substr(at + label.size());
  return rest.substr(0, rest.find('\n'));
}

// What ended the slicer says nothing of the tray: it is no refusal.
void check_that_it_ran(const ProcessResult& result) {
  const auto ended = [](const std::string& how, const char* hint) {
    throw Error(Fault::kIo, "PrusaSlicer did not come to an end: " + how, hint);
  };
  constexpr const char* kAgain =
      "Try again; if it happens again, slice the model by hand to see why.";
  constexpr const char* kRoom = "Free memory and disk space, then try again.";
  const auto says = [&](const char* words) {
    return result.err.find(words) != std::string::npos ||
           result.out.find(words) != std::string::npos;
  };
  if (result.timed_out) ended(fmt::format("it took longer than {:.0f} s", kTimeoutS), kAgain);
  if (says("bad_alloc") || says("out of memory") || says("No space left"))
    ended("it ran out of memory or disk", kRoom);
  if (result.status.signal != 0)
    ended(fmt::format("it was ended by signal {}", result.status.signal), kAgain);
  if (result.status.could_not_start())
    ended("it cannot be started", "Run prusa-slicer --help to see why.");
}

// The end of what was said: there stands why.
std::string shortened(const std::string& said) {
  return "… " + said.substr(said.size() - kMostSaid);
}

void run_slicer(const fs::path& folder, const Progress& progress) {
  ProcessSpec spec;
  spec.argv = {"prusa-slicer",   "-g", "--load",     "settings.ini",
               "--dont-arrange", "-o", "tray.gcode", "tray.stl"};
  spec.set_env = {{"LC_ALL", "C"}};
  spec.unset_env = {"DISPLAY", "WAYLAND_DISPLAY"};
  spec.folder = folder;
  ProcessResult result;
  try {
    result = run_process(spec, kTimeoutS, progress);
  } catch (const Error& error) {
    if (error.fault() != Fault::kUnavailable) throw;
    throw Error(Fault::kUnavailable, "PrusaSlicer is not installed (no program prusa-slicer)",
                "Run: apt-get install --no-install-recommends prusa-slicer");
  }
  if (result.status.ok() && fs::exists(folder / "tray.gcode")) return;
  if (!result.status.ok()) check_that_it_ran(result);
  std::string said = result.err.empty() ? result.out : result.err;
  if (said.size() > kMostSaid) said = shortened(said);
  while (!said.empty() &&
         (std::isspace(static_cast<unsigned char>(said.back())) != 0 || said.back() == '.'))
    said.pop_back();
  std::replace(said.begin(), said.end(), '\n', ' ');
  const bool settings = said.find("config") != std::string::npos ||
                        said.find("nvalid value") != std::string::npos ||
                        said.find("custom G-code") != std::string::npos ||
                        said.find("nozzle diameter") != std::string::npos;
  const bool on_point = said.find("no extrusions in the first layer") != std::string::npos;
  throw Error(settings ? Fault::kBadProfile : Fault::kBadInput,
              "PrusaSlicer cannot slice the tray: " + said,
              settings   ? "Correct slicer in the profile."
              : on_point ? "Turn the model so that it stands on a face, then try again."
                         : "Repair the model, then try again.");
}

double room_to_walls_mm(const Plate& plate, const Tray& tray) {
  double room_mm = std::numeric_limits<double>::infinity();
  if (plate.is_whole()) return room_mm;
  for (const Mesh& part : tray.parts)
    for (const Vec3& point : part.points())
      room_mm = std::min(room_mm, plate.nearest_wall(point.head<2>()).clearance_mm);
  return std::max(0.0, room_mm);
}

}  // namespace

SlicedTray slice(const Profile& profile, const Tray& tray, SliceFlavour flavour,
                 const Progress& progress) {
  const Box3 box = contents_box(tray);
  check_contents(profile, box);
  const Vec3 far_room = profile.build() - box.max();
  const double room_mm = std::min({box.min().head<2>().minCoeff(), far_room.head<2>().minCoeff(),
                                   room_to_walls_mm(profile.plate(), tray)});
  const SlicerConfig config = slicer_config(profile, flavour, room_mm);

  const TemporaryFolder folder;
  write_file_whole(folder.path() / "settings.ini", ini_text(config));
  write_file_whole(folder.path() / "tray.stl", stl_of(tray, machine_volume(profile).min()));
  run_slicer(folder.path(), progress);

  SlicedTray sliced;
  sliced.skirt_left_out = config.skirt_left_out;
  sliced.gcode = read_file(folder.path() / "tray.gcode", kMaxGcodeBytes);
  const std::map<std::string, std::string> used = settings_used(sliced.gcode);
  check_settings_used(profile, used);
  sliced.time_s = slicer_seconds(after(sliced.gcode, "; estimated printing time (normal mode) = "));
  const double diameter_mm = std::stod(used.at("filament_diameter"));
  const double section_mm2 = std::numbers::pi * diameter_mm * diameter_mm / 4;
  const Extruded length = extruded(
      sliced.gcode, flavour == SliceFlavour::kFigures ? GcodeRules::kMarlin : gcode_rules(profile));
  sliced.model_mm3 = length.model_mm * section_mm2;
  sliced.model_g = sliced.model_mm3 / 1000 * profile.material.model_density_g_cm3;
  sliced.support_mm3 = length.support_mm * section_mm2;
  sliced.support_g = sliced.support_mm3 / 1000 * profile.material.support_density_g_cm3;
  return sliced;
}

Estimate estimate_by_slicer(const Profile& profile, const std::vector<Tray>& trays,
                            const Assembly& assembly, const Progress& progress) {
  Estimate sum;
  sum.source = EstimateSource::kSlicer;
  sum.trays = static_cast<int>(trays.size());
  for (const Tray& tray : trays) {
    const SlicedTray sliced = slice(profile, tray, SliceFlavour::kFigures, progress);
    sum.time_s += sliced.time_s + profile.fdm.start_s;
    sum.model_mm3 += sliced.model_mm3;
    sum.model_g += sliced.model_g;
    sum.support_mm3 += sliced.support_mm3;
    sum.support_g += sliced.support_g;
  }
  price(sum, profile, assembly);
  return sum;
}

}  // namespace packmerger
