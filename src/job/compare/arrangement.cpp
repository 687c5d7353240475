#include "job/compare/arrangement.h"

#include "printers/layers/support_volume.h"
#include "printers/slice/slice.h"

namespace packmerger {

std::vector<Tray> trays_of(const Arrangement& arrangement) {
  std::vector<Tray> trays(arrangement.trays);
  for (const JobPart& part : arrangement.parts)
    trays[part.tray - 1].parts.push_back(transformed(part.surface, part.pose));
  return trays;
}

Assembly assembly_of(const Arrangement& arrangement) {
  Assembly assembly;
  assembly.parts = static_cast<int>(arrangement.parts.size());
  assembly.joints = 0;
  for (const JobPart& part : arrangement.parts)
    assembly.joints += static_cast<int>(part.neighbours.size());
  assembly.joints /= 2;  // each is told by both sides
  return assembly;
}

Room whole_room(const Profile& profile) {
  if (profile.technology != Technology::kPowder)
    return {Vec3::Zero(), profile.build(), profile.plate()};
  const double gap_mm = profile.pack.gap_mm;
  const Vec3 corner = Vec3::Constant(gap_mm);
  return {corner, profile.build() - 2 * corner, profile.plate().drawn_in(Vec2(0, 0), gap_mm)};
}

Room room_of(const Profile& profile) {
  if (profile.technology == Technology::kPowder) return whole_room(profile);
  const double margin = slicer_margin_mm(profile);
  const Vec3 corner(margin, margin, 0);
  return {corner, profile.build() - 2 * corner, profile.plate().drawn_in(Vec2(0, 0), margin)};
}

TrayMeasure measure(const Tray& tray, const Profile& profile) {
  TrayMeasure result;
  Box3 box;
  std::vector<const Mesh*> parts;
  for (const Mesh& part : tray.parts) {
    box.extend(bounding_box(part));
    result.material_mm3 += volume_mm3(part);
    parts.push_back(&part);
  }
  result.size_mm = {box.sizes().x(), box.sizes().y(), box.max().z()};
  result.support_mm3 = support_volume_mm3(parts, radians(profile.support_angle_deg));
  result.parts = static_cast<int>(parts.size());
  return result;
}

}  // namespace packmerger
