// Plots of points over two linear axes, as SVG.
#pragma once

#include <string>
#include <vector>

namespace packmerger::bench {

struct PlotPoint {
  double x = 0;
  double y = 0;
  std::string label;  // written beside the point; may be empty
};

struct PlotSeries {
  std::string name;
  std::vector<PlotPoint> points;
  bool joined = true;  // by straight lines, in this order
};

struct Plot {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<PlotSeries> series;  // each in a colour of its own, named beside the plot
};

// A whole SVG document: a mark for every point, axes that hold them all and begin at zero where
// that wastes little. All coordinates finite; texts may hold anything.
std::string plot_svg(const Plot& plot);

}  // namespace packmerger::bench
