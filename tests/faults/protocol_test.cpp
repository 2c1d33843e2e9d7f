// Protocols that are killed in the middle of each kind of stage, with the real program.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;
using Arguments = std::vector<std::string>;

/// A stage, behind those that it needs, and the count of disks with which the search for a long enough run begins.
struct Case {
  char const* name;
  int count;
  char const* disks;
  char const* stages;
};

void PrintTo(Case const& one, std::ostream* stream) { *stream << one.name; }

constexpr char const* fluid =
    "packing_fraction = 0.45\nstart = \"random\"\n"
    "species = [{ fraction = 0.5, size_ratio = 1.0 }, { fraction = 0.5, size_ratio = 1.4 }]\n";
constexpr char const* points =
    "packing_fraction = 0.5\nstart = \"uniform\"\n"
    "species = [{ fraction = 0.5, size_ratio = 1.0 }, { fraction = 0.5, size_ratio = 1.4 }]\n";
constexpr char const* equal_points = "packing_fraction = 0.5\nstart = \"uniform\"\n";
constexpr char const* many_sizes = "packing_fraction = 0.5\nstart = \"random\"\nsizes = \"inverse_cube\"\n";

class ProtocolFaults : public testing::TestWithParam<Case> {
 protected:
  /// Writes the settings with so many disks that the whole run lasts long enough to be killed in the middle, on a
  /// machine of any speed, and makes that run. Says how many milliseconds it took.
  static double make_whole_run(fs::path const& workplace) {
    for (int count = GetParam().count;; count *= 2) {
      write(
          workplace / "run.toml",
          "box.edge = \"periodic\"\nvelocities.kind = \"maxwell\"\ncheckpoint.every_seconds = 0.01\n[disks]\ncount = " +
              std::to_string(count) + "\n" + GetParam().disks + "[[protocol]]\n" + GetParam().stages);
      fs::remove_all(workplace / "whole");
      auto const start = std::chrono::steady_clock::now();
      Outcome const whole = gridlock::test::gridlock(beginning("whole"), workplace);
      double const milliseconds =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      EXPECT_EQ(whole.exit_code, 0) << whole.err;
      if (whole.exit_code != 0 || milliseconds > 700.0) return milliseconds;
    }
  }

  static Arguments beginning(char const* directory) {
    return {"run", "run.toml", "-o", directory, "-q", "--no-pictures"};
  }

  static void expect_same(fs::path const& whole, fs::path const& other) {
    auto const hash_of = [](fs::path const& run) {
      return nlohmann::json::parse(text_of(run / "summary.json"))["state_hash"].get<std::string>();
    };
    EXPECT_EQ(hash_of(whole), hash_of(other));
    std::vector<std::string> names;
    for (char const* name :
         {"stages.csv", "levels.csv", "swap_correlations.csv", "swap_density.csv", "shear.csv", "shear_events.csv"}) {
      if (!fs::exists(whole / name)) continue;
      names.emplace_back(name);
      EXPECT_EQ(text_of(whole / name), text_of(other / name)) << name;
    }
    EXPECT_FALSE(names.empty());
  }
};

bool is_finished(fs::path const& run) {
  return text_of(run / "summary.json").find("\"status\": \"finished\"") != std::string::npos;
}

TEST_P(ProtocolFaults, KilledInAStageAProtocolResumesToTheSameBits) {
  Workplace const workplace;
  double const milliseconds = make_whole_run(workplace.path());
  ASSERT_FALSE(HasFailure());
  std::mt19937 random(1);
  // The program looks whether a checkpoint is due ten times a second.
  std::uniform_real_distribution<double> moment(160.0, 0.5 * milliseconds);
  Arguments const resuming{"resume", "run", "-q", "--no-pictures"};
  int killed = 0;
  int restored = 0;
  for (int attempt = 0; killed < 2 || restored < 2; ++attempt) {
    ASSERT_LT(attempt, 20) << killed << " of two killed, " << restored << " of two restored: the run ends too early";
    fs::remove_all(workplace / "run");
    for (int again = 0; again < 3 && !is_finished(workplace / "run"); ++again) {
      bool const has_begun = fs::exists(workplace / "run" / "config.resolved.toml");
      restored += fs::exists(workplace / "run" / "checkpoint.gridlock") ? 1 : 0;
      Process const process(GRIDLOCK_PROGRAM, has_begun ? resuming : beginning("run"), workplace.path());
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(moment(random)));
      process.signal(SIGKILL);
      killed += process.wait().exit_code == 0 ? 0 : 1;
    }
    if (!is_finished(workplace / "run")) {
      Outcome const last = gridlock::test::gridlock(resuming, workplace.path());
      ASSERT_EQ(last.exit_code, 0) << last.err;
    }
    expect_same(workplace / "whole", workplace / "run");
  }
}

INSTANTIATE_TEST_SUITE_P(
    Stages, ProtocolFaults,
    testing::Values(Case{"grow", 256, fluid, "stage = \"grow\"\nrate = 2e-4\nuntil_packing_fraction = 0.8\n"},
                    Case{"run", 256, fluid, "stage = \"run\"\ncollisions_per_disk = 25000\n"},
                    Case{"swap", 256, many_sizes, "stage = \"swap\"\nsweeps = 25000\n"},
                    Case{"quench", 1500, equal_points, "stage = \"quench\"\npacking_fraction = 0.9\n"},
                    Case{"decompress", 400, points,
                         "stage = \"quench\"\npacking_fraction = 0.86\n"
                         "[[protocol]]\nstage = \"decompress\"\nuntil_pressure = 1e-6\n"},
                    Case{"compress", 400, points,
                         "stage = \"quench\"\npacking_fraction = 0.82\n"
                         "[[protocol]]\nstage = \"compress\"\nuntil_pressure = 1e-3\n"
                         "[[protocol]]\nstage = \"separate\"\n"},
                    Case{"shear", 100, points,
                         "stage = \"quench\"\npacking_fraction = 0.86\n"
                         "[[protocol]]\nstage = \"shear\"\nuntil_strain = 0.1\n"}),
    [](auto const& instance) { return std::string(instance.param.name); });

}  // namespace
