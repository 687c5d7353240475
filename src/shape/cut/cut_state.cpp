#include "shape/cut/cut_state.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace packmerger {
namespace {

// Times what does not fit or is shut: more than any support.
constexpr double kUnusable = 1e9;
constexpr double kRounding = 1e-9;   // of V_o
constexpr double kGlueMargin = 1.3;  // samples tell the area of a joint roughly

double volume_of(const MatterSamples& samples, const std::vector<int>& list) {
  double sum = 0;
  for (const int sample : list) sum += samples.volumes_mm3[sample];
  return sum;
}

int add_part_node(CutTree& tree) {
  tree.emplace_back();
  return static_cast<int>(tree.size()) - 1;
}

void drop_repeated(std::vector<Plane>& planes) {
  const auto less = [](const Plane& a, const Plane& b) {
    return std::lexicographical_compare(a.coeffs().begin(), a.coeffs().end(), b.coeffs().begin(),
                                        b.coeffs().end());
  };
  std::sort(planes.begin(), planes.end(), less);
  planes.erase(std::unique(planes.begin(), planes.end(),
                           [](const Plane& a, const Plane& b) { return a.coeffs() == b.coeffs(); }),
               planes.end());
}

}  // namespace

double CutState::support_mm3() const {
  double sum = 0;
  for (const auto& piece : pieces) sum += piece->standing.support_mm3;
  return sum;
}

double CutState::unfit_mm3() const {
  double sum = 0;
  for (const auto& piece : pieces) sum += piece->fits ? 0 : piece->shape.volume_mm3;
  return sum;
}

double cost_of(const CutState& state, const CutRules& rules) {
  return state.support_mm3() + rules.part_price_mm3 * state.count() +
         kUnusable * (state.unfit_mm3() + state.shut_cavities);
}

CutState CutBench::whole() {
  CutState state;
  CutPiece piece;
  for (int i = 0; i < samples_.count(); ++i) piece.shape.samples.push_back(i);
  piece.shape.volume_mm3 = samples_.volume_mm3;
  piece.standing = stand_alone(samples_, piece.shape, rules_.support_angle);
  piece.fits = fits_build(piece.shape.samples);
  piece.node = add_part_node(state.tree);
  state.pieces.push_back(std::make_shared<const CutPiece>(std::move(piece)));
  state.piece_of_sample.assign(samples_.count(), 0);
  state.shut_cavities = shut_cavities(state);
  return state;
}

bool CutBench::fits_build(const std::vector<int>& list) const {
  std::vector<Vec3> points;
  for (const int sample : list) points.push_back(samples_.points[sample]);
  return fit_.fits(points, samples_.spacing_mm);
}

std::vector<CutBench::Cell> CutBench::cut(const Cell& region, const CutRecipe& recipe,
                                          CutTree& tree) const {
  std::vector<Cell> cells{region};
  for (const CutStep& step : recipe) {
    Cell below, above;
    for (const int sample : cells[step.cell].samples)
      (step.plane.signedDistance(samples_.points[sample]) > 0 ? above : below)
          .samples.push_back(sample);
    below.planes = cells[step.cell].planes;
    below.planes.push_back(step.plane);
    above.planes = below.planes;
    below.node = add_part_node(tree);
    above.node = add_part_node(tree);
    CutNode& parent = tree[cells[step.cell].node];
    parent.kind = CutNode::Kind::kPlane;
    parent.plane = step.plane;
    parent.next = {below.node, above.node};
    cells[step.cell] = std::move(below);
    cells.push_back(std::move(above));
  }
  return cells;
}

std::optional<std::vector<CutBench::Cell>> CutBench::connected(std::vector<Cell> cells,
                                                               CutTree& tree) {
  struct Piece {
    std::size_t cell;
    std::vector<int> samples;
    double volume_mm3;
    int part = -1;
  };
  std::vector<Piece> pieces;
  constexpr int kUnseen = -2;  // marks hold -1 outside the region, else the piece
  for (const Cell& cell : cells)
    for (const int sample : cell.samples) mark_[sample] = kUnseen;
  std::vector<int> cell_of(samples_.count(), -1);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const int sample : cells[c].samples) cell_of[sample] = static_cast<int>(c);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (const int start : cells[c].samples) {
      if (mark_[start] != kUnseen) continue;
      const int index = static_cast<int>(pieces.size());
      std::vector<int> found{start};
      mark_[start] = index;
      for (std::size_t i = 0; i < found.size(); ++i)
        for (const int other : samples_.linked_to(found[i])) {
          if (mark_[other] != kUnseen || cell_of[other] != static_cast<int>(c)) continue;
          mark_[other] = index;
          found.push_back(other);
        }
      const double volume = volume_of(samples_, found);
      pieces.push_back({c, std::move(found), volume});
    }

  // Large pieces are parts; a fragment goes to the part it is linked to most.
  std::vector<Cell> parts;
  for (Piece& piece : pieces) {
    if (piece.volume_mm3 < rules_.least_volume_mm3) continue;
    piece.part = static_cast<int>(parts.size());
    parts.push_back({piece.samples, cells[piece.cell].planes, piece.volume_mm3, -1});
  }
  for (Piece& piece : pieces) {
    if (piece.part >= 0) continue;
    std::map<int, int> links;
    for (const int sample : piece.samples)
      for (const int other : samples_.linked_to(sample)) {
        const int beside = mark_[other];
        if (beside >= 0 && pieces[beside].volume_mm3 >= rules_.least_volume_mm3)
          ++links[pieces[beside].part];
      }
    const auto most =
        std::max_element(links.begin(), links.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == links.end()) continue;
    piece.part = most->first;
    Cell& part = parts[most->first];
    part.samples.insert(part.samples.end(), piece.samples.begin(), piece.samples.end());
    part.planes.insert(part.planes.end(), cells[piece.cell].planes.begin(),
                       cells[piece.cell].planes.end());
    part.volume_mm3 += piece.volume_mm3;
  }
  for (const Cell& cell : cells)
    for (const int sample : cell.samples) mark_[sample] = -1;
  if (std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.part < 0; }))
    return std::nullopt;

  // A part lives in the node of the cell where its own piece is alone, else in a new one.
  std::vector<std::vector<std::size_t>> of_cell(cells.size());
  for (std::size_t i = 0; i < pieces.size(); ++i) of_cell[pieces[i].cell].push_back(i);
  for (Cell& part : parts) part.node = add_part_node(tree);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    CutNode& node = tree[cells[c].node];
    auto members = std::make_shared<std::vector<std::vector<int>>>();
    for (const std::size_t i : of_cell[c]) {
      node.next.push_back(parts[pieces[i].part].node);
      members->push_back(pieces[i].samples);
    }
    if (of_cell[c].empty()) continue;
    node.kind = of_cell[c].size() == 1 ? CutNode::Kind::kSame : CutNode::Kind::kPieces;
    if (of_cell[c].size() > 1) node.members = std::move(members);
  }
  for (Cell& part : parts) {
    std::sort(part.samples.begin(), part.samples.end());
    drop_repeated(part.planes);
  }
  return parts;
}

bool CutBench::glue_is_enough(const CutState& state, const std::vector<Cell>& parts) const {
  const double least_links = kGlueMargin * rules_.least_glue_mm2 / samples_.area_per_link_mm2;
  const int first = state.count() - static_cast<int>(parts.size());
  for (int i = 0; i < static_cast<int>(parts.size()); ++i) {
    std::map<int, int> links;
    for (const int sample : parts[i].samples)
      for (const int other : samples_.near_to(sample)) ++links[state.piece_of_sample[other]];
    for (const auto& [piece, count] : links)
      if (piece != first + i && count < least_links) return false;
  }
  return true;
}

int CutBench::shut_cavities(const CutState& state) const {
  int shut = 0;
  for (const std::vector<int>& round_it : samples_.round_cavities) {
    const int piece = state.piece_of_sample[round_it.front()];
    shut += std::all_of(round_it.begin(), round_it.end(),
                        [&](int sample) { return state.piece_of_sample[sample] == piece; })
                ? 1
                : 0;
  }
  return shut;
}

// Whether the part ends at the plane somewhere.
bool CutBench::bounds(const CutState& state, const Cell& part, const Plane& plane) const {
  return std::any_of(part.samples.begin(), part.samples.end(), [&](int sample) {
    const double distance = plane.signedDistance(samples_.points[sample]);
    if (std::abs(distance) > samples_.spacing_mm) return false;
    const auto beside = samples_.linked_to(sample);
    return std::any_of(beside.begin(), beside.end(), [&](int other) {
      return state.piece_of_sample[other] != state.piece_of_sample[sample] &&
             plane.signedDistance(samples_.points[other]) * distance <= 0;
    });
  });
}

std::optional<CutState> CutBench::recut(const CutState& state, const std::vector<int>& group,
                                        const CutRecipe& recipe, int most_parts) {
  CutState next;
  next.tree = state.tree;
  Cell region;
  std::vector<char> in_group(state.pieces.size(), 0);
  for (const int piece : group) {
    const CutPiece& one = *state.pieces[piece];
    in_group[piece] = 1;
    region.samples.insert(region.samples.end(), one.shape.samples.begin(), one.shape.samples.end());
    region.planes.insert(region.planes.end(), one.shape.planes.begin(), one.shape.planes.end());
  }
  std::sort(region.samples.begin(), region.samples.end());
  drop_repeated(region.planes);
  region.node = add_part_node(next.tree);
  for (const int piece : group) {
    CutNode& node = next.tree[state.pieces[piece]->node];
    node.kind = CutNode::Kind::kSame;
    node.next = {region.node};
  }
  auto parts = connected(cut(region, recipe, next.tree), next.tree);
  if (!parts) return std::nullopt;
  const int kept = state.count() - static_cast<int>(group.size());
  if (kept + static_cast<int>(parts->size()) > most_parts) return std::nullopt;

  next.piece_of_sample.resize(samples_.count());
  std::vector<int> new_index(state.pieces.size(), -1);
  for (int i = 0; i < state.count(); ++i) {
    if (in_group[i]) continue;
    new_index[i] = next.count();
    next.pieces.push_back(state.pieces[i]);
  }
  for (int i = 0; i < samples_.count(); ++i)
    next.piece_of_sample[i] = new_index[state.piece_of_sample[i]];
  for (std::size_t i = 0; i < parts->size(); ++i)
    for (const int sample : (*parts)[i].samples)
      next.piece_of_sample[sample] = kept + static_cast<int>(i);
  next.pieces.resize(kept + parts->size());
  if (!glue_is_enough(next, *parts)) return std::nullopt;
  next.shut_cavities = shut_cavities(next);
  if (next.shut_cavities > state.shut_cavities) return std::nullopt;
  std::vector<char> fits;
  for (const Cell& part : *parts) fits.push_back(fits_build(part.samples) ? 1 : 0);
  double unfit_mm3 = 0, unfit_before_mm3 = 0;
  for (std::size_t i = 0; i < parts->size(); ++i)
    if (!fits[i]) unfit_mm3 += (*parts)[i].volume_mm3;
  for (const int piece : group)
    if (!state.pieces[piece]->fits) unfit_before_mm3 += state.pieces[piece]->shape.volume_mm3;
  if (unfit_mm3 > unfit_before_mm3 + kRounding * samples_.volume_mm3) return std::nullopt;

  for (std::size_t i = 0; i < parts->size(); ++i) {
    Cell& part = (*parts)[i];
    std::erase_if(part.planes, [&](const Plane& plane) { return !bounds(next, part, plane); });
    CutPiece piece;
    piece.shape = {std::move(part.samples), std::move(part.planes), part.volume_mm3};
    piece.standing = stand_alone(samples_, piece.shape, rules_.support_angle);
    piece.fits = fits[i] != 0;
    piece.node = part.node;
    next.pieces[kept + i] = std::make_shared<const CutPiece>(std::move(piece));
  }
  return next;
}

}  // namespace packmerger
