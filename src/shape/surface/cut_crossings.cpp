#include "shape/surface/cut_crossings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Constrained_triangulation_plus_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/intersections.h>
#include <boost/iterator/function_output_iterator.hpp>

#include "shape/read/soup.h"

namespace packmerger {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_3;
using Flat = Exact::Point_2;
// Crossing constraints are cut where the whole ones meet, not their parts: numbers stay short.
using Triangulation =
    CGAL::Constrained_triangulation_plus_2<CGAL::Constrained_Delaunay_triangulation_2<
        Exact, CGAL::Default, CGAL::Exact_intersections_tag>>;

using Pair = std::pair<int, int>;

constexpr std::size_t kMostPairs = 2000000;

struct TooMany {};

// Pairs of triangles that meet other than in the edge or corner they share.
std::vector<Pair> crossing_pairs(const Mesh& surface, const Progress& progress) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  using Index = CGAL::SM_Vertex_index;
  const auto index = [](int i) { return Index(static_cast<Index::size_type>(i)); };
  for (const Vec3& p : surface.points()) mesh.add_vertex({p.x(), p.y(), p.z()});
  for (const auto& [a, b, c] : surface.triangles()) mesh.add_face(index(a), index(b), index(c));
  std::vector<Pair> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(
      mesh, boost::make_function_output_iterator([&](const auto& pair) {
        progress.check();
        if (pairs.size() == kMostPairs) throw TooMany();
        pairs.emplace_back(static_cast<int>(pair.first.idx()), static_cast<int>(pair.second.idx()));
      }));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// What two triangles have in common: a point, or the ends of a segment, or the corners of an area.
using Common = std::vector<Point>;

struct ToCommon {
  using result_type = Common;
  Common operator()(const Point& point) const { return {point}; }
  Common operator()(const Exact::Segment_3& segment) const {
    return {segment.source(), segment.target()};
  }
  Common operator()(const Exact::Triangle_3& triangle) const {
    return {triangle[0], triangle[1], triangle[2]};
  }
  Common operator()(const std::vector<Point>& polygon) const { return polygon; }
};

// Drops one axis, along which the plane is not seen edge-on.
class Projection {
 public:
  // Nothing but a line is seen along every axis of a triangle without area.
  static std::optional<Projection> of(const std::array<Point, 3>& corners) {
    for (int axis = 0; axis < 3; ++axis) {
      const Projection projection(corners, axis);
      if (projection.turn_ != CGAL::COLLINEAR) return projection;
    }
    return std::nullopt;
  }

  Flat operator()(const Point& p) const { return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]}; }
  bool turns_over() const { return turn_ == CGAL::RIGHT_TURN; }

  Point lifted(const Flat& flat) const {
    std::array<Exact::FT, 3> at;
    at[static_cast<std::size_t>((axis_ + 1) % 3)] = flat.x();
    at[static_cast<std::size_t>((axis_ + 2) % 3)] = flat.y();
    const int u = (axis_ + 1) % 3;
    const int v = (axis_ + 2) % 3;
    at[static_cast<std::size_t>(axis_)] = origin_[axis_] - (normal_[u] * (flat.x() - origin_[u]) +
                                                            normal_[v] * (flat.y() - origin_[v])) /
                                                               normal_[axis_];
    return {at[0], at[1], at[2]};
  }

 private:
  Projection(const std::array<Point, 3>& corners, int axis)
      : axis_(axis),
        origin_(corners[0]),
        normal_(CGAL::cross_product(corners[1] - corners[0], corners[2] - corners[0])) {
    turn_ = CGAL::orientation((*this)(corners[0]), (*this)(corners[1]), (*this)(corners[2]));
  }

  int axis_;
  Point origin_;
  Exact::Vector_3 normal_;
  CGAL::Orientation turn_;
};

class Cutter {
 public:
  Cutter(TriangleSoup soup, const Progress& progress)
      : soup_(std::move(soup)), progress_(progress), plane_of_(soup_.triangles.size()) {
    std::iota(plane_of_.begin(), plane_of_.end(), 0);
    for (std::size_t i = 0; i < soup_.points.size(); ++i)
      number_.emplace(key(soup_.points[i]), static_cast<int>(i));
  }

  TriangleSoup pieces(const std::vector<Pair>& pairs) {
    std::vector<std::vector<std::size_t>> met(soup_.triangles.size());  // indices into common_
    for (const auto& [a, b] : pairs) {
      progress_.check();
      const auto found = CGAL::intersection(triangle(a), triangle(b));
      if (!found) continue;
      common_.push_back(boost::apply_visitor(ToCommon(), *found));
      for (const int t : {a, b}) met[static_cast<std::size_t>(t)].push_back(common_.size() - 1);
      if (common_.back().size() > 2) join(a, b);
    }
    std::map<int, std::vector<int>> planes;  // triangles that lie on one another, by the first
    for (int t = 0; t < static_cast<int>(soup_.triangles.size()); ++t) {
      if (met[static_cast<std::size_t>(t)].empty())
        cut_.push_back(soup_.triangles[static_cast<std::size_t>(t)]);
      else
        planes[plane(t)].push_back(t);
    }
    for (const auto& [first, members] : planes) cut(members, met);
    soup_.triangles = std::move(cut_);
    return std::move(soup_);
  }

 private:
  static std::array<double, 3> key(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

  std::array<Point, 3> corners_of(int t) const {
    std::array<Point, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& p =
          soup_.points[static_cast<std::size_t>(soup_.triangles[static_cast<std::size_t>(t)][i])];
      corners[i] = Point(p.x(), p.y(), p.z());
    }
    return corners;
  }
  Exact::Triangle_3 triangle(int t) const {
    const auto corners = corners_of(t);
    return {corners[0], corners[1], corners[2]};
  }

  int plane(int t) {
    int& of = plane_of_[static_cast<std::size_t>(t)];
    return of == t ? t : of = plane(of);
  }
  void join(int a, int b) {
    const auto [first, second] = std::minmax({plane(a), plane(b)});
    plane_of_[static_cast<std::size_t>(second)] = first;
  }

  // The number of the point, which two exact points have in common when they round to the same.
  int number_of(const Point& point) {
    const auto& exact = CGAL::exact(point);
    const Vec3 rounded(CGAL::to_double(exact.x()), CGAL::to_double(exact.y()),
                       CGAL::to_double(exact.z()));
    const auto [at, is_new] =
        number_.try_emplace(key(rounded), static_cast<int>(soup_.points.size()));
    if (is_new) soup_.points.push_back(rounded);
    return at->second;
  }

  // members: triangles in one plane, cut together so that what they share is cut once.
  void cut(const std::vector<int>& members, const std::vector<std::vector<std::size_t>>& met) {
    progress_.check();
    const auto projection = Projection::of(corners_of(members.front()));
    if (!projection) return;
    Triangulation flat;
    const auto insert_ring = [&](const auto& points) {
      std::vector<Triangulation::Vertex_handle> ring;
      for (const Point& point : points) ring.push_back(flat.insert((*projection)(point)));
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const auto next = ring[(i + 1) % ring.size()];
        if (ring[i] != next) flat.insert_constraint(ring[i], next);
      }
    };
    std::vector<Exact::Triangle_2> areas;
    for (const int t : members) {
      const auto corners = corners_of(t);
      areas.emplace_back((*projection)(corners[0]), (*projection)(corners[1]),
                         (*projection)(corners[2]));
      insert_ring(corners);
    }
    // What members have in common lies between their own sides.
    for (const int t : members)
      for (const std::size_t i : met[static_cast<std::size_t>(t)])
        if (common_[i].size() <= 2) insert_ring(common_[i]);

    std::map<Triangulation::Vertex_handle, int> numbers;
    for (const auto vertex : flat.finite_vertex_handles())
      numbers[vertex] = number_of(projection->lifted(vertex->point()));
    for (const auto face : flat.finite_face_handles()) {
      if (members.size() > 1) {
        const Flat middle = CGAL::centroid(face->vertex(0)->point(), face->vertex(1)->point(),
                                           face->vertex(2)->point());
        if (std::none_of(areas.begin(), areas.end(), [&](const Exact::Triangle_2& area) {
              return area.has_on_bounded_side(middle);
            }))
          continue;
      }
      std::array<int, 3> piece{numbers.at(face->vertex(0)), numbers.at(face->vertex(1)),
                               numbers.at(face->vertex(2))};
      if (projection->turns_over()) std::swap(piece[1], piece[2]);
      if (piece[0] != piece[1] && piece[1] != piece[2] && piece[2] != piece[0])
        cut_.push_back(piece);
    }
  }

  TriangleSoup soup_;
  const Progress& progress_;
  std::vector<int> plane_of_;
  std::vector<Common> common_;
  std::map<std::array<double, 3>, int> number_;
  std::vector<std::array<int, 3>> cut_;
};

}  // namespace

std::optional<TriangleSoup> cut_at_crossings(const Mesh& mesh, const Progress& progress) {
  try {
    const std::vector<Pair> pairs = crossing_pairs(mesh, progress);
    return Cutter(welded(mesh, 0), progress).pieces(pairs);
  } catch (const TooMany&) {
    return std::nullopt;
  }
}

}  // namespace packmerger
