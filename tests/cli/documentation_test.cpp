// The pages of docs/ beside the program: what they quote is what it prints, and every command on them works.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>
#include <span>
#include <string_view>

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

/// What small_run lacks to have every column: observables that settings ask for, and two kinds of disks.
constexpr char const* everything_on_request =
    "density_profile = \"both\"\nclusters_every = 1\nlocal_density_every = 1\ndisplacement_lag = 4\n"
    "temperature_by_kind = true\nflux_line = \"vertical\"\n"
    "[[disks.species]]\nfraction = 0.5\nsize_ratio = 1.0\n[[disks.species]]\nfraction = 0.5\nsize_ratio = 1.2\n";

TEST(Explain, ThePageOfObservablesSaysWhatTheProgramSays) {
  Workplace const workplace;
  write(workplace / "a.toml", std::string(small_run) + everything_on_request);
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
  // Self-propelled disks of the engines with a time step have no pressures: no run has every column.
  // Soft disks do not collide, and have columns of their own. Defects are those of periodic boxes, which have no walls;
  // viscosities and free paths those of the engine exact.
  for (std::string const of_others :
       {",effective_swim_speed", ",potential_energy,pressure,stress_xx,stress_xy,stress_yy,total_energy",
        ",defect_fraction,disclination_fraction,dislocation_fraction,dislocation_pair_fraction,other_defect_"
        "fraction",
        ",shear_viscosity,bulk_viscosity,mean_free_path"}) {
    ASSERT_NE(names.find(of_others), std::string::npos);
    names.erase(names.find(of_others), of_others.size());
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
  for (std::string const name : {"jam", "melt", "paper", "plot", "show", "view"}) {
    bool const is_built = fs::exists(fs::path(GRIDLOCK_PROGRAM).parent_path() / ("gridlock-" + name));
    if (!is_built) remove_section(page, "gridlock " + name);
  }
  EXPECT_EQ(outcome.out, page)
      << "run: docs/command_line.sh build/apps/gridlock/gridlock > docs/reference/command_line.md";
}

/// The lines that a command of a page has to print.
struct Printed {
  std::size_t line = 0;  ///< of the page
  std::string command;
  std::vector<std::string> lines;  ///< "…" stands for any text in a line, and alone for any lines
  bool is_of_page = false;         ///< every line that is printed occurs in the text of the page
};

struct Page {
  std::string text;
  std::string script;  ///< all ```sh and ```console blocks
  std::vector<Printed> printed;
  std::vector<std::pair<std::string, std::string>> files;  ///< blocks whose first line is a comment with a file's name
};

/// Whether a line runs a command of the Python package, which this build does not have.
bool is_for_python(std::string const& line) {
  return !has_python_commands() && (line.starts_with("gridlock plot ") || line.starts_with("gridlock paper "));
}

std::vector<std::string> lines_of(std::string const& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string joined(std::vector<std::string> const& lines) {
  std::string text;
  for (std::string const& line : lines) text += line + "\n";
  return text;
}

std::string const any = "…";

/// Whether a line is the pattern with some text in the place of each "…".
bool matches(std::string_view pattern, std::string_view line) {
  std::size_t const mark = pattern.find(any);
  if (mark == std::string_view::npos) return pattern == line;
  if (!line.starts_with(pattern.substr(0, mark))) return false;
  std::string_view const rest = pattern.substr(mark + any.size());
  for (std::size_t at = mark; at <= line.size(); ++at) {
    if (matches(rest, line.substr(at))) return true;
  }
  return false;
}

/// Whether a line of a pattern stands for any number of lines.
bool is_any_lines(std::string const& pattern) {
  std::size_t const begin = pattern.find_first_not_of(' ');
  return begin != std::string::npos && pattern.substr(begin) == any;
}

/// The same for lines.
bool matches(std::span<std::string const> patterns, std::span<std::string const> lines) {
  if (patterns.empty()) return lines.empty();
  std::string const& first = patterns.front();
  if (is_any_lines(first)) {
    for (std::size_t at = 0; at <= lines.size(); ++at) {
      if (matches(patterns.subspan(1), lines.subspan(at))) return true;
    }
    return false;
  }
  return !lines.empty() && matches(first, lines.front()) && matches(patterns.subspan(1), lines.subspan(1));
}

/// Whether the page shows that the command ends with an error.
bool shows_error(Printed const& printed) {
  return std::ranges::any_of(printed.lines, [](std::string const& line) { return line.starts_with("error: "); });
}

/// Adds a command to the script of a page; what it prints goes to a file.
void add_printed(Page& page, Printed printed) {
  std::string const file = ".printed-" + std::to_string(page.printed.size());
  page.script += (shows_error(printed) ? "! " : "") + ("( " + printed.command + "\n) >" + file + " 2>&1\n");
  page.printed.push_back(std::move(printed));
}

/// A block of "$ command", each with all that it prints beneath it.
void add_console(Page& page, std::size_t line, std::vector<std::string> const& block) {
  ASSERT_TRUE(!block.empty() && block.front().starts_with("$ ")) << "line " << line << ": a command begins with $";
  std::vector<Printed> all;
  for (std::string const& text : block) {
    ++line;
    if (text.starts_with("$ ")) {
      all.push_back({.line = line, .command = text.substr(2)});
    } else {
      all.back().lines.push_back(text);
    }
  }
  for (Printed& printed : all) {
    if (!is_for_python(printed.command)) add_printed(page, std::move(printed));
  }
}

/// The lines up to one that is or ends with the mark; `at` is behind it then.
std::vector<std::string> lines_to(std::vector<std::string> const& lines, std::size_t& at, std::string const& mark) {
  std::vector<std::string> block;
  while (at < lines.size() && !lines[at].starts_with(mark)) block.push_back(lines[at++]);
  ++at;
  return block;
}

/// Examples that need an interruption, other machines, minutes or further packages are ```text. A comment that begins
/// with "printed:" has commands; each line that they print has to be in the page.
Page page_of(fs::path const& file) {
  static std::regex const file_name(R"((?:#|//) (\w+\.(?:toml|py))\n[^]*)");
  Page page{.text = text_of(file)};
  std::vector<std::string> const lines = lines_of(page.text);
  for (std::size_t at = 0; at < lines.size();) {
    std::size_t const line = ++at;
    std::string const& head = lines[line - 1];
    if (head == "<!-- printed:") {
      add_printed(page, {.line = line, .command = joined(lines_to(lines, at, "-->")), .is_of_page = true});
    }
    if (!head.starts_with("```")) continue;
    std::vector<std::string> block = lines_to(lines, at, "```");
    std::smatch match;
    if (head == "```console") {
      add_console(page, line, block);
      continue;
    }
    std::erase_if(block, is_for_python);
    std::string const text = joined(block);
    if (head == "```sh") {
      page.script += text;
    } else if (std::regex_match(text, match, file_name)) {
      page.files.emplace_back(match[1].str(), text);
    }
  }
  return page;
}

void expect_printed(Page const& page, Printed const& expected, std::string const& printed) {
  std::vector<std::string> lines = lines_of(printed);
  static std::regex const progress(R"( *[0-9.]+ %  .*)");  // of a program that takes longer than a second
  std::erase_if(lines, [&](std::string const& line) { return std::regex_match(line, progress); });
  if (expected.is_of_page) {
    EXPECT_FALSE(lines.empty()) << "line " << expected.line << " prints nothing";
    for (std::string const& line : lines) {
      EXPECT_NE(page.text.find(line), std::string::npos) << "line " << expected.line << ": not in the page: " << line;
    }
    return;
  }
  EXPECT_FALSE(std::ranges::all_of(expected.lines, is_any_lines) && !expected.lines.empty())
      << "line " << expected.line << " shows nothing of what is printed";
  EXPECT_TRUE(matches(std::span(expected.lines), std::span(lines)))
      << "line " << expected.line << ": $ " << expected.command << "\nprints\n"
      << printed << "and not, as the page says,\n"
      << joined(expected.lines);
}

/// Reads a result of a run or of the rows of a table, for the commands in comments.
constexpr char const* helpers = R"(value() { python3 -c '
import json, sys
directory, name, form = sys.argv[1:]
found = json.load(open(directory + "/summary.json"))[name]
print(format(found["value"] if isinstance(found, dict) else found, form))' "$@"; }
)";

/// Runs what a page shows, from top to bottom, in a directory of its own beside the scenes and examples.
void run_commands_of(fs::path const& file) {
  SCOPED_TRACE(file.string());
  Page const page = page_of(file);
  if (page.script.empty()) return;
  Workplace const workplace;
  for (char const* name : {"scenes", "examples"}) fs::create_directory_symlink(root / name, workplace / name);
  for (auto const& [name, text] : page.files) write(workplace / name, text);
  std::string const preamble = "PATH=" + fs::path(GRIDLOCK_PROGRAM).parent_path().string() + ":/usr/bin:$PATH\n" +
                               "trap 'echo \"failed: $BASH_COMMAND\" >&2' ERR\n" + helpers;
  Outcome const outcome = Process("/bin/bash", {"-ec", preamble + page.script}, workplace.path()).wait();
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
  for (std::size_t k = 0; k < page.printed.size(); ++k) {
    expect_printed(page, page.printed[k], text_of(workplace / (".printed-" + std::to_string(k))));
  }
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

/// A block of a page that no test compares, and why.
struct Uncompared {
  char const* page;
  char const* first_line;
  char const* reason;
};

constexpr Uncompared uncompared[] = {
    {"docs/contributing/first_change.md", "missing in docs/reference/observables.md: | `largest_speed` |",
     "after a change"},
    {"docs/contributing/first_change.md", "- `series.csv` and `summary.json`", "a line of the changelog"},
    {"docs/explanation/exact.md", "            calendar ", "a drawing"},
    {"docs/explanation/paper.md", "from gridlock_studies import paper", "minutes"},
    {"docs/getting_started/install.md", "libfmt-dev ", "names of packages"},
    {"docs/getting_started/own_model.md", "  agents ", "tests/package/run.cmake compares it"},
    {"docs/how_to/movies_and_figures.md", "import gridlock", "needs matplotlib"},
    {"docs/how_to/viewer.md", "$ gridlock view results/crystal",
     "serves until it is stopped; view_test.cpp has its words"},
};

/// Whether a line of a block can be typed: it begins with a program, a comment or an option of the line before.
bool is_command(std::string const& line) {
  static std::regex const programs(
      R"(^( *--.*|#.*|(\./dev|\./build/\S+|build/\S+|build-\S+|benchmarks/\S+|cmake|docker|env/bin/pip|export|find|g\+\+|git|gridlock)"
      R"(|gridlock-mpi|grep|mpirun|python3?|sbatch|sudo)( .*)?)?$)");
  return std::regex_match(line, programs);
}

TEST(Pages, ShowWhatAProgramPrintsWhereItIsCompared) {
  std::vector<Uncompared const*> used;
  for (char const* folder :
       {"", "docs", "docs/contributing", "docs/explanation", "docs/getting_started", "docs/how_to", "docs/reference"}) {
    for (fs::path const& file : pages_in(folder)) {
      std::string const page = fs::relative(file, root).string();
      if (page == "docs/reference/command_line.md") continue;  // the whole page is compared
      std::vector<std::string> const lines = lines_of(text_of(file));
      for (std::size_t at = 0; at < lines.size();) {
        std::string const& head = lines[at++];
        if (!head.starts_with("```")) continue;
        std::size_t const line = at;
        std::vector<std::string> const block = lines_to(lines, at, "```");
        if (head != "```text" || std::ranges::all_of(block, is_command)) continue;
        // Beneath a program in C++ or Python: tests/package/run.cmake and python/tests/test_pages.py compare it.
        if (line > 2 && lines[line - 3] == "prints") continue;
        auto const* known = std::ranges::find_if(uncompared, [&](Uncompared const& one) {
          return page == one.page && block.front().starts_with(one.first_line);
        });
        EXPECT_NE(known, std::end(uncompared)) << page << ":" << line << ": use a ```console block, which is compared";
        used.push_back(known);
      }
    }
  }
  for (Uncompared const& one : uncompared) {
    EXPECT_NE(std::ranges::find(used, &one), used.end()) << one.page << " has no such block: " << one.first_line;
  }
}

/// Every picture of docs/images is shown by a page or by a program of docs/.
TEST(Pages, ShowEveryPicture) {
  std::string all;
  for (fs::path const& file : {root / "README.md", root / "ARCHITECTURE.md", root / "CONTRIBUTING.md"})
    all += text_of(file);
  for (auto const& entry : fs::recursive_directory_iterator(root / "docs")) {
    std::string const kind = entry.path().extension();
    if (kind == ".md" || kind == ".ipynb") all += text_of(entry.path());
  }
  for (auto const& entry : fs::directory_iterator(root / "docs/images")) {
    std::string const name = entry.path().filename();
    EXPECT_NE(all.find("images/" + name), std::string::npos) << name << " is on no page";
  }
}

TEST(Links, BetweenPagesLeadSomewhere) {
  Workplace const workplace;
  expect_good(Process("/usr/bin/python3", {(root / "docs/check_links.py").string()}, workplace.path()).wait());
}

}  // namespace
