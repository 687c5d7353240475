#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>

#include "base/error.h"
#include "fixtures/models.h"
#include "shape/read/soup.h"
#include "shape/surface/repair.h"
#include "shape/surface/resample.h"
#include "shape/surface/surface_query.h"
#include "shape/surface/unite_bodies.h"

namespace packmerger {
namespace {

constexpr double kTolerance_mm = 0.1;

class Dice {
 public:
  explicit Dice(unsigned number) : engine_(number) {}
  int up_to(int most) { return static_cast<int>(engine_() % static_cast<unsigned>(most + 1)); }
  double fraction() { return static_cast<double>(engine_() % 10000) / 10000; }
  Vec3 place(bool on_lattice, int most_mm) {
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = on_lattice ? up_to(most_mm) : fraction() * most_mm;
    return p;
  }

 private:
  std::mt19937 engine_;
};

TriangleSoup body(Dice& dice, bool on_lattice) {
  const Vec3 low = dice.place(on_lattice, 12);
  switch (dice.up_to(on_lattice ? 1 : 3)) {
    case 2: {
      TriangleSoup ball = fixtures::sphere(3 + 3 * dice.fraction(), 1);
      for (Vec3& p : ball.points) p += low;
      return ball;
    }
    case 3: {
      TriangleSoup ring = fixtures::torus(4, 1 + dice.fraction(), 12, 8);
      for (Vec3& p : ring.points) p = Vec3(p.z(), p.x(), p.y()) + low;
      return ring;
    }
    default:
      return fixtures::box(low, low + dice.place(on_lattice, 8) + Vec3::Constant(1));
  }
}

// 2 to 9 bodies that cross, touch and overlap, as models are drawn that nobody united: every other
// heap is of boxes on a lattice of 1 mm, so that faces, edges and corners fall together.
TriangleSoup heap(unsigned number) {
  Dice dice(number);
  const bool on_lattice = number % 2 == 0;
  TriangleSoup all = body(dice, on_lattice);
  for (int more = 1 + dice.up_to(7); more > 0; --more)
    all = fixtures::together(all, body(dice, on_lattice));
  return all;
}

// Of boxes on the lattice: what the surface winds around, counted in cells of it.
double lattice_volume_mm3(const Mesh& mesh) {
  const SurfaceQuery query(mesh);
  const Box3 box = bounding_box(mesh);
  double cells = 0;
  for (double x = box.min().x() + 0.5; x < box.max().x(); ++x)
    for (double y = box.min().y() + 0.5; y < box.max().y(); ++y)
      for (double z = box.min().z() + 0.5; z < box.max().z(); ++z)
        if (query.winding_number(Vec3(x, y, z)) != 0) ++cells;
  return cells;
}

// `cmake --build build --target long_heaps` tries some hundred.
unsigned heaps() {
  const char* many = std::getenv("PACKMERGER_HEAPS");
  return many != nullptr ? static_cast<unsigned>(std::stoul(many)) : 30;
}

TEST(Heaps, AreUnitedWhateverCrossesOrTouches) {
  unsigned refused = 0;
  for (unsigned number = 0; number < heaps(); ++number) {
    SCOPED_TRACE(number);
    Warnings warnings;
    const Mesh model = repair(heap(number), warnings, Progress());
    if (!self_intersects(model)) continue;
    Resampled resampled;
    try {
      resampled = resample(model, kTolerance_mm, Progress());
    } catch (const Error& error) {  // a refusal is an answer, a rare one
      EXPECT_EQ(error.fault(), Fault::kBadInput);
      ++refused;
      continue;
    }
    EXPECT_TRUE(is_closed_manifold(resampled.surface));
    EXPECT_FALSE(self_intersects(resampled.surface));
    EXPECT_LE(resampled.deviation_mm, kTolerance_mm);
    if (number % 2 == 0) {
      EXPECT_NEAR(volume_mm3(resampled.surface), lattice_volume_mm3(model), 2);
    }
  }
  EXPECT_LE(refused, heaps() / 50);
}

TEST(Heaps, AreCountedOnceUndivided) {
  for (unsigned number = 0; number < heaps(); ++number) {
    SCOPED_TRACE(number);
    Warnings warnings;
    const Mesh model = repair(heap(number), warnings, Progress());
    warnings.clear();
    const Mesh united = unite_bodies(model, warnings, Progress());
    EXPECT_TRUE(is_closed_manifold(united));
    for (const Warning& warning : warnings)
      EXPECT_EQ(warning.text.find("could not"), std::string::npos) << warning.text;
    if (number % 2 == 0) {
      EXPECT_NEAR(volume_mm3(united), lattice_volume_mm3(model), 0.1);
    }
  }
}

}  // namespace
}  // namespace packmerger
