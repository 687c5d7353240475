#include "bench/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>
#include <string>

namespace packmerger::bench {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Mark {
  double x, y;
};

std::vector<Mark> marks(const std::string& svg) {
  static const std::regex kCircle("<circle cx=\"([-0-9.]+)\" cy=\"([-0-9.]+)\"");
  std::vector<Mark> found;
  for (std::sregex_iterator at(svg.begin(), svg.end(), kCircle), end; at != end; ++at)
    found.push_back({std::stod((*at)[1]), std::stod((*at)[2])});
  return found;
}

TEST(Plot, EscapesEveryText) {
  const std::string svg = plot_svg({"a<b", "c&d", "e\"f", {{"g>h", {{1, 1, "<i>"}}}}});
  for (const char* text : {">a&lt;b<", ">c&amp;d<", ">e&quot;f<", ">g&gt;h<", ">&lt;i&gt;<"})
    EXPECT_THAT(svg, HasSubstr(text));
  EXPECT_THAT(svg, Not(HasSubstr("<i>")));
}

TEST(Plot, DrawsAllPointsWhereTheyBelong) {
  Plot plot{"t", "x", "y", {{"a", {}}, {"b", {}, false}}};
  for (int i = 0; i < 40; ++i) {
    plot.series[0].points.push_back({i * 0.5, std::sin(i), ""});
    plot.series[1].points.push_back({20.0 + i, -1e3 + i, ""});
  }
  const std::vector<Mark> drawn = marks(plot_svg(plot));
  ASSERT_EQ(drawn.size(), 80U);
  // linear in both axes: the scale of the first pair is that of every other, y turned upside down
  const double per_x = (drawn[40].x - drawn[0].x) / 20;
  const double per_y = (drawn[40].y - drawn[0].y) / -1e3;
  EXPECT_GT(per_x, 0);
  EXPECT_LT(per_y, 0);
  for (std::size_t i = 0; i < 80; ++i) {
    const PlotPoint& point = plot.series[i / 40].points[i % 40];
    EXPECT_NEAR(drawn[i].x, drawn[0].x + per_x * point.x, 0.2);
    EXPECT_NEAR(drawn[i].y, drawn[0].y + per_y * point.y, 0.2);
    EXPECT_GE(drawn[i].x, 70);
    EXPECT_LE(drawn[i].x, 530);
    EXPECT_GE(drawn[i].y, 40);
    EXPECT_LE(drawn[i].y, 370);
  }
}

TEST(Plot, JoinsOnlyWhatIsAskedFor) {
  const std::vector<PlotPoint> two{{0, 0, ""}, {1, 1, ""}};
  EXPECT_THAT(plot_svg({"", "", "", {{"", two, true}}}), HasSubstr("<polyline"));
  EXPECT_THAT(plot_svg({"", "", "", {{"", two, false}}}), Not(HasSubstr("<polyline")));
}

TEST(Plot, HoldsOnePointAndNone) {
  EXPECT_EQ(marks(plot_svg({"", "", "", {{"", {{5, 0, ""}}}}})).size(), 1U);
  for (const Plot& plot : {Plot{}, Plot{"", "", "", {{"", {{5, 0, ""}}}}}})
    EXPECT_THAT(plot_svg(plot), Not(testing::AnyOf(HasSubstr("nan"), HasSubstr("inf"))));
}

}  // namespace
}  // namespace packmerger::bench
