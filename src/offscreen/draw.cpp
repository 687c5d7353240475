#include <algorithm>
#include <cmath>

#include "model/half_edges.h"
#include "offscreen/offscreen.h"
#include "offscreen/surface.h"

namespace packmerger {
namespace {

constexpr double kCreaseCosine = 0.766;  // cos 40°
constexpr double kBoxMargin = 1.06;

struct Vertex {
  Eigen::Vector3f point;
  Eigen::Matrix<std::uint8_t, 4, 1> colour;
};

// Columns right, up and backwards of a camera, orthonormal.
Mat3 camera_axes(const Camera& camera) {
  const Vec3 back = (camera.eye - camera.target).normalized();
  Vec3 right = camera.up.cross(back);
  // Looking straight along `up`, any right will do as long as it is always the same one.
  if (right.norm() < 1e-9) right = back.unitOrthogonal();
  right.normalize();
  Mat3 axes;
  axes << right, back.cross(right), back;
  return axes;
}

Pose scene_to_camera(const Camera& camera) {
  const Mat3 turn = camera_axes(camera).transpose();
  Pose pose = Pose::Identity();
  pose.linear() = turn;
  pose.translation() = -(turn * camera.eye);
  return pose;
}

struct Lights {
  Vec3 key;
  Vec3 fill;
};

Lights lights_of(const Camera& camera) {
  const Mat3 axes = camera_axes(camera);
  return {(axes * Vec3(-0.45, 0.65, 0.6)).normalized(), (axes * Vec3(0.8, 0.0, 0.6)).normalized()};
}

// A key light from the camera's upper left, a weak one from its right, and the sky above.
double brightness(const Vec3& normal, const Lights& lights) {
  const double sky = 0.22 + 0.08 * normal.z();
  return sky + 0.62 * std::max(0.0, normal.dot(lights.key)) +
         0.18 * std::max(0.0, normal.dot(lights.fill));
}

std::uint8_t channel(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

Eigen::Matrix<std::uint8_t, 4, 1> lit(const Colour& colour, double light) {
  // Light adds up linearly, screens do not: 2.2 is close enough to sRGB for shading.
  const double factor = std::pow(std::max(light, 0.0), 1 / 2.2);
  return {channel(colour.red * factor), channel(colour.green * factor),
          channel(colour.blue * factor), 255};
}

std::vector<Vec3> area_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.n_triangles());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    normals[i] = (b - a).cross(c - a);
  }
  return normals;
}

// The area-weighted mean normal round a corner of `face`, over the faces that turn little from it.
Vec3 corner_normal(const HalfEdges& edges, const std::vector<Vec3>& normals, int face, int corner) {
  const Vec3 own = normals[face].normalized();
  Vec3 sum = normals[face];
  for (const auto other : edges.vf_range(HalfEdges::VertexHandle(corner)))
    if (other.idx() != face && normals[other.idx()].normalized().dot(own) > kCreaseCosine)
      sum += normals[other.idx()];
  return sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3(0, 0, 1);
}

std::vector<Vertex> lit_triangles(const SceneMesh& item, const Camera& camera) {
  const Lights lights = lights_of(camera);
  const Mesh& mesh = item.mesh;
  const HalfEdges edges = half_edges(mesh);
  const std::vector<Vec3> normals = area_normals(mesh);
  std::vector<Vertex> vertices;
  vertices.reserve(3 * mesh.n_triangles());
  for (int face = 0; face < static_cast<int>(mesh.n_triangles()); ++face)
    for (const int corner : mesh.triangles()[face]) {
      const Vec3 point = item.pose * mesh.points()[corner];
      Vec3 normal = item.pose.linear() * corner_normal(edges, normals, face, corner);
      if (normal.dot(camera.eye - point) < 0) normal = -normal;
      vertices.push_back({point.cast<float>(), lit(item.colour, brightness(normal, lights))});
    }
  return vertices;
}

// Every point the camera may have to show, so that the depth range can be kept narrow.
Box3 box_of(const Scene& scene) {
  Box3 box;
  for (const SceneMesh& item : scene.meshes)
    for (const Vec3& point : item.mesh.points()) box.extend(item.pose * point);
  for (const SceneLine& line : scene.lines) {
    box.extend(line.a);
    box.extend(line.b);
  }
  return box;
}

struct DepthRange {
  double near_mm;
  double far_mm;
};

DepthRange depth_range(const Scene& scene, const Camera& camera) {
  const Box3 box = box_of(scene);
  if (box.isEmpty()) return {1, 2};
  const double distance = (box.center() - camera.eye).norm();
  const double radius = box.sizes().norm() / 2 + 1e-3;
  return {std::max(distance - radius, (distance + radius) * 1e-3), distance + radius};
}

void look_through(const Camera& camera, const DepthRange& range, double aspect) {
  const double top = range.near_mm * std::tan(camera.field_of_view / 2);
  glMatrixMode(GL_PROJECTION);
  glLoadIdentity();
  glFrustum(-top * aspect, top * aspect, -top, top, range.near_mm, range.far_mm);
  glMatrixMode(GL_MODELVIEW);
  glLoadMatrixd(scene_to_camera(camera).matrix().data());
}

void draw_vertices(GLenum mode, const std::vector<Vertex>& vertices) {
  if (vertices.empty()) return;
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_COLOR_ARRAY);
  glVertexPointer(3, GL_FLOAT, sizeof(Vertex), vertices.front().point.data());
  glColorPointer(4, GL_UNSIGNED_BYTE, sizeof(Vertex), vertices.front().colour.data());
  glDrawArrays(mode, 0, static_cast<GLsizei>(vertices.size()));
  glDisableClientState(GL_COLOR_ARRAY);
  glDisableClientState(GL_VERTEX_ARRAY);
}

void draw_lines(const Scene& scene, int supersampling) {
  std::vector<Vertex> vertices;
  for (const SceneLine& line : scene.lines)
    for (const Vec3& end : {line.a, line.b})
      vertices.push_back({end.cast<float>(), lit(line.colour, 1)});
  glLineWidth(static_cast<float>(scene.line_width_px * supersampling));
  draw_vertices(GL_LINES, vertices);
}

// Means over supersampling × supersampling samples; GL's rows go up, the image's down.
Image downsampled(const std::vector<std::uint8_t>& samples, int width, int height, int factor) {
  Image image{width, height, {}};
  image.rgba.reserve(std::size_t{4} * static_cast<std::size_t>(width * height));
  for (int y = height - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 4; ++c) {
        int sum = 0;
        for (int j = 0; j < factor; ++j)
          for (int i = 0; i < factor; ++i) {
            const std::size_t row = static_cast<std::size_t>(y * factor + j);
            const std::size_t column = static_cast<std::size_t>(x * factor + i);
            sum += samples[4 * (row * static_cast<std::size_t>(width * factor) + column) +
                           static_cast<std::size_t>(c)];
          }
        image.rgba.push_back(
            static_cast<std::uint8_t>((sum + factor * factor / 2) / (factor * factor)));
      }
  return image;
}

}  // namespace

Camera camera_looking_at(const Box3& box, const Vec3& direction, double aspect) {
  Camera camera;
  camera.target = box.center();
  camera.eye = camera.target - direction.normalized();
  const Mat3 axes = camera_axes(camera);
  const double slope_y = std::tan(camera.field_of_view / 2) / kBoxMargin;
  const double slope_x = slope_y * aspect;
  // Far enough back for each of the eight corners to lie inside the frame.
  double distance = 1e-3;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 seen =
        axes.transpose() * (box.corner(static_cast<Box3::CornerType>(corner)) - camera.target);
    distance = std::max({distance, seen.z() + std::abs(seen.x()) / slope_x,
                         seen.z() + std::abs(seen.y()) / slope_y});
  }
  camera.eye = camera.target - distance * direction.normalized();
  return camera;
}

Image draw(const Scene& scene, const Camera& camera, int width, int height, int supersampling) {
  const int wide = width * supersampling;
  const int high = height * supersampling;
  DrawingSurface surface(wide, high);
  const DrawingSurface::Current current(surface);
  glViewport(0, 0, wide, high);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glClearDepth(1);
  glClearColor(scene.background.red, scene.background.green, scene.background.blue, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  look_through(camera, depth_range(scene, camera), static_cast<double>(width) / height);
  for (const SceneMesh& item : scene.meshes)
    draw_vertices(GL_TRIANGLES, lit_triangles(item, camera));
  draw_lines(scene, supersampling);

  std::vector<std::uint8_t> samples(std::size_t{4} * static_cast<std::size_t>(wide) *
                                    static_cast<std::size_t>(high));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, wide, high, GL_RGBA, GL_UNSIGNED_BYTE, samples.data());
  return downsampled(samples, width, height, supersampling);
}

}  // namespace packmerger
