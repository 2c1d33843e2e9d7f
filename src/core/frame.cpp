#include "gridlock/core/frame.hpp"

#include <algorithm>

namespace gridlock {

FrameColumn const* Frame::find(std::string_view name) const {
  auto const found = std::ranges::find(columns, name, &FrameColumn::name);
  return found == columns.end() ? nullptr : &*found;
}

}  // namespace gridlock
