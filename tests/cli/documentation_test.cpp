// The pages of docs/ beside the program: what they quote is what it prints, and every command on them works.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

fs::path const root = GRIDLOCK_SOURCE_DIR;

TEST(Explain, TheReferencePageIsWhatTheProgramSays) {
  Workplace const workplace;
  Outcome const outcome = gridlock::test::gridlock({"explain", "--markdown"}, workplace.path());
  expect_good(outcome);
  EXPECT_EQ(outcome.out, text_of(root / "docs/reference/settings.md"))
      << "run: gridlock explain --markdown > docs/reference/settings.md";
}

TEST(Explain, KnowsAbbreviationsEnginesAndTheColumnsOfModelsAndCurves) {
  Workplace const workplace;
  auto const explained = [&](char const* key) {
    Outcome const outcome = gridlock::test::gridlock({"explain", key}, workplace.path());
    expect_good(outcome);
    return outcome.out;
  };
  auto const expect_words = [&](char const* key, char const* words) {
    std::string const text = explained(key);
    EXPECT_NE(text.find(words), std::string::npos) << key << ": " << text;
  };
  expect_words("psi6", "psi6 is local_bond_orientation_order");
  expect_words("exact", "a value of engine.kind");
  expect_words("order", "column of series.csv of the model flocking");
  expect_words("lag", "column of velocity_autocorrelation.csv, in time");
}

TEST(Explain, ThePageOfObservablesSaysWhatTheProgramSays) {
  Workplace const workplace;
  write(workplace / "a.toml", small_run);
  expect_good(gridlock::test::gridlock({"run", "a.toml", "-o", "out", "--no-pictures"}, workplace.path()));
  std::string const series = text_of(workplace / "out/series.csv");
  std::string const page = text_of(root / "docs/reference/observables.md");
  Outcome const all = gridlock::test::gridlock({"explain", "observables"}, workplace.path());
  expect_good(all);

  std::string names;
  std::istringstream lines(all.out);
  for (std::string name, documentation, unit, blank; std::getline(lines, name); std::getline(lines, blank)) {
    std::getline(lines, documentation);
    std::getline(lines, unit);
    if (!unit.starts_with("    column of series.csv,")) {  // of a model, or of a curve
      EXPECT_NE(gridlock::test::gridlock({"explain", name}, workplace.path()).out.find(name + "\n" + documentation),
                std::string::npos);
      continue;
    }
    names += (names.empty() ? "" : ",") + name;
    EXPECT_EQ(gridlock::test::gridlock({"explain", name}, workplace.path()).out,
              name + "\n" + documentation + "\n" + unit + "\n");
    std::string const in = "    column of series.csv, in ";
    std::string const shown_unit = unit.starts_with(in) ? unit.substr(in.size()) : "";
    static std::regex const bar(R"(\|)");
    std::string const cell = std::regex_replace(documentation.substr(4), bar, R"(\|)");
    std::string const row = "| `" + name + "` | " + shown_unit + " | " + cell + " |\n";
    EXPECT_NE(page.find(row), std::string::npos) << "missing in docs/reference/observables.md: " << row;
  }
  EXPECT_EQ(names, series.substr(0, series.find('\n')));
  std::string const table = gridlock::test::gridlock({"explain", "observables", "--markdown"}, workplace.path()).out;
  EXPECT_GT(table.size(), 1000U);
  EXPECT_NE(page.find(table), std::string::npos) << "docs/reference/observables.md does not have the table\n" << table;
  auto const summary = nlohmann::json::parse(text_of(workplace / "out/summary.json"));
  for (auto const& [key, entry] : summary.items()) {
    EXPECT_NE(page.find("`" + key + "`"), std::string::npos) << "missing in docs/reference/observables.md: " << key;
  }
}

/// Takes a section out of the page of the command line.
void remove_section(std::string& page, std::string const& command) {
  std::size_t const begin = page.find("\n## `" + command + "`\n");
  ASSERT_NE(begin, std::string::npos) << command;
  page.erase(begin, std::min(page.find("\n## ", begin + 1), page.size()) - begin);
}

TEST(Help, ThePageOfTheCommandLineSaysWhatTheProgramSays) {
  Workplace const workplace;
  Outcome const outcome =
      Process("/bin/bash", {(root / "docs/command_line.sh").string(), GRIDLOCK_PROGRAM}, workplace.path()).wait();
  expect_good(outcome);
  std::string page = text_of(root / "docs/reference/command_line.md");
  // The last sections are what programs of their own say, of which this build may have some.
  for (std::string const name : {"jam", "paper", "plot", "view"}) {
    bool const is_built = fs::exists(fs::path(GRIDLOCK_PROGRAM).parent_path() / ("gridlock-" + name));
    if (!is_built) remove_section(page, "gridlock " + name);
  }
  EXPECT_EQ(outcome.out, page)
      << "run: docs/command_line.sh build/apps/gridlock/gridlock > docs/reference/command_line.md";
}

struct Page {
  std::string script;                                      ///< all ```sh and ```console blocks
  std::vector<std::pair<std::string, std::string>> files;  ///< blocks whose first line is a comment with a file's name
};

/// Whether a line runs a command of the Python package, which this build does not have.
bool is_for_python(std::string const& line) {
  return !has_python_commands() && (line.starts_with("gridlock plot ") || line.starts_with("gridlock paper "));
}

/// Text from the next line up to the end of the block.
std::string rest_of_block(std::istream& lines) {
  std::string text;
  for (std::string line; std::getline(lines, line) && !line.starts_with("```");) {
    if (!is_for_python(line)) text += line + "\n";
  }
  return text;
}

/// A block of "$ command" and beneath it all that the command prints: a script that compares the two.
std::string comparison(std::string const& block) {
  std::size_t const end = block.find('\n');
  std::string const command = block.substr(2, end - 2);
  return "diff -u - <((" + command + ") 2>&1) <<'PRINTED'\n" + block.substr(end + 1) + "PRINTED\n";
}

/// Examples that need an interruption, other machines, minutes or further packages are ```text.
Page page_of(fs::path const& file) {
  static std::regex const file_name(R"((?:#|//) (\w+\.(?:toml|py))\n[^]*)");
  Page page;
  std::istringstream lines(text_of(file));
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("```")) continue;
    std::string const block = rest_of_block(lines);
    std::smatch match;
    if (line == "```sh") {
      page.script += block;
    } else if (line == "```console") {
      page.script += comparison(block);
    } else if (std::regex_match(block, match, file_name)) {
      page.files.emplace_back(match[1].str(), block);
    }
  }
  return page;
}

/// Runs what a page shows, from top to bottom, in a directory of its own beside the scenes and examples.
void run_commands_of(fs::path const& file) {
  Page const page = page_of(file);
  if (page.script.empty()) return;
  Workplace const workplace;
  for (char const* name : {"scenes", "examples"}) fs::create_directory_symlink(root / name, workplace / name);
  for (auto const& [name, text] : page.files) write(workplace / name, text);
  std::string const preamble = "PATH=" + fs::path(GRIDLOCK_PROGRAM).parent_path().string() + ":/usr/bin:$PATH\n" +
                               "trap 'echo \"failed: $BASH_COMMAND\" >&2' ERR\n";
  Outcome const outcome = Process("/bin/bash", {"-ec", preamble + page.script}, workplace.path()).wait();
  EXPECT_EQ(outcome.exit_code, 0) << file << "\n" << outcome.out << outcome.err;
}

std::vector<fs::path> pages_in(std::string const& folder) {
  std::vector<fs::path> pages;
  for (auto const& entry : fs::directory_iterator(root / folder)) {
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  }
  EXPECT_FALSE(pages.empty()) << folder;
  return pages;
}

class Documentation : public testing::TestWithParam<char const*> {};

TEST_P(Documentation, EveryCommandRuns) {
  for (fs::path const& page : pages_in(GetParam())) run_commands_of(page);
}

INSTANTIATE_TEST_SUITE_P(Pages, Documentation,
                         testing::Values("", "docs", "docs/getting_started", "docs/how_to", "docs/explanation",
                                         "docs/reference"),
                         [](auto const& page) {
                           std::string const folder = page.param;
                           return folder.empty() ? "README" : fs::path(folder).filename().string();
                         });

TEST(Links, BetweenPagesLeadSomewhere) {
  Workplace const workplace;
  expect_good(Process("/usr/bin/python3", {(root / "docs/check_links.py").string()}, workplace.path()).wait());
}

}  // namespace
