// The parts of a tray, and their shapes.
#pragma once

#include <memory>
#include <vector>

#include "model/packing.h"
#include "pack/search/search.h"
#include "pack/separate/shape.h"

namespace packmerger {

struct TrayParts {
  std::vector<std::size_t> indices;  // into Packing::parts
  std::vector<PlacedPart> parts;
  std::vector<int> order;  // of removal, into parts
};
TrayParts parts_of(const Packing& packing, int tray);

// By part. Meshes that are the same to the last bit, as copies are, share a shape. Empty where the
// pace's time is up before they are made.
std::vector<std::shared_ptr<const Shape>> shapes_of(const PackProblem& problem,
                                                    const std::vector<PlacedPart>& parts,
                                                    Pace& pace);

// Of the shape's frame, where the part's is at the pose; and back.
Pose own_frame(const Pose& pose, const Shape& shape);
Pose part_frame(const Pose& pose, const Shape& shape);

// Moves all down together until one stands on the plate; poses of the shapes' frames.
void let_down(std::vector<Pose>& poses, const std::vector<std::shared_ptr<const Shape>>& shapes);

}  // namespace packmerger
