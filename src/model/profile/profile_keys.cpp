#include "model/profile/profile_keys.h"

#include <algorithm>
#include <utility>

#include "model/profile/plate_keys.h"

namespace packmerger {
namespace {

Limits from_to(double least, double most) { return {least, most, false}; }
Limits above(double least, double most) { return {least, most, true}; }

template <typename Enum>
ChoiceKey choice(Enum& member, std::vector<std::string> names) {
  return {std::move(names), [&member] { return static_cast<std::size_t>(member); },
          [&member](std::size_t index) { member = static_cast<Enum>(index); }};
}

std::vector<std::string> dialect_names() {
  std::vector<std::string> names;
  for (const DialectRow& row : kDialects) names.emplace_back(row.name);
  return names;
}

std::string dialect_meaning() {
  std::string meaning = "What the printer is given: ";
  for (const DialectRow& row : kDialects) {
    if (&row != kDialects.data()) meaning += &row == &kDialects.back() ? ", or " : ", ";
    meaning += row.given;
  }
  return meaning + ".";
}

// "\"gcode\" or \"s3g\"": those that a program is made for.
std::string sliced_dialects() {
  std::string names;
  for (const DialectRow& row : kDialects)
    if (row.language != nullptr)
      names += (names.empty() ? "\"" : " or \"") + std::string(row.name) + "\"";
  return names;
}

bool all(std::string_view text, std::string_view allowed) {
  return text.find_first_not_of(allowed) == std::string_view::npos;
}

TextForm one_line() {
  return {"one line",
          [](std::string_view text) { return text.find_first_of("\r\n") == text.npos; }};
}

TextForm id_form() { return {"letters, digits, \"-\", \"_\" and \".\"", is_profile_id}; }

TextForm currency_form() {
  return {"a currency of ISO 4217, three capital letters", [](std::string_view text) {
            return text.size() == 3 && all(text, "ABCDEFGHIJKLMNOPQRSTUVWXYZ");
          }};
}

TextForm tetgen_form() {
  return {"TetGen switches: letters, digits, \".\" and \"/\"", [](std::string_view text) {
            return std::ranges::all_of(text, [](unsigned char c) {
              return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                     c == '.' || c == '/';
            });
          }};
}

TextForm gpx_form() {
  return {"a machine of gpx: lower-case letters and digits, such as r1d",
          [](std::string_view text) { return all(text, "abcdefghijklmnopqrstuvwxyz0123456789"); }};
}

// As a line goes to the printer, with a number of eight digits and its checksum, it has 95 bytes at
// most; "M110" anywhere in it would set the count of lines.
TextForm gcode_form() {
  return {"lines of G-code: plain ASCII, 81 characters each at most, no M110",
          [](std::string_view text) {
            constexpr std::size_t kLongest = 95 - std::string_view("N99999999 *255").size();
            while (!text.empty()) {
              const std::string_view line = text.substr(0, text.find_first_of("\r\n"));
              text.remove_prefix(std::min(line.size() + 1, text.size()));
              const std::string_view command = line.substr(0, line.find(';'));
              if (command.size() > kLongest || command.find("M110") != command.npos ||
                  !std::ranges::all_of(command, [](char c) { return c >= ' ' && c <= '~'; }))
                return false;
            }
            return true;
          }};
}

TextForm usb_form() {
  return {"vendor:product in lower-case hex, such as 23c1:d314", [](std::string_view text) {
            const std::string_view hex = "0123456789abcdef";
            return text.size() == 9 && text[4] == ':' && all(text.substr(0, 4), hex) &&
                   all(text.substr(5), hex);
          }};
}

void add_machine(Profile& p, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"id", TextKey{&p.id, id_form()}, "",
        "What the profile is called on the command line; without it, the file's name less .toml."},
       {"name", TextKey{&p.name, one_line()}, "", "The machine's name, for people.", true},
       {"technology", choice(p.technology, {"polyjet", "fdm", "powder"}), "",
        "Which estimator fits: jetted photopolymer in full support, extruded filament, or powder "
        "that is fused in its bed.",
        true},
       {"dialect", choice(p.dialect, dialect_names()), "", dialect_meaning(), true},
       {"document", choice(p.document, {"tray_stl", "tray_3mf"}), "",
        "The document that dialects handoff and usb deliver: tray.stl or tray.3mf."},
       {"build_mm", Numbers3Key{&p.build_mm, above(0, 2000)}, "mm",
        "The volume that may be printed in: x, y, z.", true},
       {"plate_mm", PolygonKey{&p.plate_mm}, "mm",
        "Where on the tray parts may stand, as the corners of a polygon, counted from the front "
        "left corner of build_mm; none: the whole rectangle."},
       {"keep_out_mm", PolygonsKey{&p.keep_out_mm}, "mm",
        "Areas that no part may stand over at any height, each the corners of a polygon, counted "
        "in the same way."},
       {"origin", choice(p.origin, {"front_left", "center"}), "",
        "Where on the plate the machine's own coordinates are zero."},
       {"layer_mm", NumberKey{&p.layer_mm, above(0, 2)}, "mm", "The height of a layer.", true},
       {"support_angle_deg", NumberKey{&p.support_angle_deg, from_to(0, 90)}, "degrees",
        "A facet needs support when its normal points down by more than this below the horizontal; "
        "0: every down-facing facet, 90: none."}});
}

void add_shape(ShapeSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"wall_mm", NumberKey{&s.wall_mm, above(0, 100)}, "mm", "The shell's thickness."},
       {"voxel_mm", NumberKey{&s.voxel_mm, from_to(0.02, 20)}, "mm",
        "The cell of the distance grid that the inner surface is taken from."},
       {"min_cavity_mm3", NumberKey{&s.min_cavity_mm3, from_to(0, 1e9)}, "mm³",
        "A cavity smaller than this stays solid."},
       {"resample_tolerance_mm", NumberKey{&s.resample_tolerance_mm, above(0, 10)}, "mm",
        "How far a re-sampled surface may lie from the model, where it must be re-sampled."},
       {"tetgen_flags", TextKey{&s.tetgen_flags, tetgen_form()}, "",
        "TetGen's switches for the shell's tetrahedra: p keeps the surface, Y adds no points on "
        "it, q bounds the shape, a the volume (mm³)."},
       {"max_tetrahedron_fraction", NumberKey{&s.max_tetrahedron_fraction, above(0, 1)}, "of V_o",
        "No tetrahedron holds a larger share of the shell's volume than this before clustering."},
       {"clusters", IntegerKey{&s.clusters, from_to(1, 10000)}, "",
        "Seeds are grown to one of this many shares of the shell's volume."},
       {"cluster_rounds", IntegerKey{&s.cluster_rounds, from_to(1, 10000)}, "rounds",
        "Clusters are re-grown from their centroids at most this often."},
       {"cluster_epsilon_mm", NumberKey{&s.cluster_epsilon_mm, above(0, 100)}, "mm",
        "Clustering ends when no centroid moves further than this."},
       {"min_glue_area_mm2", NumberKey{&s.min_glue_area_mm2, from_to(0, 1e6)}, "mm²",
        "Segments that meet in a smaller cross-section are merged before packing."},
       {"min_volume_fraction", NumberKey{&s.min_volume_fraction, from_to(0, 1)}, "of V_o",
        "A segment with a smaller share of the shell's volume is merged before packing."},
       {"smooth_rounds", IntegerKey{&s.smooth_rounds, from_to(0, 1000)}, "rounds",
        "Rounds of Laplacian smoothing of the cuts; 0 leaves them as they are."},
       {"segmentation", choice(s.segmentation, {"paper", "printer"}), "",
        "How the shell is divided: the paper's clusters, or whatever packs cheapest: these or "
        "plane "
        "cuts."},
       {"parts", IntegerKey{&s.parts, from_to(2, 100)}, "",
        "Most parts of a model aimed at (segmentation = \"printer\"): planes make no more, and "
        "parts are merged until there are no more, if they can."}});
}

void add_pack(PackSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"gap_mm", NumberKey{&s.gap_mm, from_to(0, 50)}, "mm",
        "The least distance between any two parts, in every direction. At 0 they keep "
        "0.001 mm, so that they never touch."},
       {"grid_mm", NumberKey{&s.grid_mm, from_to(0.1, 20)}, "mm",
        "The cell of the height field that parts are placed on."},
       {"rotation_step_deg", NumberKey{&s.rotation_step_deg, from_to(5, 360)}, "degrees",
        "Rotations tried about each of the three axes; 360: only as the model stands."},
       {"objective", choice(s.objective, {"paper", "printer", "height"}), "",
        "What the packer minimises: the paper's f = w·V_bp + (1 − w)·V_s, this printer's money, or "
        "the height."},
       {"placement", choice(s.placement, {"drop", "anywhere"}), "",
        "How parts come to their places: dropped from above only, or afterwards also put into "
        "cavities and under overhangs, which takes some seconds more."},
       {"weight", NumberKey{&s.weight, from_to(0, 1)}, "", "w of the paper's objective."},
       {"tabu_memory", IntegerKey{&s.tabu_memory, from_to(0, 1000)}, "rounds",
        "How long a part that was moved is left alone."},
       {"tabu_patience", IntegerKey{&s.tabu_patience, from_to(1, 100000)}, "rounds",
        "The search starts afresh after this many rounds without a better layout."},
       {"tabu_samples", IntegerKey{&s.tabu_samples, from_to(1, 100000)}, "moves",
        "Moves tried in one round."},
       {"search_grid_mm", NumberKey{&s.search_grid_mm, from_to(0.1, 50)}, "mm",
        "The cell of the height field while layouts are searched; small parts get smaller ones."}});
}

void add_polyjet(PolyjetSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"polyjet.start_s", NumberKey{&s.start_s, from_to(0, 86400)}, "s",
        "Time before the first layer."},
       {"polyjet.layer_s", NumberKey{&s.layer_s, from_to(0, 600)}, "s", "Time for every layer."},
       {"polyjet.swath_s", NumberKey{&s.swath_s, from_to(0, 600)}, "s",
        "Time for every pass of the heads."},
       {"polyjet.swath_mm", NumberKey{&s.swath_mm, above(0, 2000)}, "mm",
        "How much of y one pass prints."},
       {"polyjet.per_mm_x_s", NumberKey{&s.per_mm_x_s, from_to(0, 60)}, "s/mm",
        "Time for every mm of x in a pass."},
       {"polyjet.support_g_per_cm3", NumberKey{&s.support_g_per_cm3, from_to(0, 20)}, "g/cm³",
        "Support mass per volume below down-facing facets, coat, pedestal and purge included."},
       {"polyjet.model_waste_factor", NumberKey{&s.model_waste_factor, from_to(1, 10)}, "",
        "Model material used over what stays in the part."}});
}

void add_powder(PowderSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"powder.start_s", NumberKey{&s.start_s, from_to(0, 604800)}, "s",
        "Time beside the layers: warming up, and cooling until the next tray may begin."},
       {"powder.layer_s", NumberKey{&s.layer_s, from_to(0, 600)}, "s",
        "Time for every layer, from the floor of the build volume to the highest part."},
       {"powder.refresh_fraction", NumberKey{&s.refresh_fraction, from_to(0, 1)}, "of the bed",
        "Share of every bed's mass that must be new powder; what is over of the used one is "
        "thrown away."}});
}

void add_fdm(FdmSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"fdm.time", choice(s.time, {"deposition", "toolpath"}), "",
        "How time is estimated: from the deposited volume and the layers, or from the paths."},
       {"fdm.start_s", NumberKey{&s.start_s, from_to(0, 86400)}, "s",
        "Time before the first layer: homing and heating."},
       {"fdm.deposition_cm3_h", NumberKey{&s.deposition_cm3_h, from_to(0, 10000)}, "cm³/h",
        "Deposition rate, model and support together (time = \"deposition\")."},
       {"fdm.layer_s", NumberKey{&s.layer_s, from_to(0, 600)}, "s",
        "Time for every layer beyond its deposition (time = \"deposition\")."},
       {"fdm.line_width_mm", NumberKey{&s.line_width_mm, from_to(0.05, 5)}, "mm",
        "Width of an extruded line."},
       {"fdm.shells", IntegerKey{&s.shells, from_to(1, 100)}, "lines",
        "Outlines around every layer."},
       {"fdm.solid_layers", IntegerKey{&s.solid_layers, from_to(0, 1000)}, "layers",
        "Solid layers below the top and above the bottom."},
       {"fdm.infill_fraction", NumberKey{&s.infill_fraction, from_to(0, 1)}, "",
        "Share of the inside that is filled."},
       {"fdm.external_speed_mm_s", NumberKey{&s.external_speed_mm_s, above(0, 2000)}, "mm/s",
        "Speed of the outermost outline."},
       {"fdm.speed_mm_s", NumberKey{&s.speed_mm_s, above(0, 2000)}, "mm/s",
        "Speed of everything else that is extruded."},
       {"fdm.acceleration_mm_s2", NumberKey{&s.acceleration_mm_s2, above(0, 1e5)}, "mm/s²",
        "Acceleration while extruding."},
       {"fdm.jerk_mm_s", NumberKey{&s.jerk_mm_s, from_to(0, 200)}, "mm/s",
        "Largest change of speed at a corner."},
       {"fdm.min_layer_s", NumberKey{&s.min_layer_s, from_to(0, 600)}, "s",
        "A layer is slowed down until it takes this long."},
       {"fdm.min_speed_mm_s", NumberKey{&s.min_speed_mm_s, above(0, 2000)}, "mm/s",
        "It is never slowed down below this."},
       {"fdm.support_spacing_mm", NumberKey{&s.support_spacing_mm, from_to(0, 50)}, "mm",
        "Gap between the lines of support."},
       {"fdm.overhead_factor", NumberKey{&s.overhead_factor, from_to(0, 10)}, "",
        "k: share of time added for travel, retraction and short moves."},
       {"fdm.support_time_factor", NumberKey{&s.support_time_factor, from_to(0, 10)}, "",
        "c_s: time of support lines over length by speed."},
       {"fdm.interface_s_per_mm2", NumberKey{&s.interface_s_per_mm2, from_to(0, 60)}, "s/mm²",
        "c_i: time for every mm² of interface between support and part, per layer."},
       {"fdm.support_fill_fraction", NumberKey{&s.support_fill_fraction, from_to(0, 10)}, "of V_s",
        "Share of the supported volume that is really deposited."},
       {"fdm.level_support_fraction", NumberKey{&s.level_support_fraction, from_to(0, 1)}, "",
        "Share of that left below level facets, which slicers bridge (time = \"toolpath\")."}});
}

void add_material(MaterialSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"material.model_name", TextKey{&s.model_name, one_line()}, "", "What the part is made of."},
       {"material.support_name", TextKey{&s.support_name, one_line()}, "",
        "What its support is made of."},
       {"material.model_density_g_cm3", NumberKey{&s.model_density_g_cm3, above(0, 30)}, "g/cm³",
        "Density of the model material."},
       {"material.support_density_g_cm3", NumberKey{&s.support_density_g_cm3, above(0, 30)},
        "g/cm³", "Density of the support material."}});
}

void add_cost(CostSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"cost.currency", TextKey{&s.currency, currency_form()}, "", "What all prices are in."},
       {"cost.model_price_per_g", NumberKey{&s.model_price_per_g, from_to(0, 1e6)}, "currency/g",
        "Price of the model material."},
       {"cost.support_price_per_g", NumberKey{&s.support_price_per_g, from_to(0, 1e6)},
        "currency/g", "Price of the support material."},
       {"cost.machine_price_per_h", NumberKey{&s.machine_price_per_h, from_to(0, 1e6)},
        "currency/h", "What an hour of the machine costs: wear, power, service."},
       {"cost.labour_price_per_h", NumberKey{&s.labour_price_per_h, from_to(0, 1e6)}, "currency/h",
        "What an hour of gluing and cleaning costs."},
       {"cost.glue_min_per_joint", NumberKey{&s.glue_min_per_joint, from_to(0, 1440)}, "min",
        "Gluing for every pair of neighbouring parts."},
       {"cost.clean_min_per_tray", NumberKey{&s.clean_min_per_tray, from_to(0, 1440)}, "min",
        "Clearing and cleaning for every tray."}});
}

void add_slicer(SlicerSettings& s, std::vector<Key>& keys) {
  keys.insert(keys.end(),
              {{"slicer.options", TextTableKey{&s.options, one_line()}, "",
                "PrusaSlicer's own settings, by its names, every value a text."},
               {"slicer.start_gcode", TextKey{&s.start_gcode, {}}, "",
                "G-code before the first layer: homing, position, heating and the wait for it."},
               {"slicer.end_gcode", TextKey{&s.end_gcode, {}}, "",
                "G-code after the last layer: heaters and motors off."},
               {"slicer.gpx_machine", TextKey{&s.gpx_machine, gpx_form()}, "",
                "gpx's name of the machine, for dialect s3g."}});
}

void add_link(LinkSettings& s, std::vector<Key>& keys) {
  keys.insert(
      keys.end(),
      {{"link.baud", IntegerKey{&s.baud, from_to(300, 4000000)}, "baud", "Speed of the port."},
       {"link.timeout_s", NumberKey{&s.timeout_s, above(0, 3600)}, "s",
        "Silence after which the printer counts as gone."},
       {"link.boot_wait_s", NumberKey{&s.boot_wait_s, from_to(0, 120)}, "s",
        "Wait after opening the port, for boards that reset then."},
       {"link.usb_ids", TextsKey{&s.usb_ids, usb_form()}, "",
        "USB vendor and product numbers the machine shows itself by."},
       {"link.safe_gcode", TextKey{&s.safe_gcode, gcode_form()}, "",
        "Sent after a failure or a cancel: heaters off."},
       {"link.pause_gcode", TextKey{&s.pause_gcode, gcode_form()}, "",
        "Dialect gcode: executed when a print pauses and its moves are done."},
       {"link.resume_gcode", TextKey{&s.resume_gcode, gcode_form()}, "",
        "Dialect gcode: executed before it goes on; undoes the moves of pause_gcode."},
       {"link.window_bytes", IntegerKey{&s.window_bytes, from_to(0, 96)}, "bytes",
        "Dialect gcode: sent and not acknowledged at most; 0: a line at a time."},
       {"link.machine", TextKey{&s.machine, one_line()}, "",
        "What the machine must say of itself (M115, its firmware, or its IEEE 1284 id), in "
        "part."}});
}

}  // namespace

std::vector<Key> keys_of(Profile& profile) {
  std::vector<Key> keys;
  add_machine(profile, keys);
  add_shape(profile.shape, keys);
  add_pack(profile.pack, keys);
  add_polyjet(profile.polyjet, keys);
  add_powder(profile.powder, keys);
  add_fdm(profile.fdm, keys);
  add_material(profile.material, keys);
  add_cost(profile.cost, keys);
  add_slicer(profile.slicer, keys);
  add_link(profile.link, keys);
  return keys;
}

std::string missing_for_abilities(const Profile& profile) {
  if (const std::string wrong = wrong_with_plate(profile); !wrong.empty()) return wrong;
  if (profile.technology == Technology::kPolyjet && profile.polyjet.layer_s <= 0)
    return "polyjet.layer_s must be above 0 where technology is \"polyjet\"";
  if (profile.technology == Technology::kPowder) {
    if (profile.powder.layer_s <= 0)
      return "powder.layer_s must be above 0 where technology is \"powder\"";
    if (profile.support_angle_deg < 90)
      return "support_angle_deg must be 90 where technology is \"powder\": no facet needs support";
    if (profile.is_sliced())
      return "dialect must be \"handoff\" or \"usb\" where technology is \"powder\"";
  }
  if (profile.technology == Technology::kFdm && profile.fdm.time == FdmTime::kDeposition &&
      profile.fdm.deposition_cm3_h <= 0)
    return "fdm.deposition_cm3_h must be above 0 where fdm.time is \"deposition\"";
  if (!profile.is_sliced()) return {};
  if (profile.slicer.start_gcode.empty() || profile.slicer.end_gcode.empty())
    return "slicer.start_gcode and slicer.end_gcode are required where dialect is " +
           sliced_dialects();
  if (profile.language()->from_gpx && profile.slicer.gpx_machine.empty())
    return "slicer.gpx_machine is required where dialect is \"" +
           std::string(row_of(profile.dialect).name) + "\"";
  return {};
}

}  // namespace packmerger
