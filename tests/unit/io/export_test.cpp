#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/table.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// Five frames of two agents, at the steps 0, 10, 20, 30, 40 of a quarter of the unit of time each.
H5mdReader five_frames(TemporaryDirectory const& directory, Box const& box = Box(1.0, 1.0, Edge::wall)) {
  Population<X, Y> agents;
  agents.add(0.25, 0.5);
  agents.add(0.75, 0.5);
  auto const frame_at = [&](std::uint64_t step) {
    return frame_of(box, {step, 0.25 * static_cast<double>(step)}, 1, agents);
  };
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", {}, frame_at(0));
  for (std::uint64_t step = 0; step <= 40; step += 10) {
    writer.write({.frame = frame_at(step), .observables = {}, .state_hash = step});
  }
  return H5mdReader(directory / "t.h5");
}

TEST(Export, TakesOneOfEverySoManyFrames) {
  TemporaryDirectory const directory;
  H5mdReader const trajectory = five_frames(directory);
  auto const steps = [&](std::size_t every) {
    export_trajectory(trajectory, {.format = "csv", .file = directory / "t.csv", .every = every});
    return read_csv(directory / "t.csv").numbers("step");
  };
  EXPECT_EQ(steps(1), (std::vector<double>{0, 0, 10, 10, 20, 20, 30, 30, 40, 40}));
  EXPECT_EQ(steps(2), (std::vector<double>{0, 0, 20, 20, 40, 40}));
  EXPECT_EQ(steps(3), (std::vector<double>{0, 0, 30, 30}));
}

TEST(Export, AsVtkListsEachFrameAtItsTime) {
  TemporaryDirectory const directory;
  H5mdReader const trajectory = five_frames(directory);
  auto const files = export_trajectory(trajectory, {.format = "vtk", .file = directory / "t.pvd", .every = 3});
  ASSERT_EQ(files.size(), 3U);
  std::string const list = read_file(files.front());
  EXPECT_NE(list.find("<DataSet timestep=\"0\" file=\"t/step_0000000000.vtp\"/>\n"
                      "<DataSet timestep=\"7.5\" file=\"t/step_0000000030.vtp\"/>\n</Collection>"),
            std::string::npos)
      << list;
  EXPECT_NE(read_file(files.back())
                .find("Name=\"TimeValue\" NumberOfComponents=\"1\" NumberOfTuples=\"1\" "
                      "format=\"ascii\">\n7.5\n"),
            std::string::npos);
}

TEST(Export, AsVtkHasTheSidesAndTheTiltOfTheBox) {
  TemporaryDirectory const directory;
  H5mdReader const trajectory = five_frames(directory, Box(2.0, 1.0, Edge::periodic).tilted(0.25));
  auto const files = export_trajectory(trajectory, {.format = "vtk", .file = directory / "t.pvd", .every = 3});
  std::string const frame = read_file(files.back());
  for (char const* const array : {R"(Name="box" NumberOfComponents="2" NumberOfTuples="1" format="ascii">)"
                                  "\n2 1\n",
                                  R"(Name="tilt" NumberOfComponents="1" NumberOfTuples="1" format="ascii">)"
                                  "\n0.25\n"}) {
    EXPECT_NE(frame.find(array), std::string::npos) << frame;
  }
}

}  // namespace
}  // namespace gridlock
