// Plain work on triangle soups: welding, manifoldness, components. Used by repair.
#pragma once

#include <vector>

#include "model/mesh.h"

namespace packmerger {

// Merges points nearer than tolerance_mm (0: equal ones) into the first of them, drops points that
// no triangle uses, and keeps the order of what is left. Triangles keep their number and order;
// some may have a corner twice afterwards.
TriangleSoup welded(const TriangleView& surface, double tolerance_mm);

// Drops triangles that have a corner twice. Returns how many.
int drop_collapsed(TriangleSoup& soup);

// Of triangles on the same three points one is kept, or none where as many face one way as the
// other (a wall between two bodies). Returns how many were dropped.
int drop_duplicates(TriangleSoup& soup);

// Of after's triangles those whose places are a triangle's of before, turned over.
int count_turned(const TriangleSoup& before, const TriangleSoup& after);

// Edges that do not have exactly two triangles.
int count_open_edges(const TriangleSoup& soup);

// Points at which the surface is open, has edges with more than two sides or sides that are not
// alike, or at which several fans of triangles touch; in order.
std::vector<int> non_manifold_points(const TriangleView& soup);

// There is no such point.
bool is_closed_manifold(const TriangleView& soup);

// For each triangle the number of its edge-connected component, from 0 in order of first triangle.
struct Components {
  std::vector<int> of_triangle;
  int count = 0;
};
Components components_of(const TriangleView& soup);

// One soup a component, in order; points renumbered in order.
std::vector<TriangleSoup> split_components(const TriangleView& soup);

// Adds a copy of more to soup.
void append(TriangleSoup& soup, const TriangleSoup& more);

// With every triangle turned over.
TriangleSoup turned(TriangleSoup soup);

double signed_volume_mm3(const TriangleSoup& soup);
double area_mm2(const TriangleSoup& soup);
Box3 bounding_box(const TriangleSoup& soup);

// Triangles whose height is below a billionth of their longest edge.
int count_flat(const TriangleSoup& soup);

}  // namespace packmerger
