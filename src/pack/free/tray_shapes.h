// The parts of one tray as shapes, and their poses as poses of the shapes' own frames.
#pragma once

#include <memory>
#include <vector>

#include "model/packing.h"
#include "pack/separate/shape.h"

namespace packmerger {

// By part.
using TrayShapes = std::vector<std::shared_ptr<const Shape>>;

// Meshes that are the same to the last bit, as copies are, share a shape.
TrayShapes shapes_of(const PackProblem& problem, const std::vector<PlacedPart>& parts);

// pose: model → tray.
Pose own_frame(const Pose& pose, const Shape& shape);

// Moves all parts down together until one stands on the plate.
void let_down(std::vector<Pose>& poses, const TrayShapes& shapes);

}  // namespace packmerger
