#include "shape/divide/segment.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <tuple>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "shape/divide/manifold_parts.h"

namespace packmerger {
namespace {

constexpr int kUnassigned = -1;

// The paper's dual graph: a node for every tetrahedron.
struct DualGraph {
  // All that growth reads of a node, on half a cache line.
  struct alignas(32) Node {
    std::array<int, 4> neighbours;
    std::array<float, 4> lengths_mm;  // of the edges to them
  };

  explicit DualGraph(const TetMesh& mesh) : nodes(mesh.tetrahedra.size()) {
    for (int t = 0; t < mesh.count(); ++t) {
      centroids.push_back(mesh.centroid(t));
      volumes.push_back(mesh.volume_mm3(t));
      volume += volumes.back();
    }
    double sum = 0;
    int edges = 0;
    for (int t = 0; t < mesh.count(); ++t) {
      nodes[t] = {mesh.neighbours[t], {}};
      for (int face = 0; face < 4; ++face) {
        const int across = mesh.neighbours[t][face];
        if (across < 0) continue;
        const double length = (centroids[t] - centroids[across]).norm();
        nodes[t].lengths_mm[face] = static_cast<float>(length);
        sum += length;
        ++edges;
      }
    }
    if (sum > 0) bucket_mm = sum / edges / 4;
  }
  int count() const { return static_cast<int>(nodes.size()); }

  std::vector<Node> nodes;
  std::vector<Vec3> centroids;
  std::vector<double> volumes;  // mm³
  double volume = 0;            // V_o
  double bucket_mm = 1;         // a quarter of the mean edge
};

// A tetrahedron that a cluster may take next.
struct Offer {
  double distance_mm;  // from the cluster's seed through the cluster
  int tetrahedron;
  int cluster;
  bool operator>(const Offer& other) const {
    return std::tie(distance_mm, tetrahedron, cluster) >
           std::tie(other.distance_mm, other.tetrahedron, other.cluster);
  }
};

// A priority queue for growth, where nothing is ever offered below what was taken last: offers lie
// in buckets of equal width by distance, and only the bucket at hand is kept as a heap. The order
// is that of one large heap.
class Offers {
 public:
  explicit Offers(double width_mm) : per_mm_(1 / width_mm) {}

  void push(const Offer& offer) {
    const auto bucket = static_cast<std::size_t>(offer.distance_mm * per_mm_);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(offer);
    if (bucket == current_)
      std::push_heap(buckets_[bucket].begin(), buckets_[bucket].end(), std::greater<>());
  }

  bool pop(Offer& offer) {
    while (current_ < buckets_.size() && buckets_[current_].empty()) {
      if (++current_ < buckets_.size())
        std::make_heap(buckets_[current_].begin(), buckets_[current_].end(), std::greater<>());
    }
    if (current_ >= buckets_.size()) return false;
    std::vector<Offer>& heap = buckets_[current_];
    std::pop_heap(heap.begin(), heap.end(), std::greater<>());
    offer = heap.back();
    heap.pop_back();
    return true;
  }

 private:
  double per_mm_;
  std::size_t current_ = 0;
  std::vector<std::vector<Offer>> buckets_;
};

// The growth of one cluster or of many over unassigned tetrahedra.
class Growth {
 public:
  Growth(const DualGraph& graph, std::vector<int>& owner)
      : graph_(graph), owner_(owner), offers_(graph.bucket_mm) {}

  void seed(int tetrahedron, int cluster) { offers_.push({0, tetrahedron, cluster}); }

  // The tetrahedron that was assigned, or -1 when there is no room left.
  int step() {
    Offer taken{};
    do {
      if (!offers_.pop(taken)) return -1;
    } while (owner_[taken.tetrahedron] != kUnassigned);
    owner_[taken.tetrahedron] = taken.cluster;
    const DualGraph::Node& node = graph_.nodes[taken.tetrahedron];
    for (int face = 0; face < 4; ++face) {
      const int across = node.neighbours[face];
      if (across >= 0 && owner_[across] == kUnassigned)
        offers_.push({taken.distance_mm + node.lengths_mm[face], across, taken.cluster});
    }
    return taken.tetrahedron;
  }

 private:
  const DualGraph& graph_;
  std::vector<int>& owner_;
  Offers offers_;
};

// Grows one cluster from a seed until it holds `target` mm³; `taken` gets its tetrahedra. False
// where the room ended before.
bool grow_one(const DualGraph& graph, int seed, int cluster, double target, std::vector<int>& owner,
              std::vector<int>& taken) {
  Growth growth(graph, owner);
  growth.seed(seed, cluster);
  taken.clear();
  for (double volume = 0; volume < target;) {
    const int t = growth.step();
    if (t < 0) return false;
    taken.push_back(t);
    volume += graph.volumes[t];
  }
  return true;
}

// Parallel growth: all clusters at once until everything reachable is assigned.
std::vector<int> grow_all(const DualGraph& graph, const std::vector<int>& seeds) {
  std::vector<int> owner(graph.count(), kUnassigned);
  Growth growth(graph, owner);
  for (int cluster = 0; cluster < static_cast<int>(seeds.size()); ++cluster)
    growth.seed(seeds[cluster], cluster);
  while (growth.step() >= 0) {
  }
  return owner;
}

struct Centres {
  std::vector<Vec3> of_mass;
  std::vector<int> tetrahedra;  // of the cluster, nearest to its centre of mass
};

Centres centres(const DualGraph& graph, const std::vector<int>& owner, std::size_t clusters) {
  Centres result{std::vector<Vec3>(clusters, Vec3::Zero()), std::vector<int>(clusters, -1)};
  std::vector<double> volumes(clusters, 0);
  for (int t = 0; t < graph.count(); ++t) {
    if (owner[t] < 0) continue;
    result.of_mass[owner[t]] += graph.volumes[t] * graph.centroids[t];
    volumes[owner[t]] += graph.volumes[t];
  }
  for (std::size_t i = 0; i < clusters; ++i) result.of_mass[i] /= volumes[i];
  std::vector<double> nearest(clusters, std::numeric_limits<double>::infinity());
  for (int t = 0; t < graph.count(); ++t) {
    if (owner[t] < 0) continue;
    const double distance = (graph.centroids[t] - result.of_mass[owner[t]]).squaredNorm();
    if (distance >= nearest[owner[t]]) continue;
    nearest[owner[t]] = distance;
    result.tetrahedra[owner[t]] = t;
  }
  return result;
}

// Random sequential seeding. A seed that finds too little room has filled a whole pocket, which is
// then left out: it is marked so that nobody tries there again.
std::vector<int> sequential_seeds(const DualGraph& graph, int clusters, Random& random,
                                  const Progress& progress) {
  const double target = graph.volume / clusters;
  constexpr int kPocket = -2;
  std::vector<int> owner(graph.count(), kUnassigned);
  std::vector<int> order(graph.count());
  for (int t = 0; t < graph.count(); ++t) order[t] = t;
  random.shuffle(order);  // the next unassigned one in a random order is a random unassigned one
  std::vector<int> taken;
  int count = 0;
  for (const int start : order) {
    if (owner[start] != kUnassigned) continue;
    progress.check();
    if (grow_one(graph, start, count, target, owner, taken))
      ++count;
    else
      for (const int t : taken) owner[t] = kPocket;
  }
  return centres(graph, owner, count).tetrahedra;
}

// A component of the mesh without any seed would stay unassigned: it becomes one cluster.
void seed_remaining_components(const DualGraph& graph, std::vector<int>& seeds) {
  const double no_limit = std::numeric_limits<double>::infinity();
  std::vector<int> owner = grow_all(graph, seeds);
  std::vector<int> taken;
  for (int t = 0; t < graph.count(); ++t) {
    if (owner[t] != kUnassigned) continue;
    grow_one(graph, t, static_cast<int>(seeds.size()), no_limit, owner, taken);
    seeds.push_back(t);
  }
}

Segments clustered(const DualGraph& graph, std::vector<int> seeds, const ShapeSettings& settings,
                   const Progress& progress) {
  Segments segments;
  segments.count = static_cast<int>(seeds.size());
  std::vector<Vec3> before;
  for (const int seed : seeds) before.push_back(graph.centroids[seed]);
  for (int round = 0; round < std::max(1, settings.cluster_rounds); ++round) {
    progress.report("segmenting", static_cast<double>(round) / settings.cluster_rounds);
    segments.of_tetrahedron = grow_all(graph, seeds);
    Centres now = centres(graph, segments.of_tetrahedron, seeds.size());
    double moved_mm = 0;
    for (std::size_t i = 0; i < seeds.size(); ++i)
      moved_mm = std::max(moved_mm, (now.of_mass[i] - before[i]).norm());
    if (moved_mm < settings.cluster_epsilon_mm || now.tetrahedra == seeds) break;
    before = std::move(now.of_mass);
    seeds = std::move(now.tetrahedra);
  }
  return segments;
}

}  // namespace

Segments segment(TetMesh& mesh, const ShapeSettings& settings, std::uint64_t seed,
                 const Progress& progress) {
  if (mesh.count() == 0)
    throw Error(Fault::kBadInput, "The model holds no volume that could be divided",
                "Check that the model is a closed solid.");
  Segments segments;
  {
    const DualGraph graph(mesh);
    Random random(seed);
    std::vector<int> seeds =
        sequential_seeds(graph, std::max(1, settings.clusters), random, progress);
    seed_remaining_components(graph, seeds);
    segments = clustered(graph, std::move(seeds), settings, progress);
  }
  make_manifold(mesh, segments, progress, kFreeReach);
  progress.report("segmenting", 1);
  return segments;
}

}  // namespace packmerger
