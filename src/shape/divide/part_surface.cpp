#include "shape/divide/part_surface.h"

#include <algorithm>
#include <map>
#include <string>
#include <tuple>

#include "base/error.h"
#include "base/parallel.h"

namespace packmerger {
namespace {

[[noreturn]] void fail(int label, const std::string& why) {
  throw Error(Fault::kInternal, "Part " + std::to_string(label) + " has no proper surface: " + why,
              "Please report this model to the PackMerger project.");
}

SegmentSurface surface_of(const TetMesh& mesh, const std::vector<int>& labels,
                          const std::vector<int>& tetrahedra, int label) {
  SegmentSurface result;
  TriangleSoup soup;
  std::map<int, int> index_of;  // of a point in the soup
  for (const int t : tetrahedra) {
    result.volume_mm3 += mesh.volume_mm3(t);
    for (int face = 0; face < 4; ++face) {
      const int across = mesh.neighbours[t][face];
      if (across >= 0 && labels[across] == label) continue;
      std::array<int, 3> triangle = face_corners(mesh, t, face);
      for (int& corner : triangle) {
        const auto [entry, is_new] =
            index_of.try_emplace(corner, static_cast<int>(index_of.size()));
        if (is_new) soup.points.push_back(mesh.points[corner]);
        corner = entry->second;
      }
      soup.triangles.push_back(triangle);
    }
  }
  if (soup.triangles.empty()) fail(label, "it is empty");
  std::vector<Vec3> sorted = soup.points;
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::tie(a.x(), a.y(), a.z()) < std::tie(b.x(), b.y(), b.z());
  };
  std::sort(sorted.begin(), sorted.end(), less);
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    fail(label, "two points lie at one position");
  if (!(result.volume_mm3 > 0)) fail(label, "it has no volume");
  try {
    result.surface = closed_mesh(std::move(soup));
  } catch (const Error& error) {
    fail(label, error.what());
  }
  return result;
}

std::vector<std::vector<int>> tetrahedra_by_label(const Segments& segments) {
  std::vector<std::vector<int>> by_label(segments.count);
  for (std::size_t t = 0; t < segments.of_tetrahedron.size(); ++t)
    by_label[segments.of_tetrahedron[t]].push_back(static_cast<int>(t));
  return by_label;
}

}  // namespace

SegmentSurface part_surface(const TetMesh& mesh, const Segments& segments, int label) {
  return surface_of(mesh, segments.of_tetrahedron, tetrahedra_by_label(segments).at(label), label);
}

std::vector<SegmentSurface> part_surfaces(const TetMesh& mesh, const Segments& segments) {
  const auto by_label = tetrahedra_by_label(segments);
  std::vector<SegmentSurface> surfaces(by_label.size());
  parallel_tasks(by_label.size(), [&](std::size_t label) {
    surfaces[label] =
        surface_of(mesh, segments.of_tetrahedron, by_label[label], static_cast<int>(label));
  });
  return surfaces;
}

}  // namespace packmerger
