#include "pack/separate/support_pull.h"

#include "pack/maps/columns.h"

namespace packmerger {

SupportPull support_pull(const std::vector<const Shape*>& shapes, const std::vector<Pose>& poses,
                         double step_mm, double support_angle) {
  std::vector<Mesh> surfaces;
  for (std::size_t i = 0; i < shapes.size(); ++i)
    surfaces.push_back(transformed(shapes[i]->mesh, poses[i]));
  const double area = step_mm * step_mm;
  SupportPull pull;
  pull.gradient = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * shapes.size()));
  const auto add = [&](const Crossing& at, double by) {
    const auto part = static_cast<std::size_t>(at.surface);
    const Vec3 force = by * Vec3(-at.slope.x(), -at.slope.y(), 1);
    const Vec3 arm = Vec3((at.column + 0.5) * step_mm, (at.row + 0.5) * step_mm, at.z) -
                     poses[part].translation();
    const auto first = static_cast<Eigen::Index>(6 * part);
    pull.gradient.segment<3>(first) += arm.cross(force) / shapes[part]->radius_mm;
    pull.gradient.segment<3>(first + 3) += force;
  };
  for_each_void(sorted_crossings(surfaces, step_mm, support_angle), 0,
                [&](const Crossing* floor, const Crossing& roof, double height_mm) {
                  pull.support_mm3 += area * height_mm;
                  add(roof, area);
                  if (floor != nullptr) add(*floor, -area);
                });
  return pull;
}

}  // namespace packmerger
