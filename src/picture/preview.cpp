#include "picture/preview.h"

#include <algorithm>
#include <cmath>

#include "picture/part_colour.h"
#include "picture/plate.h"

namespace packmerger {
namespace {

constexpr int kWidth = 1800;
constexpr int kHeight = 1000;
const Vec3 kView(0.22, 1, -0.62);  // from the front left, from above

// The models as their files stand, one beside the other, on a plate of their own that ends at
// x = right_mm. Returns what they cover.
Box3 add_models(Scene& scene, const Job& job, double right_mm) {
  constexpr double kMarginMm = 10;
  std::vector<Box3> boxes;
  double width = kMarginMm;
  double depth = 0;
  double height = 0;
  for (const Mesh& model : job.models) {
    boxes.push_back(bounding_box(model));
    width += boxes.back().sizes().x() + kMarginMm;
    depth = std::max(depth, boxes.back().sizes().y());
    height = std::max(height, boxes.back().sizes().z());
  }
  const double step = std::max(width, depth) < 50 ? 5 : 10;
  width = std::ceil(width / step) * step;
  depth = std::ceil((depth + 2 * kMarginMm) / step) * step;

  const Box3 plate(Vec3(right_mm - width, 0, 0), Vec3(right_mm, depth, height));
  const Ground ground(plate);
  add_plate(scene, ground);
  double x = plate.min().x() + kMarginMm;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Vec3 low(x, (depth - boxes[i].sizes().y()) / 2, 0);
    Pose pose = Pose::Identity();
    pose.translation() = low - boxes[i].min();
    add_standing(scene, job.models[i], pose, model_colour(), ground);
    x += boxes[i].sizes().x() + kMarginMm;
  }
  return plate;
}

int count_trays(const Job& job) {
  int trays = 1;
  for (const JobPart& part : job.parts) trays = std::max(trays, part.tray);
  return trays;
}

}  // namespace

Image preview_picture(const Job& job) {
  const Vec3 build = job.profile.build();
  const double apart = 0.12 * build.x();
  Scene scene;
  std::vector<Box3> all;
  if (!job.models.empty()) all.push_back(add_models(scene, job, -apart));
  for (int tray = 1; tray <= count_trays(job); ++tray) {
    Pose aside = Pose::Identity();
    aside.translation().x() = (tray - 1) * (build.x() + apart);
    const Box3 volume(aside.translation(), aside.translation() + build);
    const Ground ground(volume, job.profile.plate());
    add_plate(scene, ground);
    add_volume(scene, ground);
    for (const JobPart& part : job.parts)
      if (part.tray == tray)
        add_standing(scene, part.surface, aside * part.pose, part_colour(part.id - 1), ground);
    all.push_back(volume);
  }
  return draw(scene, distant_camera(all, kView, kWidth, kHeight), kWidth, kHeight);
}

}  // namespace packmerger
