#include "model/stl.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr double kLargestCoordinateMm = 1e9;
constexpr double kNegativeZeroMm = 1e-6;

using Bits = std::array<std::uint32_t, 3>;

struct BitsHash {
  std::size_t operator()(const Bits& bits) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15U;
    for (const std::uint32_t word : bits) {
      hash = (hash ^ word) * 0xff51afd7ed558ccdU;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

Bits bits_of(const Eigen::Vector3f& point) {
  Bits bits{};
  // adding zero makes a negative zero positive: they are equal, so they must look equal
  for (int i = 0; i < 3; ++i) bits[i] = std::bit_cast<std::uint32_t>(point[i] + 0.0F);
  return bits;
}

Eigen::Vector3f rounded(const Vec3& point) {
  Eigen::Vector3f result;
  for (int i = 0; i < 3; ++i) {
    const double value = point[i];
    if (!(std::abs(value) <= kLargestCoordinateMm))
      throw Error(Fault::kBadInput, "A coordinate is not a number or beyond 1000 km",
                  "Check the model's unit and scale.");
    result[i] = value < 0 && value > -kNegativeZeroMm ? 0.0F : static_cast<float>(value) + 0.0F;
  }
  return result;
}

// The nearest free place on a little lattice towards the positive side, so that nothing that
// stands on the plate sinks below it.
Eigen::Vector3f moved_aside(const Eigen::Vector3f& point,
                            const std::unordered_set<Bits, BitsHash>& taken) {
  const float step = std::max(point.cwiseAbs().maxCoeff(), 1.0F) * 0x1.0p-22F;
  for (int size = 1;; ++size)
    for (int x = size; x >= 0; --x)
      for (int y = size - x; y >= 0; --y) {
        const int z = size - x - y;
        const Eigen::Vector3f place =
            point + step * Eigen::Vector3f(static_cast<float>(x), static_cast<float>(y),
                                           static_cast<float>(z));
        if (!taken.contains(bits_of(place))) return place;
      }
}

void append_floats(std::string& bytes, const Eigen::Vector3f& values) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(values.data()), 3 * sizeof(float));
}

Eigen::Vector3f unit_normal(const Mesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  const Vec3 normal = (b - a).cross(c - a);
  const double length = normal.norm();
  if (length <= 0) return Eigen::Vector3f::Zero();
  return (normal / length).cast<float>();
}

}  // namespace

std::vector<std::vector<Eigen::Vector3f>> float_points(const std::vector<const Mesh*>& meshes) {
  std::unordered_set<Bits, BitsHash> taken;
  std::vector<std::vector<Eigen::Vector3f>> all;
  for (const Mesh* mesh : meshes) {
    std::vector<Eigen::Vector3f>& points = all.emplace_back();
    points.reserve(mesh->n_points());
    for (const Vec3& exact : mesh->points()) {
      Eigen::Vector3f point = rounded(exact);
      if (taken.contains(bits_of(point))) point = moved_aside(point, taken);
      taken.insert(bits_of(point));
      points.push_back(point);
    }
  }
  return all;
}

std::string binary_stl(const std::vector<const Mesh*>& meshes) {
  const auto points = float_points(meshes);
  std::uint32_t triangles = 0;
  for (const Mesh* mesh : meshes) triangles += static_cast<std::uint32_t>(mesh->n_triangles());

  std::string bytes = "PackMerger, binary STL, mm";  // must not begin with "solid"
  bytes.resize(80, ' ');
  bytes.reserve(84 + std::size_t{50} * triangles);
  bytes.append(reinterpret_cast<const char*>(&triangles), sizeof triangles);
  for (std::size_t m = 0; m < meshes.size(); ++m)
    for (std::size_t t = 0; t < meshes[m]->n_triangles(); ++t) {
      append_floats(bytes, unit_normal(*meshes[m], t));
      for (const int corner : meshes[m]->triangles()[t]) append_floats(bytes, points[m][corner]);
      bytes.append(2, '\0');
    }
  return bytes;
}

}  // namespace packmerger
