#include "pack/separate/distance_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pack/maps/columns.h"

namespace packmerger {
namespace {

constexpr int kBand = 1;  // cells round a triangle's box in which its distance is taken at once
constexpr int kNoTriangle = -1;
constexpr int kSweeps = 8;
constexpr std::int8_t kEntered = 0;  // before the first sweep, which looks at all

// Of a sample, x fastest; size: samples along each axis.
std::size_t index_of(const std::array<int, 3>& at, const std::array<int, 3>& size) {
  return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(size[1]) +
          static_cast<std::size_t>(at[1])) *
             static_cast<std::size_t>(size[0]) +
         static_cast<std::size_t>(at[0]);
}

// The closest triangle of every sample, found in a narrow band and handed on from sample to
// sample, as in the fast sweeping method (Zhao, 2005).
class Closest {
 public:
  Closest(const Mesh& surface, const Vec3& low, double pitch, const std::array<int, 3>& size)
      : low_(low), pitch_(pitch), size_(size) {
    const std::size_t samples = index_of({0, 0, size[2]}, size);
    squared_.assign(samples, std::numeric_limits<double>::max());
    triangle_.assign(samples, kNoTriangle);
    for (std::size_t i = 0; i < surface.n_triangles(); ++i)
      triangles_.push_back(surface.corners(i));
    for (std::size_t i = 0; i < triangles_.size(); ++i) enter(static_cast<int>(i));
    changed_.assign(samples, kEntered);
    for (int sweep = 0; sweep < kSweeps; ++sweep) hand_on(sweep);
  }

  double distance(std::size_t sample) const { return std::sqrt(squared_[sample]); }

 private:
  bool offer(const std::array<int, 3>& at, std::size_t sample, int triangle) {
    const double squared = squared_distance(low_ + pitch_ * Vec3(at[0], at[1], at[2]),
                                            triangles_[static_cast<std::size_t>(triangle)]);
    if (squared >= squared_[sample]) return false;
    squared_[sample] = squared;
    triangle_[sample] = triangle;
    return true;
  }

  void enter(int triangle) {
    Box3 box;
    for (const Vec3& corner : triangles_[static_cast<std::size_t>(triangle)]) box.extend(corner);
    std::array<int, 3> first{};
    std::array<int, 3> last{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const double from = (box.min()[axis] - low_[axis]) / pitch_;
      const double to = (box.max()[axis] - low_[axis]) / pitch_;
      first[k] = std::max(0, static_cast<int>(std::floor(from)) - kBand);
      last[k] = std::min(size_[k] - 1, static_cast<int>(std::ceil(to)) + kBand);
    }
    std::array<int, 3> at{};
    for (at[2] = first[2]; at[2] <= last[2]; ++at[2])
      for (at[1] = first[1]; at[1] <= last[1]; ++at[1])
        for (at[0] = first[0]; at[0] <= last[0]; ++at[0]) offer(at, index_of(at, size_), triangle);
  }

  // Once in each of the eight directions. What a neighbour offered in the last sweep that came from
  // its side need not be tried again.
  void hand_on(int sweep) {
    std::array<int, 3> step{};
    std::array<int, 3> last_from_there{};
    std::array<std::ptrdiff_t, 3> stride{1, size_[0],
                                         static_cast<std::ptrdiff_t>(size_[0]) * size_[1]};
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const auto side = [k](int of_sweep) { return of_sweep >> k & 1; };
      step[axis] = side(sweep) != 0 ? -1 : 1;
      stride[axis] *= step[axis];
      last_from_there[axis] = sweep - 1;
      while (last_from_there[axis] >= 0 && side(last_from_there[axis]) != side(sweep))
        --last_from_there[axis];
    }
    std::array<int, 3> at{};
    const auto begin = [&](std::size_t k) { return step[k] > 0 ? 0 : size_[k] - 1; };
    const auto within = [&](std::size_t k) { return at[k] >= 0 && at[k] < size_[k]; };
    for (at[2] = begin(2); within(2); at[2] += step[2])
      for (at[1] = begin(1); within(1); at[1] += step[1])
        for (at[0] = begin(0); within(0); at[0] += step[0]) {
          const std::size_t sample = index_of(at, size_);
          for (std::size_t k = 0; k < 3; ++k) {
            if (at[k] == begin(k)) continue;
            const auto before =
                static_cast<std::size_t>(static_cast<std::ptrdiff_t>(sample) - stride[k]);
            if (changed_[before] <= last_from_there[k]) continue;
            const int triangle = triangle_[before];
            if (triangle != kNoTriangle && triangle != triangle_[sample] &&
                offer(at, sample, triangle))
              changed_[sample] = static_cast<std::int8_t>(sweep);
          }
        }
  }

  std::vector<std::array<Vec3, 3>> triangles_;
  Vec3 low_;
  double pitch_;
  std::array<int, 3> size_;
  std::vector<double> squared_;
  std::vector<int> triangle_;
  std::vector<std::int8_t> changed_;  // the sweep that did last
};

}  // namespace

// By the region in which the point lies: of a corner, an edge or the face (Ericson, Real-Time
// Collision Detection, 5.1.5).
double squared_distance(const Vec3& p, const std::array<Vec3, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3 ab = b - a;
  const Vec3 ac = c - a;
  const Vec3 ap = p - a;
  const double ab_a = ab.dot(ap);
  const double ac_a = ac.dot(ap);
  if (ab_a <= 0 && ac_a <= 0) return ap.squaredNorm();
  const Vec3 bp = p - b;
  const double ab_b = ab.dot(bp);
  const double ac_b = ac.dot(bp);
  if (ab_b >= 0 && ac_b <= ab_b) return bp.squaredNorm();
  const double vc = ab_a * ac_b - ab_b * ac_a;
  if (vc <= 0 && ab_a >= 0 && ab_b <= 0) return (ap - ab * (ab_a / (ab_a - ab_b))).squaredNorm();
  const Vec3 cp = p - c;
  const double ab_c = ab.dot(cp);
  const double ac_c = ac.dot(cp);
  if (ac_c >= 0 && ab_c <= ac_c) return cp.squaredNorm();
  const double vb = ab_c * ac_a - ab_a * ac_c;
  if (vb <= 0 && ac_a >= 0 && ac_c <= 0) return (ap - ac * (ac_a / (ac_a - ac_c))).squaredNorm();
  const double va = ab_b * ac_c - ab_c * ac_b;
  const double to_b = ab_c - ac_c;
  const double to_c = ac_b - ab_b;
  if (va <= 0 && to_c >= 0 && to_b >= 0)
    return (bp - (c - b) * (to_c / (to_c + to_b))).squaredNorm();
  const double sum = va + vb + vc;
  return (ap - ab * (vb / sum) - ac * (vc / sum)).squaredNorm();
}

DistanceGrid::DistanceGrid(const Mesh& surface, double pitch_mm, double reach_mm)
    : pitch_(static_cast<float>(pitch_mm)) {
  const double pitch = pitch_;
  const Box3 box = bounding_box(surface);
  low_ = (box.min() - Vec3::Constant(reach_mm + pitch)).cast<float>();
  const Vec3 low = low_.cast<double>();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    size_[k] =
        2 + static_cast<int>(std::ceil((box.max()[axis] + reach_mm + pitch - low[axis]) / pitch));
    high_[axis] = low_[axis] + pitch_ * static_cast<float>(size_[k] - 1);
  }
  const Closest closest(surface, low, pitch, size_);
  distance_.resize(index_of({0, 0, size_[2]}, size_));
  for (std::size_t i = 0; i < distance_.size(); ++i)
    distance_[i] = static_cast<float>(closest.distance(i));

  // Lines through the centres of cells are those through the samples of a grid half a cell aside.
  Pose aside = Pose::Identity();
  aside.translation() = Vec3(pitch / 2, pitch / 2, 0) - low;
  const std::vector<Crossing> crossings = sorted_crossings({transformed(surface, aside)}, pitch, 0);
  int depth = 0;
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    const Crossing& here = crossings[i];
    const Crossing& next = crossings[i + 1];
    if (i > 0 && (here.row != crossings[i - 1].row || here.column != crossings[i - 1].column))
      depth = 0;
    depth += here.enters ? 1 : -1;
    if (depth <= 0 || next.row != here.row || next.column != here.column) continue;
    const int last = std::min(size_[2] - 1, static_cast<int>(std::floor(next.z / pitch)));
    for (int z = std::max(0, static_cast<int>(std::ceil(here.z / pitch))); z <= last; ++z) {
      float& distance = distance_[index_of({here.column, here.row, z}, size_)];
      distance = -std::abs(distance);
    }
  }
}

DistanceGrid::Cell DistanceGrid::cell(const Vec3f& point) const {
  const Vec3f at = (point - low_) / pitch_;
  // Written so that a point that is no number is not within.
  const bool within =
      at.x() >= 0 && at.y() >= 0 && at.z() >= 0 && at.x() < static_cast<float>(size_[0] - 1) &&
      at.y() < static_cast<float>(size_[1] - 1) && at.z() < static_cast<float>(size_[2] - 1);
  if (!within) return {};
  const int x = static_cast<int>(at.x());
  const int y = static_cast<int>(at.y());
  const int z = static_cast<int>(at.z());
  return {&distance_[index_of({x, y, z}, size_)],
          at - Vec3f(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z))};
}

float DistanceGrid::at(const Vec3f& point) const {
  const Cell here = cell(point);
  if (here.first == nullptr) return kFar;
  const float* near = here.first;
  const float* far = near + static_cast<std::ptrdiff_t>(size_[0]) * size_[1];
  const std::ptrdiff_t row = size_[0];
  const auto along_x = [&](const float* c) { return c[0] + here.inside.x() * (c[1] - c[0]); };
  const auto along_y = [&](const float* c) {
    const float a = along_x(c);
    return a + here.inside.y() * (along_x(c + row) - a);
  };
  const float a = along_y(near);
  return a + here.inside.z() * (along_y(far) - a);
}

float DistanceGrid::at(const Vec3f& point, Vec3f& gradient) const {
  const Cell here = cell(point);
  if (here.first == nullptr) return kFar;
  const float fx = here.inside.x();
  const float fy = here.inside.y();
  const float fz = here.inside.z();
  const std::ptrdiff_t row = size_[0];
  // By y and z: the value along x at both ends, and its slope.
  const auto line = [&](const float* c) {
    return std::pair<float, float>(c[0] + fx * (c[1] - c[0]), c[1] - c[0]);
  };
  const float* near = here.first;
  const float* far = near + row * size_[1];
  const auto [a, slope_a] = line(near);
  const auto [b, slope_b] = line(near + row);
  const auto [c, slope_c] = line(far);
  const auto [d, slope_d] = line(far + row);
  const float ab = a + fy * (b - a);
  const float cd = c + fy * (d - c);
  const float slope_ab = slope_a + fy * (slope_b - slope_a);
  const float slope_cd = slope_c + fy * (slope_d - slope_c);
  gradient =
      Vec3f(slope_ab + fz * (slope_cd - slope_ab), (b - a) + fz * ((d - c) - (b - a)), cd - ab) /
      pitch_;
  return ab + fz * (cd - ab);
}

}  // namespace packmerger
