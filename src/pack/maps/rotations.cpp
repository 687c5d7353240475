#include "pack/maps/rotations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace packmerger {
namespace {

constexpr double kSameDirection = 1e-6;

struct SineCosine {
  double sine;
  double cosine;
};

SineCosine exact_at_right_angles(double angle) {
  const double quarters = angle / (std::numbers::pi / 2);
  const double nearest = std::round(quarters);
  if (std::abs(quarters - nearest) > 1e-9) return {std::sin(angle), std::cos(angle)};
  constexpr std::array<double, 4> kSines{0, 1, 0, -1};
  const int quarter = ((static_cast<int>(nearest) % 4) + 4) % 4;
  return {kSines[static_cast<std::size_t>(quarter)],
          kSines[static_cast<std::size_t>((quarter + 1) % 4)]};
}

Mat3 turn_about_x(double angle) {
  const auto [s, c] = exact_at_right_angles(angle);
  Mat3 turn;
  turn << 1, 0, 0, 0, c, -s, 0, s, c;
  return turn;
}

Mat3 turn_about_y(double angle) {
  const auto [s, c] = exact_at_right_angles(angle);
  Mat3 turn;
  turn << c, 0, s, 0, 1, 0, -s, 0, c;
  return turn;
}

}  // namespace

Mat3 turn_about_z(double angle) {
  const auto [s, c] = exact_at_right_angles(angle);
  Mat3 turn;
  turn << c, -s, 0, s, c, 0, 0, 0, 1;
  return turn;
}

RotationSet rotation_set(double step) {
  RotationSet set{{Mat3::Identity()}, {0}};
  if (step <= 0) return set;
  const int steps = std::max(1, static_cast<int>(std::floor(2 * std::numbers::pi / step + 1e-9)));
  for (int turn = 1; turn < steps; ++turn) set.turns.push_back(turn * step);
  for (int i = 0; i < steps; ++i)
    for (int j = 0; j < steps; ++j) {
      const Mat3 turn = turn_about_y(j * step) * turn_about_x(i * step);
      // The model direction that points up is the last row.
      const bool repeated =
          std::any_of(set.ways_up.begin(), set.ways_up.end(), [&turn](const Mat3& other) {
            return (other.row(2) - turn.row(2)).norm() < kSameDirection;
          });
      if (!repeated) set.ways_up.push_back(turn);
    }
  return set;
}

std::vector<Mat3> spread_ways(int count) {
  std::vector<Mat3> ways;
  for (const Vec3& up : spread_directions(count)) ways.push_back(turn_between(up, Vec3::UnitZ()));
  return ways;
}

Mat3 turn_between(const Vec3& from, const Vec3& to) {
  // Near opposite directions Eigen's quaternion is longer than 1 by what its axis lost to rounding.
  return Eigen::Quaterniond::FromTwoVectors(from, to).normalized().toRotationMatrix();
}

RotationKey key_of(const Mat3& rotation) {
  RotationKey key{};
  for (int i = 0; i < 9; ++i)
    key[static_cast<std::size_t>(i)] = std::llround(rotation(i / 3, i % 3) * 1e9);
  return key;
}

}  // namespace packmerger
