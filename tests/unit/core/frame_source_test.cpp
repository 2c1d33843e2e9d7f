#include "gridlock/core/frame_source.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <iterator>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/random.hpp"

namespace gridlock {
namespace {

/// Disks of which some are gone, so that rows are not in the order of the Ids.
State disks_after_deaths(std::size_t births, std::size_t deaths) {
  RandomStream random(3, 0, 0, Purpose::start_position);
  State state{.box = Box(2.0, 3.0, Edge::periodic), .clock = {5, 2.5}, .seed = 11};
  for (std::size_t k = 0; k < births; ++k) {
    state.agents.add(random.uniform(), random.uniform(), random.normal(), random.normal(), 0.01, 1.0,
                     static_cast<std::int32_t>(random.bits()), 0);
  }
  for (std::size_t k = 0; k < deaths; ++k) state.agents.remove(state.agents.ids()[random.below(state.agents.size())]);
  return state;
}

/// The frame put together from pieces of random sizes, the columns in a random order.
Frame from_pieces(FrameSource const& source, RandomStream& random) {
  Frame frame{
      .box = source.box(), .clock = source.clock(), .seed = source.seed(), .ids = {}, .columns = source.columns()};
  std::vector<bool> is_done(source.columns().size() + 1);
  for (std::size_t done = 0; done < is_done.size();) {
    std::size_t const column = random.below(is_done.size());
    if (is_done[column]) continue;
    is_done[column] = true;
    ++done;
    for (std::size_t first = 0; first < source.size();) {
      std::size_t const count = std::min<std::size_t>(random.below(40), source.size() - first);
      if (column == source.columns().size()) {
        std::ranges::copy(source.ids(first, count), std::back_inserter(frame.ids));
      } else {
        FrameValues const piece = source.values(column, first, count);
        std::visit(
            [&](auto& all) {
              std::ranges::copy(std::get<std::remove_reference_t<decltype(all)>>(piece), std::back_inserter(all));
            },
            frame.columns[column].values);
      }
      first += count;
    }
  }
  return frame;
}

TEST(FrameSource, PiecesOfAnySizesAreTheWholeInTheOrderOfTheIds) {
  RandomStream random(4, 0, 0, Purpose::start_position);
  for (std::size_t const deaths : {0, 90}) {
    State const state = disks_after_deaths(300, deaths);
    Frame const whole = frame_of(state);
    EXPECT_TRUE(std::ranges::is_sorted(whole.ids));
    for (std::size_t row = 0; row < whole.size(); ++row) {
      std::size_t const place = state.agents.index_of(whole.ids[row]);
      EXPECT_EQ(std::get<std::vector<double>>(whole.find("velocity_y")->values)[row],
                state.agents.column<VelocityY>()[place]);
      EXPECT_EQ(std::get<std::vector<std::int32_t>>(whole.find("image_x")->values)[row],
                state.agents.column<ImageX>()[place]);
    }
    for (int round = 0; round < 5; ++round) {
      EXPECT_EQ(from_pieces(*frame_source_of(state), random), whole);
      EXPECT_EQ(from_pieces(*frame_source_of(whole), random), whole);
    }
  }
}

TEST(FrameSource, OfNobodyHasColumnsAndNoRows) {
  State const nobody;
  std::unique_ptr<FrameSource> const source = frame_source_of(nobody);
  EXPECT_EQ(source->size(), 0U);
  EXPECT_EQ(source->whole().columns, source->columns());
  EXPECT_EQ(source->columns().size(), 8U);
}

TEST(FrameSource, WithSomeColumnsHasTheseAlone) {
  State const state = disks_after_deaths(50, 10);
  std::unique_ptr<FrameSource> const all = frame_source_of(state);
  std::unique_ptr<FrameSource> const source = frame_source_of(state);
  std::unique_ptr<FrameSource> const some = with_columns(*source, {6, 1});
  EXPECT_EQ(some->find("x"), std::nullopt);
  EXPECT_EQ(some->find("y"), 1U);
  EXPECT_EQ(some->ids(3, 20), all->ids(3, 20));
  EXPECT_EQ(some->values(0, 3, 20), all->values(6, 3, 20));
  EXPECT_EQ(some->clock(), state.clock);
}

}  // namespace
}  // namespace gridlock
