#include "gridlock/core/frame.hpp"

#include <algorithm>
#include <numeric>

namespace gridlock {

FrameColumn const* Frame::find(std::string_view name) const {
  auto const found = std::ranges::find(columns, name, &FrameColumn::name);
  return found == columns.end() ? nullptr : &*found;
}

std::vector<std::size_t> rows_in_order(std::span<Id const> ids) {
  std::vector<std::size_t> rows(ids.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  if (!std::ranges::is_sorted(ids)) {
    std::ranges::sort(rows, {}, [&](std::size_t row) { return ids[row]; });
  }
  return rows;
}

Frame frame_of(State const& state) { return frame_of(state.box, state.clock, state.seed, state.disks); }

}  // namespace gridlock
