// Pages say of Gridlock what its records say.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "gridlock/engine/engine.hpp"
#include "gridlock/simulation/configuration.hpp"
#include "gridlock/simulation/detail/model_kind.hpp"

namespace {

using namespace gridlock;

std::string page(std::string const& name) {
  std::ifstream file(std::filesystem::path(GRIDLOCK_SOURCE_DIR) / name);
  EXPECT_TRUE(file.is_open()) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The cells of the row of a table of a page that begins so, without the first.
std::vector<std::string> cells_of(std::string const& text, std::string const& first_cell) {
  std::size_t const begin = text.find("\n| " + first_cell);
  EXPECT_NE(begin, std::string::npos) << "no row: " << first_cell;
  if (begin == std::string::npos) return {};
  std::vector<std::string> cells;
  std::size_t at = text.find(" | ", begin) + 3;
  std::size_t const end = text.find('\n', begin + 1);
  while (at < end) {
    std::size_t const next = text.find(" |", at);
    cells.push_back(text.substr(at, next - at));
    at = next + 3;
  }
  return cells;
}

std::string number(bool is_any) { return is_any ? "any number" : "1"; }

/// A row of the table of engines, in the order of the page.
template <class Cell>
void expect_row(std::string const& text, std::string const& first_cell, Cell cell) {
  std::vector<std::string> expected;
  for (char const* engine : {"stepped", "tiled", "exact", "event_chain", "soft"})
    expected.push_back(cell(engine_record(engine)));
  EXPECT_EQ(cells_of(text, first_cell), expected) << first_cell;
}

TEST(WhichEngine, SaysOfThreadsRanksAndMemoryWhatTheRecordsSay) {
  std::string const text = page("docs/getting_started/which_engine.md");
  ASSERT_EQ(engine_records().size(), 5U) << "the table has a column for each engine";
  expect_row(text, "threads in one run", [](EngineRecord const& record) { return number(record.uses_threads); });
  expect_row(text, "ranks of MPI in one run", [](EngineRecord const& record) { return number(record.uses_processes); });
  expect_row(text, "memory it counts with",
             [](EngineRecord const& record) { return fmt::format("{}", record.bytes_per_disk); });
  expect_row(text, "more with checkpoints",
             [](EngineRecord const& record) { return fmt::format("{}", record.bytes_per_disk_of_checkpoint); });
  expect_row(text, "more on several threads",
             [](EngineRecord const& record) { return fmt::format("{}", record.bytes_per_disk_of_threads); });
  std::vector<std::string> const steps = cells_of(text, "time step");
  ASSERT_EQ(steps.size(), 5U);
  EXPECT_EQ(steps[0].starts_with("none"), !engine_record("stepped").has_time_step);
  EXPECT_EQ(steps[1].starts_with("none"), !engine_record("tiled").has_time_step);
  EXPECT_EQ(steps[2].starts_with("none"), !engine_record("exact").has_time_step);
  EXPECT_EQ(steps[3].starts_with("none"), !engine_record("event_chain").has_time_step);
  EXPECT_EQ(steps[4].starts_with("none"), !engine_record("soft").has_time_step);
}

TEST(WhichEngine, ListsTheModelsWithTheirThreadsAndRanks) {
  std::string const text = page("docs/getting_started/which_engine.md");
  std::string const explanation = page("docs/explanation/models.md");
  std::string const numbers[] = {"no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine"};
  std::size_t models = 0;
  ModelKinds const kinds = shipped_models();
  for (auto const& kind : kinds.all()) {
    std::string const name(kind->name());
    if (name == "disks") continue;
    ++models;
    Configuration configuration;
    configuration.model.kind = name;
    std::vector<std::string> const cells = cells_of(text, "`" + name + "`");
    ASSERT_EQ(cells.size(), 3U) << name;
    EXPECT_EQ(cells[1], number(kind->uses_threads(configuration))) << name;
    EXPECT_EQ(cells[2], number(!kind->not_shared(configuration))) << name;
    EXPECT_NE(explanation.find(name), std::string::npos) << name << " is not in docs/explanation/models.md";
  }
  EXPECT_NE(explanation.find("Gridlock comes with " + numbers[models] + " models"), std::string::npos) << models;
}

/// The rows of a table of benchmarks/results, each with its cells.
std::vector<std::vector<std::string>> results(std::string const& name) {
  std::istringstream lines(page("benchmarks/results/" + name));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("#")) continue;
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

TEST(Performance, SaysOfExactWhatItsResultsSay) {
  std::string const text = page("docs/reference/performance.md");
  std::size_t rows = 0;
  std::string row;
  std::map<std::string, std::string> of_equal_disks;  // ns at packing fraction 0.70 with AVX-512, by number
  for (auto const& cells : results("exact_against_edmd.csv")) {
    if (!cells.at(1).starts_with("Gridlock ")) continue;
    std::string const nanoseconds = fmt::format("{:.0f}", std::stod(cells.at(5)));
    if (cells[1].ends_with("avx512") && cells[2] == "equal" && cells[4] == "0.70")
      of_equal_disks[cells[3]] = nanoseconds;
    row += " " + nanoseconds + " · " + cells.at(7) + " |";
    if (!cells[1].ends_with("scalar")) continue;
    EXPECT_NE(text.find(row), std::string::npos) << "no row with" << row;
    row.clear();
    ++rows;
  }
  EXPECT_EQ(rows, 20U);
  std::string const summary =
      fmt::format("{} ns a collision at 10³ disks, {} ns at 10⁵, {} ns at 10⁶ (φ = 0.7)", of_equal_disks.at("1000"),
                  of_equal_disks.at("100000"), of_equal_disks.at("1000000"));
  EXPECT_NE(text.find(summary), std::string::npos) << summary;
}

TEST(Performance, SaysOfTheRuleWhatItsResultsSay) {
  std::string const text = page("docs/reference/performance.md");
  std::map<std::string, std::vector<std::string>> rows;  // by packing fraction and number: tiled with each target
  for (auto const& cells : results("paper_rule_targets.csv")) {
    if (cells.at(2) == "tiled 1 thread") {
      rows[cells.at(4) + " " + cells.at(3)].push_back(fmt::format("{:.0f}", std::stod(cells.at(5))));
    }
  }
  EXPECT_GE(rows.size(), 8U);
  for (auto const& [name, numbers] : rows) {
    ASSERT_EQ(numbers.size(), 4U) << name;
    std::string const row = fmt::format("| {} |", fmt::join(numbers, " | "));
    EXPECT_NE(text.find(row), std::string::npos) << name << ": no row " << row;
  }
}

/// A sentence of a page that holds as long as a record says so.
struct Statement {
  char const* page;
  char const* words;
  bool is_so;
};

bool uses_threads(char const* engine) { return engine_record(engine).uses_threads; }
bool uses_processes(char const* engine) { return engine_record(engine).uses_processes; }

TEST(Limits, AreThoseOfTheRecords) {
  Statement const statements[] = {
      {"docs/explanation/limits.md", "`stepped` uses one core for a run.", !uses_threads("stepped")},
      {"docs/explanation/limits.md", "`tiled` uses several, and so does `exact`",
       uses_threads("tiled") && uses_threads("exact")},
      {"docs/explanation/limits.md", "A single run can be shared if it uses `tiled`", uses_processes("tiled")},
      {"docs/explanation/limits.md", "No other engine can be shared",
       !uses_processes("stepped") && !uses_processes("exact")},
      {"docs/how_to/cluster.md", "`tiled` uses several cores (`-j N` or `engine.threads`), and so does `exact`",
       uses_threads("tiled") && uses_threads("exact")},
      {"docs/how_to/sweeps.md", "runs of `exact`, `tiled` and of models share the cores", uses_threads("exact")},
  };
  for (Statement const& statement : statements) {
    EXPECT_NE(page(statement.page).find(statement.words), std::string::npos)
        << statement.page << " says no longer: " << statement.words << "\nChange the table of this test with it.";
    EXPECT_TRUE(statement.is_so) << statement.page << " says what is not so: " << statement.words;
  }
}

}  // namespace
