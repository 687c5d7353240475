#include "bench/divided_picture.h"

#include <array>
#include <map>

namespace packmerger::bench {

ColouredMesh outside_of(const TetMesh& mesh, const Segments& segments, bool y_up) {
  TriangleSoup soup;
  ColouredMesh coloured;
  std::map<int, int> index_of;
  for (int t = 0; t < mesh.count(); ++t)
    for (int face = 0; face < 4; ++face) {
      if (mesh.sides[t][face] != FaceSide::kOutside) continue;
      std::array<int, 3> triangle = face_corners(mesh, t, face);
      for (int& corner : triangle) {
        const auto [entry, is_new] =
            index_of.try_emplace(corner, static_cast<int>(soup.points.size()));
        if (is_new) {
          const Vec3& point = mesh.points[corner];
          soup.points.push_back(y_up ? Vec3(point.x(), -point.z(), point.y()) : point);
        }
        corner = entry->second;
      }
      soup.triangles.push_back(triangle);
      coloured.segment_of_face.push_back(segments.of_tetrahedron[t]);
    }
  coloured.surface = closed_mesh(soup);
  return coloured;
}

Image halved(const Image& image) {
  Image half{image.width / 2, image.height / 2, {}};
  const auto at = [&](int x, int y, int channel) {
    const auto pixel = static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                       static_cast<std::size_t>(x);
    return static_cast<int>(image.rgba[4 * pixel + static_cast<std::size_t>(channel)]);
  };
  for (int y = 0; y < half.height; ++y)
    for (int x = 0; x < half.width; ++x)
      for (int channel = 0; channel < 4; ++channel) {
        const int sum = at(2 * x, 2 * y, channel) + at(2 * x + 1, 2 * y, channel) +
                        at(2 * x, 2 * y + 1, channel) + at(2 * x + 1, 2 * y + 1, channel);
        half.rgba.push_back(static_cast<std::uint8_t>((sum + 2) / 4));
      }
  return half;
}

}  // namespace packmerger::bench
