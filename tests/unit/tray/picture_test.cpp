// Pictures: they show what they should, at one scale, and survive PNG.
#include "picture/preview.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cmath>

#include "picture/part_colour.h"
#include "unit/tray/sample_job.h"

namespace packmerger {
namespace {

struct Hsv {
  double hue = 0;
  double saturation = 0;
};

Hsv hsv(double r, double g, double b) {
  const double high = std::max({r, g, b});
  const double low = std::min({r, g, b});
  if (high <= low) return {};
  double hue = high == r   ? (g - b) / (high - low)
               : high == g ? 2 + (b - r) / (high - low)
                           : 4 + (r - g) / (high - low);
  return {std::fmod(hue + 6, 6), (high - low) / high};
}

// Pixels of a part's hue, however they are lit.
int pixels_of(const Image& image, const Colour& colour) {
  const Hsv wanted = hsv(colour.red, colour.green, colour.blue);
  int count = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const Hsv seen = hsv(image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]);
    const double turn = std::abs(seen.hue - wanted.hue);
    if (seen.saturation > 0.3 && std::min(turn, 6 - turn) < 0.2) ++count;
  }
  return count;
}

TEST(Preview, ShowsEveryPartInItsColour) {
  for (const int trays : {1, 2}) {
    const Job job = fixtures::sample_job(trays);
    const Image image = preview_picture(job);
    ASSERT_EQ(image.rgba.size(), static_cast<std::size_t>(image.width) * image.height * 4);
    for (const JobPart& part : job.parts)
      EXPECT_GT(pixels_of(image, part_colour(part.id - 1)), 1500) << part.id;
  }
}

TEST(Preview, IsTheSameEveryTime) {
  const Job job = fixtures::sample_job();
  EXPECT_EQ(preview_picture(job).rgba, preview_picture(job).rgba);
}

TEST(Preview, DrawsAJobWithoutModels) {
  Job job = fixtures::sample_job();
  job.models.clear();
  EXPECT_GT(pixels_of(preview_picture(job), part_colour(0)), 1500);
}

TEST(Preview, ShowsThePlateThatThereIs) {
  Job job = fixtures::sample_job();
  job.parts.clear();
  const Image whole = preview_picture(job);
  const double x = job.profile.build_mm[0];
  const double y = job.profile.build_mm[1];
  const Colour barred{0.80F, 0.45F, 0.38F};
  const int before = pixels_of(whole, barred);
  job.profile.keep_out_mm = {{{x / 4, y / 4}, {x / 2, y / 4}, {x / 2, y / 2}}};
  EXPECT_GT(pixels_of(preview_picture(job), barred), before + 50);
  job.profile.keep_out_mm.clear();
  job.profile.plate_mm = {{0, 0}, {x, 0}, {0, y}};
  EXPECT_NE(preview_picture(job).rgba, whole.rgba);
}

TEST(Preview, DrawsModelsFarTooLargeForThePrinter) {
  Job job = fixtures::sample_job();
  job.models = {closed_mesh(fixtures::sphere(400, 3))};
  EXPECT_GT(pixels_of(preview_picture(job), part_colour(0)), 50);
}

TEST(Png, SurvivesReadingBack) {
  const Image image = preview_picture(fixtures::sample_job());
  const std::string bytes = png_bytes(image);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  ASSERT_NE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()), 0);
  EXPECT_EQ(static_cast<int>(png.width), image.width);
  EXPECT_EQ(static_cast<int>(png.height), image.height);
  png.format = PNG_FORMAT_RGBA;
  std::vector<std::uint8_t> rgba(PNG_IMAGE_SIZE(png));
  ASSERT_NE(png_image_finish_read(&png, nullptr, rgba.data(), 0, nullptr), 0);
  EXPECT_EQ(rgba, image.rgba);
}

// A segment that touches itself at a vertex is no 2-manifold as it is.
TEST(CutPicture, DrawsSegmentsHoweverTheyTouchThemselves) {
  ColouredMesh ball;
  ball.surface = closed_mesh(fixtures::sphere(20, 3));
  const std::size_t faces = ball.surface.n_triangles();
  for (std::size_t i = 0; i < faces; ++i) ball.segment_of_face.push_back(static_cast<int>(i % 3));
  ColouredMesh halves = ball;
  for (std::size_t i = 0; i < faces; ++i)
    halves.segment_of_face[i] = halves.surface.corners(i)[0].x() < 0 ? 0 : 1;
  const Image image = cut_picture(ball, halves);
  for (const int segment : {0, 1, 2}) EXPECT_GT(pixels_of(image, part_colour(segment)), 5000);
}

}  // namespace
}  // namespace packmerger
