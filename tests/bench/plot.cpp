#include "bench/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "picture/part_colour.h"

namespace packmerger::bench {
namespace {

constexpr double kWidth = 720, kHeight = 420;
constexpr double kLeft = 70, kRight = 190, kTop = 40, kBottom = 50;  // margins

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text) switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  return safe;
}

// Values from low to high, on a line from `start` to `end` in the picture.
struct Axis {
  double low = 0, high = 1, step = 0.2;
  double start = 0, end = 1;

  double at(double value) const { return start + (value - low) / (high - low) * (end - start); }
};

// About five steps of 1, 2 or 5 times a power of ten.
double tidy_step(double span) {
  const double rough = span / 5;
  const double power = std::pow(10, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= rough * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

Axis axis_over(std::vector<double> values, double start, double end) {
  Axis axis{0, 1, 0.2, start, end};
  if (values.empty()) return axis;
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  double low = *least, high = *most;
  if (low > 0 && low < 0.5 * high) low = 0;
  if (high == low) high = low + std::max(1.0, std::abs(low));
  axis.step = tidy_step(high - low);
  axis.low = std::floor(low / axis.step + 1e-9) * axis.step;
  axis.high = std::ceil(high / axis.step - 1e-9) * axis.step;
  return axis;
}

std::string text(double x, double y, const std::string& anchor, const std::string& words,
                 const std::string& more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, more, escaped(words));
}

std::string line(double x1, double y1, double x2, double y2, const std::string& colour) {
  return fmt::format(
      "<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"{}\"/>\n", x1, y1, x2,
      y2, colour);
}

std::string axes(const Axis& x, const Axis& y) {
  std::string svg;
  const auto steps = [](const Axis& axis) {
    return static_cast<int>(std::lround((axis.high - axis.low) / axis.step));
  };
  const auto number = [](const Axis& axis, int i) {
    const double value = axis.low + i * axis.step;
    return fmt::format("{:g}", std::abs(value) < 1e-9 * axis.step ? 0 : value);
  };
  for (int i = 0; i <= steps(x); ++i) {
    const double at = x.at(x.low + i * x.step);
    svg += line(at, y.start, at, y.end, "#ddd") + text(at, y.start + 18, "middle", number(x, i));
  }
  for (int i = 0; i <= steps(y); ++i) {
    const double at = y.at(y.low + i * y.step);
    svg += line(x.start, at, x.end, at, "#ddd") + text(x.start - 8, at + 4, "end", number(y, i));
  }
  return svg + line(x.start, y.start, x.end, y.start, "#333") +
         line(x.start, y.start, x.start, y.end, "#333");
}

std::string colour_of(std::size_t index) {
  const Colour colour = part_colour(static_cast<int>(index));
  const auto byte = [](float part) { return static_cast<int>(std::lround(255 * part)); };
  return fmt::format("#{:02x}{:02x}{:02x}", byte(colour.red), byte(colour.green),
                     byte(colour.blue));
}

std::string curve(const PlotSeries& series, const std::string& colour, const Axis& x,
                  const Axis& y) {
  std::string svg, joined;
  for (const PlotPoint& point : series.points) {
    joined += fmt::format("{:.1f},{:.1f} ", x.at(point.x), y.at(point.y));
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\" fill=\"{}\"/>\n",
                       x.at(point.x), y.at(point.y), colour);
    if (!point.label.empty())
      svg += text(x.at(point.x) + 6, y.at(point.y) - 6, "start", point.label);
  }
  if (!series.joined) return svg;
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                     joined, colour) +
         svg;
}

}  // namespace

std::string plot_svg(const Plot& plot) {
  std::vector<double> xs, ys;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) {
      xs.push_back(point.x);
      ys.push_back(point.y);
    }
  const Axis x = axis_over(xs, kLeft, kWidth - kRight);
  const Axis y = axis_over(ys, kHeight - kBottom, kTop);
  const double middle = (kTop + kHeight - kBottom) / 2;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      kWidth, kHeight);
  svg += text(kLeft, 24, "start", plot.title, " font-size=\"15\"") + axes(x, y);
  svg += text((x.start + x.end) / 2, kHeight - 12, "middle", plot.x_label);
  svg += text(18, middle, "middle", plot.y_label,
              fmt::format(" transform=\"rotate(-90 18 {:.1f})\"", middle));
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const std::string colour = colour_of(i);
    svg += curve(plot.series[i], colour, x, y);
    const double at = kTop + 12 + 20 * static_cast<double>(i);
    svg += fmt::format("<rect x=\"{:g}\" y=\"{:g}\" width=\"14\" height=\"4\" fill=\"{}\"/>\n",
                       kWidth - kRight + 20, at - 6, colour);
    svg += text(kWidth - kRight + 40, at, "start", plot.series[i].name);
  }
  return svg + "</svg>\n";
}

}  // namespace packmerger::bench
