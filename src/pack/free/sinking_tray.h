// A tray whose parts sink together where that makes it cheaper, until it does so no more.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/random.h"
#include "model/packing.h"
#include "pack/search/search.h"
#include "pack/separate/shape.h"

namespace packmerger {

class SinkingTray {
 public:
  // Judges a cheaper layout, by the surfaces of its parts where they stand.
  using IsAccepted = std::function<bool(const std::vector<Mesh>& placed)>;

  // parts: of the tray, where they stand; figures: what it measures. is_over says that time is up;
  // it may throw to cancel. problem must outlive it.
  SinkingTray(const PackProblem& problem, const std::vector<PlacedPart>& parts,
              std::vector<std::shared_ptr<const Shape>> shapes, const TrayMeasure& figures,
              std::uint64_t seed, std::function<bool()> is_over, IsAccepted is_accepted);

  // Sinks and separates again and again, what fails shaken and squeezed, until so many tries one
  // after the other brought nothing; keeps what is cheaper than all before and accepted.
  void sink(int patience) { sink(poses_, 0, patience); }
  // The same from a layout that is nearly apart, with raise_mm more height for the first time. Ends
  // early where that is far from being cheaper.
  void sink_from(const std::vector<Pose>& poses, double raise_mm, int patience) {
    sink(poses, raise_mm, patience);
  }

  // Of the cheapest: poses of the shapes' frames, and of a part from model to tray.
  bool is_cheaper() const { return is_cheaper_; }  // than the tray was at first
  double cost() const { return least_; }
  double height_mm() const;
  const std::vector<Pose>& poses() const { return poses_; }
  Pose pose(std::size_t part) const;

  const std::vector<const Shape*>& shapes() const { return pointers_; }
  double apart_mm() const;

 private:
  void sink(std::vector<Pose> here, double raise_mm, int patience);
  bool fall(std::vector<Pose>& poses, const TrayMeasure& figures, int squeezed, double raise_mm);
  std::vector<int> squeezable(const TrayMeasure& figures) const;
  Vec3 room_at_no_cost(const TrayMeasure& figures) const;
  std::vector<Mesh> placed(const std::vector<Pose>& poses) const;
  Box3 contents(const std::vector<Pose>& poses) const;

  const PackProblem& problem_;
  std::vector<std::shared_ptr<const Shape>> shapes_;
  std::vector<const Shape*> pointers_;
  double material_mm3_;
  Random random_;
  std::function<bool()> is_over_;
  IsAccepted is_accepted_;
  double least_;
  std::vector<Pose> poses_;
  bool is_cheaper_ = false;
};

// All trays of a packing, sunk as long as each part can still be lifted straight up in the order
// that it has. Nothing where none became cheaper; the figures are those of the packing given: the
// caller measures them.
std::optional<Packing> sunk(const PackProblem& problem, Packing packing, Pace& pace);

}  // namespace packmerger
