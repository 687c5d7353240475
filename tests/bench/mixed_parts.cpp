#include "bench/mixed_parts.h"

#include "base/random.h"
#include "fixtures/models.h"
#include "unit/pack/shapes.h"

namespace packmerger::bench {
namespace {

// A U of two legs on a base, all `thick` mm thick.
Mesh u_shape(double width, double leg, double thick, double depth) {
  return shapes::extruded({{0, 0},
                           {thick, 0},
                           {width - thick, 0},
                           {width, 0},
                           {width, leg},
                           {width - thick, leg},
                           {width - thick, thick},
                           {thick, thick},
                           {thick, leg},
                           {0, leg}},
                          {{0, 1, 7, 8, 9}, {1, 2, 6, 7}, {3, 4, 5, 6, 2}}, depth);
}

Mesh mixed_part(int kind, double s) {
  switch (kind) {
    case 0:
      return shapes::box(Vec3::Constant(22 * s));
    case 1:
      return closed_mesh(fixtures::torus(13 * s, 5.5 * s, 32, 16));
    case 2:
      return shapes::cup(13 * s, 28 * s, 3 * s);
    case 3:
      return shapes::sphere(13 * s, 24);
    case 4:
      return shapes::l_shape(32 * s, 12 * s, 16 * s);
    case 5:
      return u_shape(32 * s, 28 * s, 9 * s, 16 * s);
    default:
      return shapes::tetrahedron(38 * s);
  }
}

}  // namespace

std::vector<PackItem> mixed_items(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<PackItem> items;
  for (int i = 0; i < count; ++i) {
    PackItem item;
    item.surface = mixed_part(i % 7, 0.8 + 0.4 * random.unit());
    item.volume_mm3 = volume_mm3(item.surface);
    item.model = i;
    items.push_back(std::move(item));
  }
  return items;
}

}  // namespace packmerger::bench
