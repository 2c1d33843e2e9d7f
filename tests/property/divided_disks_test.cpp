// Runs of disks whose rows are divided among ranks, here threads: the files of one process, to the bit.

#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/setup.hpp"
#include "runs_on_ranks.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;
using test::carry_out;
using test::expect_same_results;

/// A run of any kind that ranks can divide: starts that each rank makes by itself, and those that are handed out.
std::string any_run(std::uint64_t seed, fs::path const& start_file) {
  RandomStream random(seed, 0, 0, Purpose::start_position);
  auto const is = [&] { return random.below(2) == 0; };
  std::uint64_t const kind = random.below(4);
  std::uint64_t const count = kind == 0   ? 2001 + random.below(2500)
                              : kind == 1 ? 1 + random.below(12)
                                          : 50 + random.below(900);
  std::string text = "[box]\nedge = \"" + std::string(is() ? "wall" : "periodic") + "\"\n";
  if (is()) text += "height = " + std::to_string(0.6 + random.uniform()) + "\n";
  text += "[disks]\n";
  if (kind == 3) {
    text = "[disks]\nfile = \"" + start_file.string() + "\"\n";
  } else {
    text += "count = " + std::to_string(count) +
            "\npacking_fraction = " + std::to_string(0.05 + 0.35 * random.uniform()) + "\nstart = \"" +
            std::vector<std::string>{"square", "triangular", "random"}[random.below(kind == 0 ? 2 : 3)] + "\"\n";
    if (count > 20 && is()) text += "species = [{fraction = 0.5}, {fraction = 0.5, size_ratio = 1.4, mass = 3.0}]\n";
  }
  text += "[velocities]\nkind = \"" + std::string(is() ? "maxwell" : "uniform") + "\"\n";
  text += "[engine]\nkind = \"tiled\"\ntime_step = " + std::to_string(0.02 + 0.05 * random.uniform()) + "\n";
  text += "[observe]\nevery = " + std::to_string(1 + random.below(20)) +
          "\nstructure_every = " + std::to_string(1 + random.below(2)) +
          "\nvelocity_origin_every = " + std::to_string(random.below(3)) + "\n";
  text += "[trajectory]\nevery = " + std::to_string(5 + random.below(20)) + "\n";
  text += "[run]\nsteps = 40\nseed = " + std::to_string(seed) + "\n";
  return text;
}

class DividedDisksTest : public ::testing::Test {
 protected:
  DividedDisksTest() {
    // In an order that is not that of the Ids.
    State state = make_start(Box(1.0, 1.2, Edge::periodic), {.count = 300, .packing_fraction = 0.3}, 3);
    draw_velocities(state, {});
    State mixed{.box = state.box};
    for (std::size_t k = 0; k < 300; ++k) {
      std::size_t const i = 7 * k % 300;
      EXPECT_TRUE(mixed.agents.add_as(2 * i + 5, state.agents.column<X>()[i], state.agents.column<Y>()[i],
                                      state.agents.column<VelocityX>()[i], state.agents.column<VelocityY>()[i],
                                      state.agents.column<Radius>()[i], 1.0, 0, 0));
    }
    write_xyz(mixed, start_file_);
  }

  TemporaryDirectory temporary_;
  fs::path start_file_ = temporary_ / "start_of_all.xyz";
};

TEST_F(DividedDisksTest, HaveTheFilesOfOneProcess) {
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    std::string const text = any_run(seed, start_file_);
    fs::path const one = temporary_ / ("one" + std::to_string(seed));
    carry_out(text, one, 0);
    for (std::size_t const ranks : {1U, 2U, 5U}) {
      fs::path const many = temporary_ / ("many" + std::to_string(seed) + "_" + std::to_string(ranks));
      carry_out(text, many, ranks);
      ASSERT_NO_FATAL_FAILURE(expect_same_results(
          one, many, "seed " + std::to_string(seed) + " on " + std::to_string(ranks) + " ranks\n" + text));
    }
  }
}

TEST_F(DividedDisksTest, ContinueOnAnotherNumberOfRanksAndInOneProcess) {
  for (std::uint64_t seed = 100; seed < 112; ++seed) {
    std::string const text = any_run(seed, start_file_);
    fs::path const one = temporary_ / ("one" + std::to_string(seed));
    fs::path const many = temporary_ / ("many" + std::to_string(seed));
    carry_out(text, one, 0);
    std::vector<std::size_t> const numbers = seed % 3 == 0   ? std::vector<std::size_t>{3, 0, 2}
                                             : seed % 3 == 1 ? std::vector<std::size_t>{0, 4, 1}
                                                             : std::vector<std::size_t>{4, 2, 0};
    EXPECT_EQ(carry_out(text, many, numbers[0], 11), RunStatus::interrupted);
    EXPECT_EQ(carry_out(text, many, numbers[1], 25), RunStatus::interrupted);
    EXPECT_EQ(carry_out(text, many, numbers[2]), RunStatus::finished);
    ASSERT_NO_FATAL_FAILURE(expect_same_results(one, many, "seed " + std::to_string(seed) + "\n" + text));
  }
}

TEST_F(DividedDisksTest, RefuseWhatOneProcessRefuses) {
  State state{.box = Box(1.0, 1.0, Edge::wall)};
  for (std::size_t i = 0; i < 40; ++i)
    state.agents.add(0.3 + 0.01 * static_cast<double>(i), 0.5, 0.1, 0.0, 0.01, 1.0, 0, 0);
  write_xyz(state, temporary_ / "overlapping.xyz");
  state.agents.column<X>()[39] = -0.4;
  write_xyz(state, temporary_ / "outside.xyz");
  for (std::string const& wrong :
       {"[disks]\nfile = \"" + (temporary_ / "overlapping.xyz").string() + "\"\n",
        "[disks]\nfile = \"" + (temporary_ / "outside.xyz").string() + "\"\n",
        std::string("[disks]\ncount = 5000\npacking_fraction = 0.95\n"),
        std::string("[disks]\ncount = 5000\npacking_fraction = 0.5\n[velocities]\nkind = \"file\"\n"),
        std::string(
            "[disks]\ncount = 5000\npacking_fraction = 0.1\n[velocities]\nmax = 5.0\n[engine]\nspeed = 0.01\n")}) {
    std::string const text = wrong + (wrong.find("[engine]") == std::string::npos ? "[engine]\n" : "") +
                             "kind = \"tiled\"\n[run]\nsteps = 5\n";
    auto const problem_of = [&](std::size_t ranks) {
      try {
        carry_out(text, temporary_ / "refused", ranks);
      } catch (Error const& error) {
        return std::string(error.what());
      }
      return std::string();
    };
    std::string const one = problem_of(0);
    EXPECT_NE(one, "") << text;
    EXPECT_EQ(one, problem_of(3)) << text;
  }
}

}  // namespace
}  // namespace gridlock
