// Parts on trays, and how a layout is made from another one: some parts stay where they are and are
// only dropped again, some look for a new place, some for a new rotation as well.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "pack/drop/place.h"
#include "pack/maps/part_maker.h"

namespace packmerger {

struct Placed {
  const Part* part = nullptr;
  const RotatedPart* rotated = nullptr;
  int x = 0;  // cells
  int y = 0;
  Height z = 0;  // units
  // A part that fills the tray to within a cell may fit between the grid's positions only; it then
  // stands its first way up in the tray's corner and has the tray for itself.
  bool off_grid = false;
};

struct FilledTray {
  explicit FilledTray(const TraySpec& spec) : state(spec) {}

  std::vector<Placed> placed;  // in the order they were dropped
  TrayState state;
  bool closed = false;  // takes no more parts
};

struct Layout {
  std::vector<std::shared_ptr<const FilledTray>> trays;
  double cost = 0;    // sum over the trays of Cost::evaluate
  double unrest = 0;  // mm⁵: each part's volume times its top's height squared
  int parts() const;
};

// Fewer trays come first, whatever they cost: each is a bed to be cleared. Of equal costs the
// layout at less unrest is better: where only the highest part decides, it tells whether the others
// make room below.
bool is_better(const Layout& a, const Layout& b);

// A part to be put on a tray: in a given rotation at the cheapest place of a window, or freely, in
// several rotations on the first tray that has a place. What finds no place in its window is put
// freely; what stays near looks in ever wider windows first.
struct Task {
  const Part* part = nullptr;
  const RotatedPart* rotated = nullptr;  // nullptr: freely
  Range x = kAllCells;                   // the window, cells
  Range y = kAllCells;
  bool stays_near = false;
};

// What to put where, in this order.
struct Draft {
  // A tray that stays as it is, or tasks for it.
  struct Tray {
    std::shared_ptr<const FilledTray> unchanged;
    std::vector<Task> tasks;
  };
  std::vector<Tray> trays;
  std::vector<Task> loose;  // put last, on the first tray that has a place
};

// The rotations in which a part that is put freely is tried.
using RotationChoice = std::function<std::vector<const RotatedPart*>(const Part&)>;

class Layouter {
 public:
  // spec must outlive it.
  explicit Layouter(const TraySpec& spec) : spec_(spec) {}

  // Empty where the layout is sure to cost more than give_up_above.
  std::optional<Layout> carried_out(const Draft& draft, const RotationChoice& rotations,
                                    double give_up_above, bool on_plate_only = false) const;

  const TraySpec& spec() const { return spec_; }

 private:
  bool put(FilledTray& tray, const Task& task, const RotationChoice& rotations,
           bool on_plate_only) const;
  bool put_near(FilledTray& tray, Task task, const RotationChoice& rotations,
                bool on_plate_only) const;
  void put_off_grid(FilledTray& tray, const Part& part) const;
  double bound(const std::vector<std::shared_ptr<FilledTray>>& trays) const;

  const TraySpec& spec_;
};

// The tasks that keep a tray's parts where they are.
std::vector<Task> kept(const FilledTray& tray);

}  // namespace packmerger
