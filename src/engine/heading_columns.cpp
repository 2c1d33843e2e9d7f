#include "engine/heading_columns.hpp"

#include <cstddef>
#include <utility>
#include <vector>

#include "engine/headings.hpp"

namespace gridlock {

namespace {

/// A frame with two more columns, the parts of headings.
class FrameWithHeadings final : public FrameSource {
 public:
  FrameWithHeadings(Frame head, FrameSource const& of_world, std::span<Vector const> headings)
      : FrameSource(std::move(head), of_world.size(), of_world.fields(), of_world.networks()),
        of_world_(of_world),
        headings_(headings) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    return of_world_.ids(first, count);
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    std::size_t const columns = of_world_.columns().size();
    if (column < columns) return of_world_.values(column, first, count);
    std::vector<double> part;
    part.reserve(count);
    for (Vector const heading : piece_of_headings(first, count))
      part.push_back(column == columns ? heading.x : heading.y);
    return part;
  }

 private:
  [[nodiscard]] std::vector<Vector> piece_of_headings(std::size_t first, std::size_t count) const {
    if (!headings_.empty()) {
      std::span<Vector const> const piece = headings_.subspan(first, count);
      return {piece.begin(), piece.end()};
    }
    auto const x = std::get<std::vector<double>>(of_world_.values(*of_world_.find("velocity_x"), first, count));
    auto const y = std::get<std::vector<double>>(of_world_.values(*of_world_.find("velocity_y"), first, count));
    std::vector<Vector> headings;
    headings.reserve(count);
    for (std::size_t k = 0; k < count; ++k) headings.push_back(direction_of({x[k], y[k]}));
    return headings;
  }

  FrameSource const& of_world_;
  std::span<Vector const> headings_;  ///< empty: those of the velocities
};

}  // namespace

void give_frame_with_headings(PropulsionSettings const& propulsion, FrameSource const& of_world, UseFrame const& use) {
  give_frame_with_headings(propulsion, {}, of_world, use);
}

void give_frame_with_headings(PropulsionSettings const& propulsion, std::span<Vector const> headings,
                              FrameSource const& of_world, UseFrame const& use) {
  if (!propulsion.is_on()) {
    use(of_world);
    return;
  }
  Frame head{.box = of_world.box(),
             .clock = of_world.clock(),
             .seed = of_world.seed(),
             .ids = {},
             .columns = of_world.columns()};
  head.columns.push_back({"heading_x", std::vector<double>()});
  head.columns.push_back({"heading_y", std::vector<double>()});
  use(FrameWithHeadings(std::move(head), of_world, headings));
}

}  // namespace gridlock
