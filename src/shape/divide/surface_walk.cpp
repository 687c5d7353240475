#include "shape/divide/surface_walk.h"

#include <algorithm>
#include <cmath>

namespace packmerger {

Vec3 nearest_on_triangle(const Vec3& point, const Vec3& a, const Vec3& b, const Vec3& c) {
  // the regions of the triangle's corners, edges and face, by barycentric signs
  const Vec3 ab = b - a, ac = c - a, ap = point - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = point - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = point - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double sum = va + vb + vc;
  return a + vb / sum * ab + vc / sum * ac;
}

SurfaceWalk::SurfaceWalk(const TetMesh& mesh, double crease_angle)
    : points_(mesh.points),
      surface_(boundary_surface(mesh)),
      first_face_(mesh.points.size() + 1, 0),
      freedom_(mesh.points.size(), Freedom::kNone),
      crease_ends_(mesh.points.size(), {-1, -1}) {
  for (const auto& face : surface_.faces)
    for (const int corner : face.corners) ++first_face_[corner + 1];
  for (std::size_t i = 1; i < first_face_.size(); ++i) first_face_[i] += first_face_[i - 1];
  faces_.resize(first_face_.back());
  std::vector<int> next(first_face_.begin(), first_face_.end() - 1);
  for (int f = 0; f < static_cast<int>(surface_.faces.size()); ++f)
    for (const int corner : surface_.faces[f].corners) faces_[next[corner]++] = f;
  find_creases(crease_angle);
}

std::span<const int> SurfaceWalk::faces_at(int point) const {
  return {faces_.data() + first_face_[point],
          static_cast<std::size_t>(first_face_[point + 1] - first_face_[point])};
}

Vec3 SurfaceWalk::normal(int face) const {
  const auto [a, b, c] = surface_.faces[face].corners;
  return (points_[b] - points_[a]).cross(points_[c] - points_[a]).normalized();
}

void SurfaceWalk::find_creases(double crease_angle) {
  const double least_cosine = std::cos(crease_angle);
  std::vector<int> valence(points_.size(), 0);
  const auto note = [&](int point, int other) {
    if (valence[point] < 2) crease_ends_[point][valence[point]] = other;
    ++valence[point];
  };
  for (int f = 0; f < static_cast<int>(surface_.faces.size()); ++f) {
    const BoundarySurface::Face& face = surface_.faces[f];
    for (int i = 0; i < 3; ++i) {
      freedom_[face.corners[i]] = Freedom::kFace;
      if (face.side != FaceSide::kOutside || face.across[i] < f) continue;  // each edge once
      if (normal(f).dot(normal(face.across[i])) >= least_cosine) continue;
      note(face.corners[i], face.corners[(i + 1) % 3]);
      note(face.corners[(i + 1) % 3], face.corners[i]);
    }
  }
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (valence[p] == 0) continue;
    freedom_[p] = Freedom::kNone;
    if (valence[p] != 2) continue;
    const Vec3 in = (points_[p] - points_[crease_ends_[p][0]]).normalized();
    const Vec3 out = (points_[crease_ends_[p][1]] - points_[p]).normalized();
    if (in.dot(out) >= least_cosine) freedom_[p] = Freedom::kCrease;
  }
}

Vec3 SurfaceWalk::nearest_in_face(const Vec3& target, int face) const {
  const auto [a, b, c] = surface_.faces[face].corners;
  return nearest_on_triangle(target, points_[a], points_[b], points_[c]);
}

SurfaceWalk::Place SurfaceWalk::nearest(const Vec3& target, int from) const {
  Place best{nearest_in_face(target, from), from};
  double least = (best.point - target).squaredNorm();
  for (int centre = -1; centre != best.face;) {
    centre = best.face;
    for (const int corner : surface_.faces[centre].corners)
      for (const int face : faces_at(corner)) {
        const Vec3 point = nearest_in_face(target, face);
        const double distance = (point - target).squaredNorm();
        if (distance >= least) continue;
        least = distance;
        best = {point, face};
      }
  }
  return best;
}

Vec3 SurfaceWalk::nearest_on_crease(const Vec3& target, int point) const {
  Vec3 best = points_[point];
  for (const int end : crease_ends_[point]) {
    const Vec3 way = points_[end] - points_[point];
    const double along = std::clamp((target - points_[point]).dot(way) / way.squaredNorm(), 0., 1.);
    const Vec3 candidate = points_[point] + along * way;
    if ((candidate - target).squaredNorm() < (best - target).squaredNorm()) best = candidate;
  }
  return best;
}

}  // namespace packmerger
