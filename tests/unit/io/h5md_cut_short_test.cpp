// A trajectory whose writer was killed in the middle of a frame, made with HDF5 itself.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "gridlock/io/h5md.hpp"
#include "io/hdf5.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// As after a kill: all of the last frame is there but its step, with which it counts.
void take_last_step_off(std::filesystem::path const& path, hsize_t steps) {
  hdf5::Handle file = hdf5::open_file(path, hdf5::Access::append);
  hdf5::Handle const step = hdf5::open_dataset(file, "/particles/disks/id/step");
  hdf5::require(H5Dset_extent(step.id(), &steps), "take the step off");
  hdf5::flush(file);
}

/// Three agents; `wraps` of each across the edge is the fill value of its chunk where it is 0.
H5mdFrame frame_at(std::uint64_t step, std::int32_t wraps) {
  Frame const frame{.box = Box(1.0, 1.0, Edge::periodic),
                    .clock = {step, 0.5 * static_cast<double>(step)},
                    .seed = 1,
                    .ids = {0, 1, 2},
                    .columns = {{"x", std::vector<double>{0.1, 0.2, 0.3}},
                                {"y", std::vector<double>{0.4, 0.5, 0.6}},
                                {"image_x", std::vector<std::int32_t>(3, wraps)},
                                {"image_y", std::vector<std::int32_t>(3, wraps)}}};
  return {.frame = frame, .observables = {}, .state_hash = step};
}

TEST(H5md, AFrameThatWasCutShortLeavesNothingInTheOneInItsPlace) {
  TemporaryDirectory const directory;
  H5mdWriter::create(directory / "t.h5", {.agents = "disks"}, frame_at(0, 0).frame).write(frame_at(0, 0));
  H5mdWriter::append(directory / "t.h5", frame_at(0, 0).frame).write(frame_at(1, 7));
  take_last_step_off(directory / "t.h5", 1);
  H5mdWriter writer = H5mdWriter::append(directory / "t.h5", frame_at(0, 0).frame);
  ASSERT_EQ(writer.frame_count(), 1U);
  writer.write(frame_at(2, 0));
  H5mdReader const reader(directory / "t.h5");
  ASSERT_EQ(reader.frame_count(), 2U);
  EXPECT_EQ(reader.frame(0).frame, frame_at(0, 0).frame);
  EXPECT_EQ(reader.frame(1).frame, frame_at(2, 0).frame);
}

/// As many agents with no other numbers than their own.
H5mdFrame frame_of_many(std::uint64_t step, std::size_t agents) {
  Frame frame{.box = Box(1.0, 1.0, Edge::periodic), .clock = {step, 0.0}, .seed = 1, .ids = {}, .columns = {}};
  std::vector<double> x;
  for (std::size_t k = 0; k < agents; ++k) {
    frame.ids.push_back(k);
    x.push_back(static_cast<double>(step) + 0.001 * static_cast<double>(k));
  }
  frame.columns = {{"x", x}, {"y", std::vector<double>(agents)}};
  return {.frame = frame, .observables = {}, .state_hash = step};
}

TEST(H5md, AFrameThatWasCutShortMayHaveHadMoreAgents) {
  // Chunks have 64 rows here.
  for (std::size_t const agents : {0, 10, 64, 100, 128, 150}) {
    TemporaryDirectory const directory;
    H5mdFrame const first = frame_of_many(0, 3);
    H5mdWriter::create(directory / "t.h5", {.agents = "disks"}, first.frame).write(first);
    H5mdWriter::append(directory / "t.h5", first.frame).write(frame_of_many(1, 150));
    take_last_step_off(directory / "t.h5", 1);
    H5mdWriter::append(directory / "t.h5", first.frame).write(frame_of_many(2, agents));
    EXPECT_EQ(H5mdReader(directory / "t.h5").frame(1).frame, frame_of_many(2, agents).frame) << agents;
  }
}

TEST(H5md, AFirstFrameOfNobodyThatWasCutShortIsWrittenAgain) {
  TemporaryDirectory const directory;
  Frame const nobody{.box = Box(1.0, 1.0, Edge::periodic),
                     .seed = 1,
                     .ids = {},
                     .columns = {{"x", std::vector<double>{}}, {"y", std::vector<double>{}}}};
  H5mdFrame const frame{.frame = nobody, .observables = {}, .state_hash = 5};
  H5mdWriter::create(directory / "t.h5", {.agents = "disks"}, nobody).write(frame);
  take_last_step_off(directory / "t.h5", 0);
  H5mdWriter::append(directory / "t.h5", nobody).write(frame);
  H5mdReader const reader(directory / "t.h5");
  ASSERT_EQ(reader.frame_count(), 1U);
  EXPECT_EQ(reader.frame(0).frame, nobody);
}

}  // namespace
}  // namespace gridlock
