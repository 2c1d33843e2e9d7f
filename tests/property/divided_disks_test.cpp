// Runs of disks whose rows are divided among ranks, here threads: the files of one process, to the bit.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "runs_on_ranks.hpp"
#include "thread_ranks.hpp"
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
  DividedDisksTest() { write_file(start_file_, text_of_disks(300)); }

  /// A file of disks in an order that is not that of the Ids, and not without gaps. `change` may change a row; it is
  /// given the Id.
  static std::string text_of_disks(
      std::size_t count, std::string const& columns = "id:I:1:pos:R:2:velo:R:2:radius:R:1",
      std::function<void(std::size_t row, std::string& line)> const& change = [](std::size_t, std::string&) {}) {
    State state = make_start(Box(1.0, 1.2, Edge::periodic), {.count = count, .packing_fraction = 0.3}, 3);
    draw_velocities(state, {});
    std::string text =
        std::to_string(count) + "\nLattice=\"1.0 0 0 0 1.2 0 0 0 1\" pbc=\"T T F\" Properties=" + columns + "\n";
    bool const has_velocities = columns.find("velo") != std::string::npos;
    bool const has_radii = columns.find("radius") != std::string::npos;
    for (std::size_t k = 0; k < count; ++k) {
      std::size_t const i = 7 * k % count;
      Disks const& disks = state.agents;
      std::string line = fmt::format("{} {} {}", 2 * i + 5, disks.column<X>()[i], disks.column<Y>()[i]);
      if (has_velocities) line += fmt::format(" {} {}", disks.column<VelocityX>()[i], disks.column<VelocityY>()[i]);
      if (has_radii) line += fmt::format(" {}", disks.column<Radius>()[i]);
      change(k, line);
      text += line + '\n';
    }
    return text;
  }

  /// What a run of these settings is refused for.
  [[nodiscard]] std::string refusal_of(std::string const& text, std::size_t ranks) const {
    try {
      carry_out(text, temporary_ / "refused", ranks);
    } catch (Error const& error) {
      std::string all;
      for (Problem const& problem : error.problems()) all += to_text(problem) + '\n';
      return all;
    }
    return {};
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
  State state{.box = Box(1.25, 0.8, Edge::wall)};
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
    std::string const one = refusal_of(text, 0);
    EXPECT_NE(one, "") << text;
    EXPECT_EQ(one, refusal_of(text, 3)) << text;
  }
}

/// Beyond 2,000 disks nobody reads the whole file.
constexpr std::size_t many = 2500;

std::string run_of_file(fs::path const& file, std::string const& disks = "", std::string const& more = "") {
  return "[disks]\nfile = \"" + file.string() + "\"\n" + disks + more +
         "[engine]\nkind = \"tiled\"\n[observe]\nevery = 5\n[trajectory]\nevery = 10\n[run]\nsteps = 20\nseed = 9\n";
}

TEST_F(DividedDisksTest, ReadAFileInPiecesAndHaveTheFilesOfOneProcess) {
  struct Start {
    std::string name, text, disks, more;
  };
  std::string const bare = "id:I:1:pos:R:2";
  auto const reborn = [](std::size_t row, std::string& line) {
    // Names that are used again: the order of the slots is not that of the Ids.
    if (row % 3 != 0) return;
    std::size_t const blank = line.find(' ');
    line = std::to_string(std::stoull(line) + ((Id{1} + row % 5) << 32)) + line.substr(blank);
  };
  auto const in_order = [n = std::size_t{0}](std::size_t, std::string& line) mutable {
    line = std::to_string(n++) + line.substr(line.find(' '));
  };
  for (Start const& start :
       {Start{"shuffled", text_of_disks(many), "", ""},
        Start{"in_order", text_of_disks(many, "id:I:1:pos:R:2:velo:R:2:radius:R:1", in_order), "", ""},
        Start{"reborn", text_of_disks(many, bare, reborn), "radius = 0.004\n", "[velocities]\ndrift = \"remove\"\n"},
        Start{"redrawn", text_of_disks(many), "", "[velocities]\nredraw = true\nkind = \"maxwell\"\n"},
        Start{"without_ids", text_of_disks(many, "tag:S:1:pos:R:2"), "packing_fraction = 0.3\n", ""}}) {
    fs::path const file = temporary_ / (start.name + ".xyz");
    write_file(file, start.text);
    std::string const text = run_of_file(file, start.disks, start.more);
    fs::path const one = temporary_ / (start.name + "_one");
    ASSERT_EQ(carry_out(text, one, 0), RunStatus::finished);
    for (std::size_t const ranks : {1U, 2U, 3U, 6U}) {
      fs::path const directory = temporary_ / (start.name + std::to_string(ranks));
      ASSERT_EQ(carry_out(text, directory, ranks), RunStatus::finished);
      ASSERT_NO_FATAL_FAILURE(
          expect_same_results(one, directory, start.name + " on " + std::to_string(ranks) + " ranks"));
    }
  }
}

TEST_F(DividedDisksTest, RefuseAFileAsOneProcessDoes) {
  std::string const columns = "id:I:1:pos:R:2:velo:R:2:radius:R:1";
  /// Changes rows of the file: replaces words of the line by their number.
  auto const changed = [&](std::vector<std::size_t> const& rows, std::size_t word, std::string const& fresh) {
    return text_of_disks(many, columns, [&](std::size_t row, std::string& line) {
      if (std::ranges::find(rows, row) == rows.end()) return;
      std::size_t at = 0;
      for (std::size_t k = 0; k < word; ++k) at = line.find(' ', at) + 1;
      line = line.substr(0, at) + fresh + line.substr(std::min(line.find(' ', at), line.size()));
    });
  };
  std::string const good = text_of_disks(many);
  struct Wrong {
    std::string text, disks, says;
  };
  fs::path const file = temporary_ / "wrong.xyz";
  for (Wrong const& wrong : {
           Wrong{"", "", "the file is empty"},
           Wrong{"2600" + good.substr(4), "", "the file ends after 2500 of 2600 disks"},
           Wrong{"1000000000000000000" + good.substr(4), "", "the file ends after 2500 of"},
           Wrong{good + "5 0.1 0.1 0 0 0.001\n", "", "continues after its 2500 disks"},
           Wrong{changed({1700}, 3, "fast"), "", "x velocity is \"fast\""},
           Wrong{changed({900}, 5, "0.001 7"), "", "the line has 7 columns"},
           Wrong{changed({2400}, 5, "-1"), "", "must be above 0"},
           Wrong{changed({100, 2300}, 0, "4001"), "", "the id 4001 is given twice, first on line"},
           Wrong{changed({2300}, 0, "4294971297"), "", "the id 4294971297 is given twice, first on line"},
           Wrong{changed({100, 2300}, 0, "4000000000"), "", "is out of proportion to 2500 disks"},
           Wrong{changed({100, 700, 1500, 2300, 2400}, 1, "1e12"), "", "boxes outside"},
           Wrong{changed({100, 700, 1500, 2300, 2400}, 5, "1e-160"), "", "(and 2 more like it)"},
           Wrong{changed({300, 1900}, 5, "0.2"), "", "overlap by"},
           Wrong{changed({1900}, 3, "900.5"), "", "could jump over a disk"},
           Wrong{good, "count = 2499\n", "the start file holds 2500 disks, not 2499"},
           Wrong{good, "radius = 0.001\n", "the start file has radii from"},
           Wrong{good, "packing_fraction = 0.2\n", "the start file has packing fraction"},
           Wrong{good, "sizes = \"uniform\"\n", "disks.sizes are dealt out"},
           Wrong{good, "[box]\nside = 2.0\n", "the box of the start file is"},
           Wrong{good, "[box]\nedge = \"wall\"\n", "the start file has periodic edges"},
           Wrong{text_of_disks(many, "id:I:1:pos:R:2"), "", "the start file has no radii, and none are given"},
           Wrong{text_of_disks(many, "id:I:1:pos:R:2"), "radius = 0.004\n[velocities]\nkind = \"file\"\n",
                 "there is no file with velocities"},
       }) {
    write_file(file, wrong.text);
    std::string const text = run_of_file(file, wrong.disks);
    std::string const one = refusal_of(text, 0);
    EXPECT_NE(one.find(wrong.says), std::string::npos) << one;
    for (std::size_t const ranks : {1U, 2U, 5U}) EXPECT_EQ(refusal_of(text, ranks), one) << ranks;
  }
}

TEST_F(DividedDisksTest, StartFromAPackedFileAndAfterOneThatWasRefused) {
  fs::path const file = temporary_ / "packed.xyz";
  write_file(file, text_of_disks(many));
  ASSERT_EQ(std::system(("gzip -k " + file.string()).c_str()), 0);
  std::string const text = run_of_file(file.string() + ".gz");
  carry_out(text, temporary_ / "one", 0);
  test::ThreadRanks(3).run([&](Communicator& ranks) {
    SetupOptions const options{.threads = 1, .processes = ranks};
    EXPECT_THROW(set_up(SettingsFile::from_text(run_of_file(file, "count = 7\n"), "wrong.toml"), options), Error);
    RunHooks hooks;
    hooks.threads = 1;
    run_in(temporary_ / "many", set_up(SettingsFile::from_text(text, "run.toml"), options), hooks);
  });
  ASSERT_NO_FATAL_FAILURE(expect_same_results(temporary_ / "one", temporary_ / "many", "packed"));
}

/// A run of some thousand steps that ranks divide.
std::string long_run(std::string const& more = "") {
  return "[disks]\ncount = 300\npacking_fraction = 0.3\n[box]\nedge = \"periodic\"\nheight = 1.3\n"
         "[engine]\nkind = \"tiled\"\n[observe]\nevery = 50\n[trajectory]\nevery = 500\n[run]\nsteps = 2000\nseed = "
         "5\n" +
         more;
}

TEST_F(DividedDisksTest, StopWhereAnyRankIsAskedTo) {
  for (std::size_t const asked : {0U, 2U}) {
    fs::path const directory = temporary_ / ("asked" + std::to_string(asked));
    test::ThreadRanks ranks(3);
    ranks.run([&](Communicator& here) {
      RunHooks hooks;
      // Each rank would answer something else: the root decides.
      hooks.on_progress = [&](Progress const& progress) {
        if (progress.steps >= 100) ranks.ask_to_stop(asked);
        return here.rank() == 0 ? !ranks.does_root_stop() : here.rank() == 1;
      };
      hooks.threads = 1;
      auto const file = SettingsFile::from_text(long_run(), "run.toml");
      EXPECT_EQ(run_in(directory, set_up(file, {.threads = 1, .processes = here}), hooks).status,
                RunStatus::interrupted)
          << "rank " << here.rank();
    });
    EXPECT_EQ(carry_out(long_run(), directory, 2), RunStatus::finished);
    carry_out(long_run(), temporary_ / "whole", 0);
    ASSERT_NO_FATAL_FAILURE(expect_same_results(temporary_ / "whole", directory, "asked " + std::to_string(asked)));
    fs::remove_all(temporary_ / "whole");
  }
}

TEST_F(DividedDisksTest, SaveThemselvesByTheClockOfTheRoot) {
  // Every rank has a clock of its own, and a checkpoint is always due.
  std::string const text = long_run("[checkpoint]\nevery_seconds = 1e-9\n");
  carry_out(text, temporary_ / "one", 0);
  EXPECT_EQ(carry_out(text, temporary_ / "many", 3), RunStatus::finished);
  ASSERT_NO_FATAL_FAILURE(expect_same_results(temporary_ / "one", temporary_ / "many", "by the clock"));
  EXPECT_NE(read_file(temporary_ / "many" / "run.log", 1U << 24).find("checkpoint"), std::string::npos);
}

TEST_F(DividedDisksTest, FailTogetherWhereTheRootCannotWrite) {
  fs::path const directory = temporary_ / "in_the_way";
  std::string const text = long_run();
  std::string why;
  try {
    test::ThreadRanks(3).run([&](Communicator& here) {
      RunHooks hooks;
      hooks.on_progress = [&](Progress const& progress) {
        // A directory comes into the way of a result while the run goes on.
        if (here.rank() == 0 && progress.steps >= 100 && !fs::exists(directory / "series.csv")) {
          fs::create_directories(directory / "series.csv" / "of_the_user");
        }
        return true;
      };
      run_in(directory, set_up(SettingsFile::from_text(text, "run.toml"), {.threads = 1, .processes = here}), hooks);
    });
  } catch (RunFailure const& failure) {
    why = failure.what();
  }
  EXPECT_NE(why.find("series.csv"), std::string::npos) << why;
}

}  // namespace
}  // namespace gridlock
