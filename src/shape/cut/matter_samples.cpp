#include "shape/cut/matter_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "base/error.h"
#include "shape/divide/boundary_surface.h"

namespace packmerger {
namespace {

constexpr double kShort = 1.6;     // spacings: the longest short link
constexpr double kCoverage = 1.5;  // cubes that matter touches, over those it would fill

using Cube = std::uint64_t;

class Cubes {
 public:
  Cubes(const Vec3& corner, double side_mm) : corner_(corner), side_mm_(side_mm) {}
  Cube of(const Vec3& point) const {
    const Vec3 at = (point - corner_) / side_mm_;
    return at_offset(kMiddle, static_cast<int>(std::floor(at.x())),
                     static_cast<int>(std::floor(at.y())), static_cast<int>(std::floor(at.z())));
  }
  static Cube at_offset(Cube cube, int x, int y, int z) {
    return cube + (static_cast<Cube>(static_cast<std::int64_t>(x)) << 42) +
           (static_cast<Cube>(static_cast<std::int64_t>(y)) << 21) +
           static_cast<Cube>(static_cast<std::int64_t>(z));
  }

 private:
  // The middle of each coordinate's 21 bits, so that no neighbour borrows from the next field.
  static constexpr Cube kMiddle = (Cube{1} << 62) + (Cube{1} << 41) + (Cube{1} << 20);
  Vec3 corner_;
  double side_mm_;
};

struct Candidate {
  Cube cube;
  bool inside;  // of the matter; surfaces come first
  Vec3 point;
  double volume_mm3;
  Vec3 area_mm2;
};

// A lattice over each tetrahedron, no wider than the spacing.
std::vector<Candidate> candidates(const TetMesh& mesh, const Cubes& cubes, double spacing_mm) {
  std::vector<Candidate> found;
  for (int t = 0; t < mesh.count(); ++t) {
    std::array<Vec3, 4> p;
    for (int i = 0; i < 4; ++i) p[i] = mesh.points[mesh.tetrahedra[t][i]];
    double longest = 0;
    for (int i = 0; i < 4; ++i)
      for (int j = 0; j < i; ++j) longest = std::max(longest, (p[i] - p[j]).norm());
    const int n = std::max(1, static_cast<int>(std::ceil(longest / spacing_mm)));
    const double share = mesh.volume_mm3(t) / ((n + 1) * (n + 2) * (n + 3) / 6);
    std::array<Vec3, 4> face_share;
    for (int f = 0; f < 4; ++f) {
      face_share[f] = Vec3::Zero();
      if (mesh.neighbours[t][f] >= 0) continue;
      const auto [a, b, c] = face_corners(mesh, t, f);
      face_share[f] = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]) /
                      ((n + 1) * (n + 2));
    }
    for (int a = 0; a <= n; ++a)
      for (int b = 0; a + b <= n; ++b)
        for (int c = 0; a + b + c <= n; ++c) {
          const std::array<int, 4> weight{a, b, c, n - a - b - c};
          Candidate one{0, true, Vec3::Zero(), share, Vec3::Zero()};
          for (int i = 0; i < 4; ++i) {
            one.point += weight[i] * p[i] / n;
            if (weight[i] > 0 || mesh.neighbours[t][i] >= 0) continue;
            one.inside = false;
            one.area_mm2 += face_share[i];
          }
          one.cube = cubes.of(one.point);
          found.push_back(one);
        }
  }
  return found;
}

int index_of(const std::vector<Cube>& cubes, Cube cube) {
  const auto at = std::lower_bound(cubes.begin(), cubes.end(), cube);
  return at != cubes.end() && *at == cube ? static_cast<int>(at - cubes.begin()) : -1;
}

void link(MatterSamples& samples, const std::vector<Cube>& cubes) {
  const double reach = kShort * samples.spacing_mm;
  double lengths = 0;
  std::vector<int> far;
  for (int i = 0; i < samples.count(); ++i) {
    samples.first_link.push_back(static_cast<int>(samples.links.size()));
    far.clear();
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y) {
        // three cubes in a row follow each other in the sorted list
        const Cube low = Cubes::at_offset(cubes[i], x, y, -1);
        auto at =
            static_cast<int>(std::lower_bound(cubes.begin(), cubes.end(), low) - cubes.begin());
        for (; at < samples.count() && cubes[at] <= low + 2; ++at) {
          if (at == i) continue;
          const double length = (samples.points[at] - samples.points[i]).norm();
          (length > reach ? far : samples.links).push_back(at);
          if (length <= reach) lengths += length / 2;  // each is met from both ends
        }
      }
    samples.first_long_link.push_back(static_cast<int>(samples.links.size()));
    samples.links.insert(samples.links.end(), far.begin(), far.end());
  }
  samples.first_link.push_back(static_cast<int>(samples.links.size()));
  // A link at a random angle crosses a plane with half its length on average.
  samples.area_per_link_mm2 = lengths > 0 ? samples.volume_mm3 / (lengths / 2) : 0;
}

void find_cavities(MatterSamples& samples, const TetMesh& mesh, const Cubes& grid,
                   const std::vector<Cube>& cubes) {
  const BoundarySurface surface = boundary_surface(mesh);
  for (const std::vector<int>& cavity : cavity_faces(surface)) {
    std::vector<int> around;
    for (const int face : cavity)
      for (const int corner : surface.faces[face].corners)
        around.push_back(index_of(cubes, grid.of(mesh.points[corner])));
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    samples.round_cavities.push_back(std::move(around));
  }
}

}  // namespace

MatterSamples sample_matter(const TetMesh& mesh, int target) {
  if (mesh.count() == 0)
    throw Error(Fault::kBadInput, "The mesh holds no tetrahedron",
                "Repair the model and try again.");
  MatterSamples samples;
  samples.volume_mm3 = total_volume_mm3(mesh);
  samples.spacing_mm = std::cbrt(kCoverage * samples.volume_mm3 / std::max(1, target));
  Box3 box;
  for (const Vec3& point : mesh.points) box.extend(point);
  const Cubes grid(box.min(), samples.spacing_mm);

  std::vector<Candidate> all = candidates(mesh, grid, samples.spacing_mm);
  std::vector<int> order(all.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::tie(all[a].cube, all[a].inside, a) < std::tie(all[b].cube, all[b].inside, b);
  });
  std::vector<Cube> cubes;
  for (const int i : order) {
    const Candidate& one = all[i];
    if (cubes.empty() || cubes.back() != one.cube) {
      cubes.push_back(one.cube);
      samples.points.push_back(one.point);
      samples.volumes_mm3.push_back(0);
      samples.areas_mm2.push_back(Vec3::Zero());
    }
    samples.volumes_mm3.back() += one.volume_mm3;
    samples.areas_mm2.back() += one.area_mm2;
  }
  link(samples, cubes);
  find_cavities(samples, mesh, grid, cubes);
  for (int t = 0; t < mesh.count(); ++t) {
    const int at_centroid = index_of(cubes, grid.of(mesh.centroid(t)));
    samples.of_tetrahedron.push_back(
        at_centroid >= 0 ? at_centroid
                         : index_of(cubes, grid.of(mesh.points[mesh.tetrahedra[t][0]])));
  }
  return samples;
}

}  // namespace packmerger
