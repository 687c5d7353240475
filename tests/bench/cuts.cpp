#include <fmt/format.h>

#include <memory>
#include <string>

#include "base/files.h"
#include "bench/bench.h"
#include "bench/divided_picture.h"
#include "bench/told.h"
#include "job/divide.h"
#include "model/printer.h"
#include "picture/preview.h"
#include "shape/divide/premerge.h"
#include "shape/divide/segment.h"
#include "shape/divide/smooth_cuts.h"
#include "shape/solid/solidify.h"

namespace packmerger::bench {
namespace {

struct Arguments {
  std::string model;
  std::string profile = "objet30";
  double size_mm = 100;
  bool y_up = false;
  std::string out;
};

void run(const Arguments& arguments) {
  const Profile profile = read_profile(arguments.profile);
  const Progress silent;
  Warnings warnings;
  const LoadedModel model = load_model(arguments.model, arguments.size_mm);
  TetMesh tets = solidify(*model.surface, profile.shape, true, warnings, silent).tets;
  const BuildVolume build = build_volume(profile);
  Segments segments = premerge(tets, segment(tets, profile.shape, 1, silent), profile.shape, build,
                               warnings, silent);
  const ColouredMesh before = outside_of(tets, segments, arguments.y_up);
  const CutRoughness roughness = smooth_cuts(tets, segments, profile.shape, silent);
  fmt::print(
      "{} at {:g} mm, {} segments: mean turning angle of the cuts {:.2f} rad before, "
      "{:.2f} rad after smoothing ({:+.0f} %)\n",
      model.input.file, arguments.size_mm, segments.count, roughness.before_rad,
      roughness.after_rad, 100 * (roughness.after_rad / roughness.before_rad - 1));
  if (arguments.out.empty()) return;
  write_file_whole(arguments.out,
                   png_bytes(cut_picture(before, outside_of(tets, segments, arguments.y_up))));
}

}  // namespace

void add_cuts(CLI::App& program) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* verb = program.add_subcommand("cuts", "cuts before and after smoothing");
  verb->add_option("MODEL", arguments->model)->required();
  verb->add_option("--profile", arguments->profile)->capture_default_str();
  verb->add_option("--size", arguments->size_mm, "longest side, mm")->capture_default_str();
  verb->add_flag("--y-up", arguments->y_up, "the file's y axis points up");
  verb->add_option("--out", arguments->out, "a PNG: before on the left, after on the right");
  verb->callback([arguments] { run(*arguments); });
}

}  // namespace packmerger::bench
