#include "shape/surface/draw_apart.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

namespace packmerger {
namespace {

// How far a point goes of its shortest edge, at most.
constexpr double kOfEdge = 0.2;

// A triangle at an edge.
struct Side {
  std::pair<int, int> edge;  // its lower end first
  bool is_upward;            // whether the triangle goes from the lower end to the other
  std::size_t triangle;
  std::size_t from;  // corners of the triangle at the edge's ends, lower first
  std::size_t to;
  double angle = 0;  // around the edge, seen against its direction
};

std::vector<Side> sides_of(const TriangleSoup& soup) {
  std::vector<Side> sides;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      const int a = soup.triangles[t][k];
      const int b = soup.triangles[t][next];
      sides.push_back({{std::min(a, b), std::max(a, b)},
                       a < b,
                       t,
                       3 * t + (a < b ? k : next),
                       3 * t + (a < b ? next : k)});
    }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.edge < b.edge; });
  return sides;
}

// Which corners belong to the same fan.
class Corners {
 public:
  explicit Corners(std::size_t corners) : of_(corners) {
    std::iota(of_.begin(), of_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t corner) {
    while (of_[corner] != corner) corner = of_[corner] = of_[of_[corner]];
    return corner;
  }
  void join(const Side& a, const Side& b) {
    join(a.from, b.from);
    join(a.to, b.to);
  }

 private:
  void join(std::size_t a, std::size_t b) {
    const auto [first, second] = std::minmax({of(a), of(b)});
    of_[second] = first;
  }

  std::vector<std::size_t> of_;
};

void sort_around(std::vector<Side>& sides, const TriangleSoup& soup) {
  const Vec3& low = soup.points[sides.front().edge.first];
  const Vec3 along = (soup.points[sides.front().edge.second] - low).normalized();
  const Vec3 x = along.unitOrthogonal();
  const Vec3 y = along.cross(x);
  for (Side& side : sides) {
    const auto& corners = soup.triangles[side.triangle];
    const std::size_t opposite = 3 - side.from % 3 - side.to % 3;
    const Vec3 arm = soup.points[corners[opposite]] - low;
    side.angle = std::atan2(arm.dot(y), arm.dot(x));
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const Side& a, const Side& b) { return a.angle < b.angle; });
}

// Seen against the edge's direction the matter of a downward triangle begins where it is and ends
// at an upward one, as brackets do; equal angles may stand in any order.
void join_around_matter(std::vector<Side> sides, const TriangleSoup& soup, Corners& fans) {
  sort_around(sides, soup);
  std::vector<const Side*> begun;
  for (int round = 0; round < 2; ++round)  // the first bracket may stand anywhere
    for (Side& side : sides) {
      if (side.triangle == soup.triangles.size()) continue;  // joined
      if (!side.is_upward) {
        if (round == 0) begun.push_back(&side);
        continue;
      }
      if (begun.empty()) continue;
      fans.join(*begun.back(), side);
      begun.pop_back();
      side.triangle = soup.triangles.size();
    }
}

// All that a point becomes where one sheet has it.
struct Fan {
  int point = 0;  // in the soup
  Vec3 outwards = Vec3::Zero();
  double step_mm = 0;
};

std::vector<Fan> fans_of(const TriangleSoup& soup, double gap_mm, Corners& corners,
                         std::vector<std::array<int, 3>>& numbered) {
  std::vector<Fan> fans;
  std::vector<int> number(3 * soup.triangles.size(), -1);
  for (std::size_t corner = 0; corner < number.size(); ++corner) {
    const auto& triangle = soup.triangles[corner / 3];
    const Vec3& place = soup.points[triangle[corner % 3]];
    const Vec3 edge = soup.points[triangle[(corner + 1) % 3]] - place;
    const Vec3 other = soup.points[triangle[(corner + 2) % 3]] - place;
    int& at = number[corners.of(corner)];
    if (at < 0) {
      at = static_cast<int>(fans.size());
      fans.push_back({triangle[corner % 3], Vec3::Zero(), gap_mm});
    }
    numbered[corner / 3][corner % 3] = at;
    const Vec3 normal = edge.cross(other);
    if (!(normal.norm() > 0)) continue;
    fans[at].outwards += std::atan2(normal.norm(), edge.dot(other)) * normal.normalized();
    fans[at].step_mm = std::min(fans[at].step_mm, kOfEdge * edge.norm());
  }
  return fans;
}

}  // namespace

TriangleSoup drawn_apart(const TriangleSoup& soup, double gap_mm) {
  const std::vector<Side> sides = sides_of(soup);
  Corners corners(3 * soup.triangles.size());
  for (std::size_t first = 0, end = 0; first < sides.size(); first = end) {
    while (end < sides.size() && sides[end].edge == sides[first].edge) ++end;
    if (end - first == 2)
      corners.join(sides[first], sides[first + 1]);
    else
      join_around_matter({sides.begin() + static_cast<std::ptrdiff_t>(first),
                          sides.begin() + static_cast<std::ptrdiff_t>(end)},
                         soup, corners);
  }
  TriangleSoup apart = soup;
  const std::vector<Fan> fans = fans_of(soup, gap_mm, corners, apart.triangles);
  std::vector<int> fans_at(soup.points.size());
  for (const Fan& fan : fans) ++fans_at[fan.point];
  apart.points.clear();
  for (const Fan& fan : fans) {
    const bool touches = fans_at[fan.point] > 1 && fan.outwards.norm() > 0;
    apart.points.push_back(soup.points[fan.point]);
    if (touches) apart.points.back() -= fan.step_mm * fan.outwards.normalized();
  }
  return apart;
}

}  // namespace packmerger
