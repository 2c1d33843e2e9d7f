#include "io/h5md_text.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "io/xyz_writer.hpp"

namespace gridlock {

TrajectoryText text_of_trajectory(std::filesystem::path const& path) {
  auto const trajectory = std::make_shared<H5mdReader>(path);
  if (trajectory->frame_count() == 0) {
    throw Error({.what = fmt::format("{} is a trajectory without frames", path.string()),
                 .hint = "wait for the first, or name another file",
                 .file = path.string()});
  }
  ReadBytes bytes = [trajectory, text = std::string(), place = std::size_t{0},
                     next = std::size_t{0}](std::span<char> into) mutable -> std::size_t {
    if (place == text.size()) {
      if (next == trajectory->frame_count()) return 0;
      text = xyz_text(*frame_source_of(trajectory->frame(next++).frame));
      place = 0;
    }
    std::size_t const count = text.copy(into.data(), into.size(), place);
    place += count;
    return count;
  };
  return {.bytes = std::move(bytes), .left_out = trajectory->settings().left_out};
}

}  // namespace gridlock
