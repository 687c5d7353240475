#include "pack/drop/pooled_field.h"

#include <algorithm>

#include "pack/drop/fall.h"

namespace packmerger {
namespace {

// Of `count` entries each the least of itself and of the kPool - 1 that lie `step` apart behind it,
// as far as there are any.
void pool(Height* values, std::ptrdiff_t count, std::ptrdiff_t step) {
  static_assert(kPool == 4, "two halvings");
  for (const std::ptrdiff_t apart : {step, 2 * step})
    for (std::ptrdiff_t i = 0; i + apart < count; ++i)
      values[i] = std::min(values[i], values[i + apart]);
}

}  // namespace

PooledField::PooledField(const HeightField& field)
    : border_(field.border()), groups_((field.stride() + kPool - 1) / kPool) {
  const std::ptrdiff_t columns = field.stride();
  const std::ptrdiff_t rows = field.rows();
  const Height* first = field.origin() - border_ * columns - border_;
  std::vector<Height> least(first, first + rows * columns);
  pool(least.data(), rows * columns, columns);
  values_.assign(static_cast<std::size_t>(rows * stride()) + kFallReadAhead, kBarePlate);
  for (std::ptrdiff_t row = 0; row < rows; ++row) {
    Height* of_row = &least[static_cast<std::size_t>(row * columns)];
    pool(of_row, columns, 1);
    Height* to = &values_[static_cast<std::size_t>(row * stride())];
    for (std::ptrdiff_t column = 0; column < columns; ++column)
      to[place(static_cast<int>(column))] = of_row[column];
  }
}

}  // namespace packmerger
