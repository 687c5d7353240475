#include "shape/read/soup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace packmerger {
namespace {

using Triangle = std::array<int, 3>;

std::uint64_t pair_key(int a, int b) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) |
         static_cast<std::uint32_t>(b);
}
std::uint64_t edge_key(int a, int b) { return a < b ? pair_key(a, b) : pair_key(b, a); }

// Spreads cell coordinates over the hash table.
struct CellHash {
  std::size_t operator()(const std::array<std::int64_t, 3>& cell) const {
    std::uint64_t hash = 0x9e3779b97f4a7c15ull;
    for (const std::int64_t c : cell) {
      hash ^= static_cast<std::uint64_t>(c);
      hash *= 0xff51afd7ed558ccdull;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

std::vector<int> representatives_exact(const std::vector<Vec3>& points) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](int a, int b) {
    return std::lexicographical_compare(points[a].begin(), points[a].end(), points[b].begin(),
                                        points[b].end());
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    if (before(a, b)) return true;
    if (before(b, a)) return false;
    return a < b;
  });
  std::vector<int> first(points.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && points[order[i]] == points[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  return first;
}

std::vector<int> representatives_near(const std::vector<Vec3>& points, double tolerance) {
  std::unordered_map<std::array<std::int64_t, 3>, std::vector<int>, CellHash> cells;
  std::vector<int> first(points.size());
  const Vec3 origin = points.empty() ? Vec3::Zero() : points[0];
  for (std::size_t i = 0; i < points.size(); ++i) {
    std::array<std::int64_t, 3> home{};
    for (int axis = 0; axis < 3; ++axis)
      home[axis] = std::llround(std::floor((points[i][axis] - origin[axis]) / tolerance));
    int found = -1;
    for (int n = 0; n < 27 && found < 0; ++n) {
      const auto cell =
          cells.find({home[0] + n % 3 - 1, home[1] + n / 3 % 3 - 1, home[2] + n / 9 - 1});
      if (cell == cells.end()) continue;
      for (const int other : cell->second)
        if ((points[other] - points[i]).norm() <= tolerance) found = other;
    }
    if (found < 0) cells[home].push_back(static_cast<int>(i));
    first[i] = found < 0 ? static_cast<int>(i) : found;
  }
  return first;
}

bool collapsed(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

// Sorted corners, and whether an even permutation sorts them.
std::pair<Triangle, bool> sorted(Triangle t) {
  bool even = true;
  const auto order = [&](int& a, int& b) {
    if (a <= b) return;
    std::swap(a, b);
    even = !even;
  };
  order(t[0], t[1]);
  order(t[1], t[2]);
  order(t[0], t[1]);
  return {t, even};
}

}  // namespace

TriangleSoup welded(const TriangleView& surface, double tolerance_mm) {
  TriangleSoup soup = to_soup(surface);
  const std::vector<int> first = tolerance_mm > 0 ? representatives_near(soup.points, tolerance_mm)
                                                  : representatives_exact(soup.points);
  for (Triangle& triangle : soup.triangles)
    for (int& corner : triangle) corner = first[corner];
  return without_unused_points(std::move(soup));
}

int drop_collapsed(TriangleSoup& soup) {
  return static_cast<int>(std::erase_if(soup.triangles, collapsed));
}

int drop_duplicates(TriangleSoup& soup) {
  struct Seen {
    int even = 0;
    int odd = 0;
    bool kept = false;
  };
  std::unordered_map<std::array<std::int64_t, 3>, Seen, CellHash> seen;
  const auto key = [](const Triangle& t) { return std::array<std::int64_t, 3>{t[0], t[1], t[2]}; };
  for (const Triangle& triangle : soup.triangles) {
    const auto [corners, even] = sorted(triangle);
    ++(even ? seen[key(corners)].even : seen[key(corners)].odd);
  }
  return static_cast<int>(std::erase_if(soup.triangles, [&](const Triangle& triangle) {
    const auto [corners, even] = sorted(triangle);
    Seen& same = seen[key(corners)];
    const bool keep = same.even != same.odd && even == (same.even > same.odd) && !same.kept;
    if (keep) same.kept = true;
    return !keep;
  }));
}

int count_turned(const TriangleSoup& before, const TriangleSoup& after) {
  TriangleSoup both = before;
  append(both, after);
  both = welded(both, 0);
  std::unordered_map<std::array<std::int64_t, 3>, bool, CellHash> even_before;
  int turned = 0;
  for (std::size_t i = 0; i < both.triangles.size(); ++i) {
    const auto [corners, even] = sorted(both.triangles[i]);
    const std::array<std::int64_t, 3> key{corners[0], corners[1], corners[2]};
    if (i < before.triangles.size()) {
      even_before.emplace(key, even);
    } else if (const auto same = even_before.find(key); same != even_before.end()) {
      turned += same->second != even ? 1 : 0;
    }
  }
  return turned;
}

int count_open_edges(const TriangleSoup& soup) {
  std::unordered_map<std::uint64_t, int> sides;
  for (const Triangle& t : soup.triangles)
    for (int i = 0; i < 3; ++i) ++sides[edge_key(t[i], t[(i + 1) % 3])];
  return static_cast<int>(
      std::count_if(sides.begin(), sides.end(), [](const auto& edge) { return edge.second != 2; }));
}

std::vector<int> non_manifold_points(const TriangleView& soup) {
  std::vector<char> bad(soup.points.size(), 0);
  std::unordered_map<std::uint64_t, int> triangle_at;  // directed edge → its triangle
  triangle_at.reserve(soup.triangles.size() * 3);
  std::vector<int> triangles_around(soup.points.size(), 0);
  std::vector<int> some_triangle(soup.points.size(), -1);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const Triangle& t = soup.triangles[i];
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      if (a == b || !triangle_at.emplace(pair_key(a, b), static_cast<int>(i)).second)
        bad[a] = bad[b] = 1;
      ++triangles_around[a];
      some_triangle[a] = static_cast<int>(i);
    }
  }
  for (const auto& [edge, triangle] : triangle_at)
    if (!triangle_at.contains((edge << 32) | (edge >> 32)))
      bad[edge >> 32] = bad[edge & 0xffffffff] = 1;

  for (std::size_t v = 0; v < soup.points.size(); ++v) {
    if (some_triangle[v] < 0 || bad[v] != 0) continue;
    int fan = 0;
    int triangle = some_triangle[v];
    do {
      const Triangle& t = soup.triangles[triangle];
      const int at =
          static_cast<int>(std::find(t.begin(), t.end(), static_cast<int>(v)) - t.begin());
      triangle = triangle_at.at(pair_key(static_cast<int>(v), t[(at + 2) % 3]));
      ++fan;
    } while (triangle != some_triangle[v]);
    if (fan != triangles_around[v]) bad[v] = 1;
  }
  std::vector<int> points;
  for (std::size_t v = 0; v < bad.size(); ++v)
    if (bad[v] != 0) points.push_back(static_cast<int>(v));
  return points;
}

bool is_closed_manifold(const TriangleView& soup) { return non_manifold_points(soup).empty(); }

Components components_of(const TriangleView& soup) {
  std::vector<int> parent(soup.triangles.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  std::unordered_map<std::uint64_t, int> triangle_at;
  for (std::size_t i = 0; i < soup.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Triangle& t = soup.triangles[i];
      const auto [edge, is_new] =
          triangle_at.emplace(edge_key(t[k], t[(k + 1) % 3]), static_cast<int>(i));
      if (is_new) continue;
      const int a = root(edge->second);
      const int b = root(static_cast<int>(i));
      parent[std::max(a, b)] = std::min(a, b);
    }
  Components components;
  components.of_triangle.resize(soup.triangles.size());
  for (std::size_t i = 0; i < parent.size(); ++i) {
    const int r = root(static_cast<int>(i));
    components.of_triangle[i] =
        r == static_cast<int>(i) ? components.count++ : components.of_triangle[r];
  }
  return components;
}

std::vector<TriangleSoup> split_components(const TriangleView& soup) {
  const Components components = components_of(soup);
  std::vector<TriangleSoup> parts(components.count);
  std::vector<std::unordered_map<int, int>> numbers(components.count);
  for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
    const int c = components.of_triangle[i];
    Triangle triangle = soup.triangles[i];
    for (int& corner : triangle) {
      const auto [entry, is_new] =
          numbers[c].emplace(corner, static_cast<int>(parts[c].points.size()));
      if (is_new) parts[c].points.push_back(soup.points[corner]);
      corner = entry->second;
    }
    parts[c].triangles.push_back(triangle);
  }
  return parts;
}

void append(TriangleSoup& soup, const TriangleSoup& more) {
  const int base = static_cast<int>(soup.points.size());
  soup.points.insert(soup.points.end(), more.points.begin(), more.points.end());
  for (const auto& [a, b, c] : more.triangles)
    soup.triangles.push_back({a + base, b + base, c + base});
}

TriangleSoup turned(TriangleSoup soup) {
  for (Triangle& triangle : soup.triangles) std::swap(triangle[1], triangle[2]);
  return soup;
}

double signed_volume_mm3(const TriangleSoup& soup) {
  if (soup.points.empty()) return 0;
  const Vec3 origin = soup.points[0];
  double six_volumes = 0;
  for (const auto& [a, b, c] : soup.triangles)
    six_volumes +=
        (soup.points[a] - origin).dot((soup.points[b] - origin).cross(soup.points[c] - origin));
  return six_volumes / 6;
}

double area_mm2(const TriangleSoup& soup) {
  double twice = 0;
  for (const auto& [a, b, c] : soup.triangles)
    twice += (soup.points[b] - soup.points[a]).cross(soup.points[c] - soup.points[a]).norm();
  return twice / 2;
}

Box3 bounding_box(const TriangleSoup& soup) {
  Box3 box;
  for (const Vec3& point : soup.points) box.extend(point);
  return box;
}

int count_flat(const TriangleSoup& soup) {
  constexpr double kFlat = 1e-9;
  return static_cast<int>(
      std::count_if(soup.triangles.begin(), soup.triangles.end(), [&](const Triangle& t) {
        const Vec3& a = soup.points[t[0]];
        const Vec3& b = soup.points[t[1]];
        const Vec3& c = soup.points[t[2]];
        const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
        return (b - a).cross(c - a).norm() <= kFlat * longest * longest;
      }));
}

}  // namespace packmerger
