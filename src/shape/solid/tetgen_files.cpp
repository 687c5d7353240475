#include "shape/solid/tetgen_files.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>

#include "base/error.h"

namespace packmerger {
namespace {

constexpr std::uint64_t kMaxBytes = std::uint64_t{8} << 30;

[[noreturn]] void damaged() {
  throw Error(Fault::kInternal, "The file between packmerger and packmerger-tetgen is damaged",
              "Check the free space of the temporary folder and try again.");
}

// A vector is its length in 8 bytes and its elements as they lie in memory.
template <typename T>
void put(std::string& bytes, const std::vector<T>& items) {
  const std::uint64_t count = items.size();
  bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
  bytes.append(reinterpret_cast<const char*>(items.data()), count * sizeof(T));
}

template <typename T>
std::vector<T> take(std::string_view& bytes) {
  std::uint64_t count = 0;
  if (bytes.size() < sizeof count) damaged();
  std::memcpy(&count, bytes.data(), sizeof count);
  bytes.remove_prefix(sizeof count);
  if (count > bytes.size() / sizeof(T)) damaged();
  std::vector<T> items(count);
  if (count > 0) std::memcpy(static_cast<void*>(items.data()), bytes.data(), count * sizeof(T));
  bytes.remove_prefix(count * sizeof(T));
  return items;
}

template <std::size_t N>
void check_indices(const std::vector<std::array<int, N>>& cells, std::size_t points) {
  for (const auto& cell : cells)
    for (const int corner : cell)
      if (corner < 0 || static_cast<std::size_t>(corner) >= points) damaged();
}

static_assert(sizeof(Vec3) == 3 * sizeof(double));

}  // namespace

void write_tetgen_input(const fs::path& path, const TetgenInput& input) {
  std::string bytes;
  put(bytes, std::vector<char>(input.flags.begin(), input.flags.end()));
  put(bytes, input.points);
  put(bytes, input.facets);
  put(bytes, input.markers);
  put(bytes, input.holes);
  write_file_whole(path, bytes);
}

TetgenInput read_tetgen_input(const fs::path& path) {
  const std::string file = read_file(path, kMaxBytes);
  std::string_view bytes = file;
  TetgenInput input;
  const std::vector<char> flags = take<char>(bytes);
  input.flags.assign(flags.begin(), flags.end());
  input.points = take<Vec3>(bytes);
  input.facets = take<std::array<int, 3>>(bytes);
  input.markers = take<int>(bytes);
  input.holes = take<Vec3>(bytes);
  check_indices(input.facets, input.points.size());
  if (input.markers.size() != input.facets.size()) damaged();
  return input;
}

void write_tetgen_output(const fs::path& path, const TetgenOutput& output) {
  std::string bytes;
  put(bytes, output.points);
  put(bytes, output.tetrahedra);
  put(bytes, output.faces);
  put(bytes, output.markers);
  write_file_whole(path, bytes);
}

TetgenOutput read_tetgen_output(const fs::path& path) {
  const std::string file = read_file(path, kMaxBytes);
  std::string_view bytes = file;
  TetgenOutput output;
  output.points = take<Vec3>(bytes);
  output.tetrahedra = take<std::array<int, 4>>(bytes);
  output.faces = take<std::array<int, 3>>(bytes);
  output.markers = take<int>(bytes);
  check_indices(output.tetrahedra, output.points.size());
  check_indices(output.faces, output.points.size());
  if (output.markers.size() != output.faces.size()) damaged();
  return output;
}

}  // namespace packmerger
