#include "shape/cut/stand_alone.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace packmerger {
namespace {

constexpr int kDirections = 32;        // of the regular set
constexpr int kCoarseStride = 3;       // of the samples looked at in the first round
constexpr std::size_t kKept = 4;       // directions looked at with all samples
constexpr double kCellSpacings = 1.6;  // a cell of the map, in spacings of the samples
// How far above the truth a cell's highest sample lies, in halves of the step to the next cell: in
// a map of all the matter 1, less with samples that may miss a cell's corners.
constexpr double kExcess = 0.6;
constexpr double kCapSpacings = 0.75;  // samples nearer to a cut are seen on it, too
constexpr std::array<double, 2> kRefineBy{0.2, 0.08};  // radians

struct Frame {
  Vec3 x, y, up;
  explicit Frame(const Vec3& direction) : up(direction) {
    x = up.unitOrthogonal();
    y = up.cross(x);
  }
};

// The volume under the upper envelope for one direction after the other.
class EnvelopeMap {
 public:
  // spacing: of the points.
  double volume_mm3(const std::vector<Eigen::Vector3f>& points, std::size_t stride,
                    double spacing_mm, const Vec3& up) {
    const Frame frame(up);
    const Eigen::Vector3f fx = frame.x.cast<float>(), fy = frame.y.cast<float>(),
                          fz = up.cast<float>();
    const std::size_t count = (points.size() + stride - 1) / stride;
    seen_.resize(count);
    Eigen::Vector3f low = Eigen::Vector3f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector3f high = -low;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f& p = points[i * stride];
      seen_[i] = {fx.dot(p), fy.dot(p), fz.dot(p)};
      low = low.cwiseMin(seen_[i]);
      high = high.cwiseMax(seen_[i]);
    }
    const auto cell = static_cast<float>(kCellSpacings * spacing_mm);
    // a rim of empty cells all round
    columns_ = static_cast<int>((high.x() - low.x()) / cell) + 3;
    rows_ = static_cast<int>((high.y() - low.y()) / cell) + 3;
    top_.assign(static_cast<std::size_t>(columns_) * rows_, 0);
    for (const Eigen::Vector3f& p : seen_) {
      const int column = static_cast<int>((p.x() - low.x()) / cell) + 1;
      const int row = static_cast<int>((p.y() - low.y()) / cell) + 1;
      float& top = top_[static_cast<std::size_t>(row) * columns_ + column];
      // the least positive number tells a cell at plate level from an empty one
      top = std::max({top, p.z() - low.z(), std::numeric_limits<float>::min()});
    }
    close();
    double sum = 0, variation = 0;
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        const std::size_t i = static_cast<std::size_t>(row) * columns_ + column;
        sum += closed_[i];
        if (column > 0) variation += std::abs(closed_[i] - closed_[i - 1]);
        if (row > 0) variation += std::abs(closed_[i] - closed_[i - columns_]);
      }
    return static_cast<double>(cell) * cell * (sum - kExcess / 2 * variation);
  }

 private:
  // A cell is at least as high as the lower of two opposite neighbours.
  void close() {
    closed_ = top_;
    for (int row = 1; row + 1 < rows_; ++row)
      for (int column = 1; column + 1 < columns_; ++column) {
        const std::size_t i = static_cast<std::size_t>(row) * columns_ + column;
        closed_[i] = std::max({top_[i], std::min(top_[i - 1], top_[i + 1]),
                               std::min(top_[i - columns_], top_[i + columns_])});
      }
  }

  int columns_ = 0, rows_ = 0;
  std::vector<Eigen::Vector3f> seen_;
  std::vector<float> top_, closed_;
};

std::vector<Eigen::Vector3f> points_of(const MatterSamples& samples, const PieceShape& piece) {
  std::vector<Eigen::Vector3f> points;
  points.reserve(piece.samples.size() * 3 / 2);
  for (const int sample : piece.samples) points.push_back(samples.points[sample].cast<float>());
  const std::size_t inside = points.size();
  const auto reach = static_cast<float>(kCapSpacings * samples.spacing_mm);
  for (const Plane& plane : piece.planes) {
    const Eigen::Vector3f normal = plane.normal().cast<float>();
    const auto offset = static_cast<float>(plane.offset());
    for (std::size_t i = 0; i < inside; ++i) {
      const float distance = normal.dot(points[i]) + offset;
      if (std::abs(distance) < reach) points.push_back(points[i] - distance * normal);
    }
  }
  return points;
}

// Of the down-facing surface, weighted with its height: how much faces down steeply enough.
double steep_share(const MatterSamples& samples, const PieceShape& piece, double support_angle,
                   const Vec3& up) {
  if (support_angle <= 0) return 1;
  double plate = std::numeric_limits<double>::infinity();
  for (const int sample : piece.samples) plate = std::min(plate, up.dot(samples.points[sample]));
  double all = 0, steep = 0;
  const double limit = std::sin(support_angle);
  for (const int sample : piece.samples) {
    const Vec3& area = samples.areas_mm2[sample];
    const double down = -up.dot(area);
    if (down <= 0) continue;
    const double volume = down * (up.dot(samples.points[sample]) - plate);
    all += volume;
    if (down > limit * area.norm()) steep += volume;
  }
  return all > 0 ? steep / all : 1;
}

std::vector<Vec3> directions_of(const MatterSamples& samples, const PieceShape& piece) {
  static const std::vector<Vec3> regular = spread_directions(kDirections);
  std::vector<Vec3> directions = regular;
  Vec3 mean = Vec3::Zero();
  Mat3 moments = Mat3::Zero();
  for (const int sample : piece.samples) mean += samples.points[sample];
  mean /= static_cast<double>(piece.samples.size());
  for (const int sample : piece.samples) {
    const Vec3 arm = samples.points[sample] - mean;
    moments += arm * arm.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> axes;
  axes.computeDirect(moments);
  std::vector<Vec3> own;
  for (int i = 0; i < 3; ++i) own.push_back(axes.eigenvectors().col(i).normalized());
  for (const Plane& plane : piece.planes) own.push_back(plane.normal());
  for (const Vec3& direction : own) {
    directions.push_back(direction);
    directions.push_back(-direction);
  }
  return directions;
}

}  // namespace

Standing stand_alone(const MatterSamples& samples, const PieceShape& piece, double support_angle) {
  if (piece.samples.empty()) return {};
  const std::vector<Eigen::Vector3f> points = points_of(samples, piece);
  thread_local EnvelopeMap map;
  const auto support = [&](const Vec3& up, std::size_t stride) {
    const double spacing = samples.spacing_mm * std::cbrt(static_cast<double>(stride));
    const double under = map.volume_mm3(points, stride, spacing, up);
    return std::max(0.0, under - piece.volume_mm3) * steep_share(samples, piece, support_angle, up);
  };

  std::vector<Standing> ranked;
  for (const Vec3& up : directions_of(samples, piece))
    ranked.push_back({support(up, kCoarseStride), up});
  std::stable_sort(ranked.begin(), ranked.end(), [](const Standing& a, const Standing& b) {
    return a.support_mm3 < b.support_mm3;
  });
  Standing best{std::numeric_limits<double>::infinity(), Vec3::UnitZ()};
  const auto consider = [&](const Vec3& up) {
    const double needed = support(up, 1);
    if (needed < best.support_mm3) best = {needed, up};
  };
  for (std::size_t i = 0; i < std::min(kKept, ranked.size()); ++i) consider(ranked[i].up);
  for (const double by : kRefineBy) {
    const Frame frame(best.up);
    for (const Vec3& way : {frame.x, Vec3(-frame.x), frame.y, Vec3(-frame.y)})
      consider((frame.up + std::tan(by) * way).normalized());
  }
  return best;
}

}  // namespace packmerger
