// Who may include whom, as ARCHITECTURE.md says:
//
//     core ← grid ← parallel ← { lattice, engine, observe, model, packing } ← simulation ← workspace ← drawing ← apps
//     parallel ← io ← simulation
//     observe ← analysis
//
// The siblings in braces do not include one another, save for engine/engine.hpp.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::map<std::string, std::set<std::string>> const allowed{
    {"core", {"core"}},
    {"grid", {"core", "grid"}},
    {"parallel", {"core", "grid", "parallel"}},
    {"io", {"core", "parallel", "io"}},
    {"lattice", {"core", "parallel", "grid", "lattice"}},
    {"engine", {"core", "parallel", "grid", "engine"}},
    {"device", {"core", "grid", "engine", "model", "models", "device"}},
    {"observe", {"core", "parallel", "grid", "observe"}},
    {"analysis", {"core", "parallel", "grid", "observe", "analysis"}},
    {"model", {"core", "parallel", "grid", "model"}},
    {"packing", {"core", "parallel", "grid", "packing"}},
    {"protocol", {"core", "grid", "engine", "packing", "protocol"}},
    {"models", {"core", "parallel", "grid", "lattice", "model", "models"}},
    {"simulation",
     {"core", "parallel", "grid", "io", "lattice", "engine", "observe", "model", "models", "packing", "protocol",
      "simulation"}},
    {"workspace",
     {"core", "parallel", "grid", "io", "lattice", "engine", "observe", "model", "simulation", "workspace"}},
    {"drawing", {"core", "io", "observe", "simulation", "workspace", "drawing"}},
    {"apps",
     {"core", "parallel", "grid", "io", "lattice", "engine", "observe", "model", "packing", "analysis", "simulation",
      "workspace", "drawing", "apps"}},
};

struct Include {
  int line;
  std::string text;  ///< what is between the quotes or brackets
  bool is_quoted;
};

std::vector<Include> includes_of(fs::path const& path) {
  static std::regex const pattern(R"re(^\s*#\s*include\s*(["<])([^">]+)[">])re");
  std::vector<Include> includes;
  std::ifstream file(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::smatch match;
    if (std::regex_search(line, match, pattern)) includes.push_back({number, match[2], match[1] == "\""});
  }
  return includes;
}

struct Source {
  fs::path path;      ///< as it can be opened
  std::string name;   ///< from the root of the repository, for messages
  std::string layer;  ///< its folder in include/gridlock or src, "drawing" or "apps"
};

bool is_source(fs::path const& path) { return path.extension() == ".hpp" || path.extension() == ".cpp"; }

std::vector<Source> sources_under(std::string const& folder, bool is_layered) {
  fs::path const root(GRIDLOCK_SOURCE_DIR);
  std::vector<Source> sources;
  for (auto const& entry : fs::recursive_directory_iterator(root / folder)) {
    if (!entry.is_regular_file() || !is_source(entry.path())) continue;
    fs::path const inside = entry.path().lexically_relative(root / folder);
    // A header beside the folders of the layers is the interface of apps/.
    bool const is_of_layer = is_layered && inside.has_parent_path();
    sources.push_back({entry.path(), entry.path().lexically_relative(root).string(),
                       is_of_layer ? inside.begin()->string() : std::string("apps")});
  }
  return sources;
}

std::vector<Source> all_sources() {
  std::vector<Source> all = sources_under("include/gridlock", true);
  for (Source const& source : sources_under("src", true)) all.push_back(source);
  for (Source source : sources_under("apps/drawing", false)) {
    source.layer = "drawing";
    all.push_back(source);
  }
  for (Source const& source : sources_under("apps/gridlock", false)) all.push_back(source);
  return all;
}

/// The layer a quoted include belongs to: "gridlock/<layer>/…", "<layer>/…", a file beside the including one, or the
/// interface of apps/, "gridlock/command_line.hpp".
std::string layer_of(std::string const& include, Source const& from) {
  fs::path path(include);
  auto part = path.begin();
  bool const is_public = *part == "gridlock";
  if (is_public) ++part;
  bool const is_in_no_folder = std::next(part) == path.end();
  if (is_in_no_folder) return is_public ? "apps" : from.layer;
  return part->string();
}

/// What is wrong with an include, or nothing.
std::string complaint(Source const& from, Include const& include) {
  if (!include.is_quoted) return "";
  if (include.text.find("..") != std::string::npos) return "climbs out of its folder";
  std::string const to = layer_of(include.text, from);
  if (!allowed.contains(to)) return "names no layer: " + to;
  if (include.text == "gridlock/engine/engine.hpp" && allowed.at(from.layer).contains("grid")) return "";
  return allowed.at(from.layer).contains(to) ? "" : from.layer + " may not include " + to;
}

TEST(Layers, NoFileIncludesAHigherLayerOrASibling) {
  std::vector<Source> const sources = all_sources();
  ASSERT_GT(sources.size(), 30U) << "the sources were not found";
  for (Source const& source : sources) {
    ASSERT_TRUE(allowed.contains(source.layer)) << source.name << ": a layer the test does not know";
    for (Include const& include : includes_of(source.path)) {
      EXPECT_EQ(complaint(source, include), "") << source.name << ":" << include.line << "  " << include.text;
    }
  }
}

/// The lines of a file that speak of ranks, but for calls of Communicator::rank().
std::vector<int> lines_with_ranks(fs::path const& path) {
  static std::regex const word(R"((^|[^A-Za-z.])ranks?([^A-Za-z]|$)|Ranks?([^a-z]|$)|_ranks?([^a-z]|$))");
  std::vector<int> lines;
  std::ifstream file(path);
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    if (std::regex_search(line, word)) lines.push_back(number);
  }
  return lines;
}

/// Ranks are the matter of `parallel`; elsewhere they are processes, save where users meet the word: options, errors,
/// events and summaries of MPI. Fewer lines are welcome.
std::map<std::string, std::size_t> const max_lines_with_ranks{{"simulation", 13}, {"workspace", 5}, {"apps", 17}};

TEST(Layers, OnlyTheRoomForItSpeaksOfRanks) {
  std::map<std::string, std::size_t> lines_of_room;
  for (Source const& source : all_sources()) {
    if (source.layer == "parallel") continue;
    std::vector<int> const lines = lines_with_ranks(source.path);
    lines_of_room[source.layer] += lines.size();
    if (!max_lines_with_ranks.contains(source.layer)) {
      EXPECT_TRUE(lines.empty()) << source.name << ":" << lines.front() << " speaks of ranks";
    }
  }
  for (auto const& [room, max_lines] : max_lines_with_ranks) {
    EXPECT_LE(lines_of_room[room], max_lines) << room << " speaks of ranks in more lines than before";
  }
}

/// The file in the repository that an include names, or nothing.
std::string included_file(std::set<std::string> const& names, Source const& from, std::string const& include) {
  std::string const beside = (fs::path(from.name).parent_path() / include).string();
  for (std::string const& name : {"include/" + include, "src/" + include, beside}) {
    if (names.contains(name)) return name;
  }
  return "";
}

/// The files that include a header, directly or not.
std::set<std::string> files_that_include(std::string const& header) {
  std::vector<Source> const sources = all_sources();
  std::set<std::string> names;
  for (Source const& source : sources) names.insert(source.name);
  std::map<std::string, std::set<std::string>> including;
  for (Source const& source : sources) {
    for (Include const& include : includes_of(source.path)) {
      including[included_file(names, source, include.text)].insert(source.name);
    }
  }
  std::set<std::string> found;
  std::vector<std::string> next{header};
  while (!next.empty()) {
    std::string const last = next.back();
    next.pop_back();
    for (std::string const& name : including[last]) {
      if (found.insert(name).second) next.push_back(name);
    }
  }
  return found;
}

TEST(Layers, FewFilesIncludeTheCommunicator) {
  std::set<std::string> const files = files_that_include("include/gridlock/parallel/communicator.hpp");
  std::size_t public_headers = 0;
  for (std::string const& file : files) {
    if (file.starts_with("include/") && file.find("/detail/") == std::string::npos) ++public_headers;
  }
  EXPECT_GT(files.size(), 20U) << "the includes were not found";
  EXPECT_LE(files.size(), 60U);
  EXPECT_LE(public_headers, 4U);
}

TEST(Layers, TheRuleItselfTellsGoodFromBad) {
  auto const is_allowed = [](std::string const& layer, std::string const& include) {
    return complaint({"", "", layer}, {1, include, true}).empty();
  };
  EXPECT_TRUE(is_allowed("grid", "gridlock/core/box.hpp"));
  EXPECT_FALSE(is_allowed("core", "grid/pairs.hpp"));
  EXPECT_FALSE(is_allowed("core", "gridlock/engine/engine.hpp"));
  EXPECT_FALSE(is_allowed("io", "gridlock/engine/engine.hpp"));
  EXPECT_FALSE(is_allowed("io", "grid/pairs.hpp"));
  EXPECT_TRUE(is_allowed("observe", "gridlock/engine/engine.hpp"));
  EXPECT_FALSE(is_allowed("observe", "engine/turn.hpp"));
  EXPECT_TRUE(is_allowed("analysis", "gridlock/observe/estimate.hpp"));
  EXPECT_FALSE(is_allowed("observe", "gridlock/analysis/dynamics.hpp"));
  EXPECT_FALSE(is_allowed("engine", "gridlock/lattice/start.hpp"));
  EXPECT_FALSE(is_allowed("lattice", "gridlock/observe/speed.hpp"));
  EXPECT_TRUE(is_allowed("engine", "turn.hpp"));
  EXPECT_TRUE(is_allowed("engine", "engine/exact/calendar.hpp"));
  EXPECT_TRUE(is_allowed("simulation", "gridlock/io/table.hpp"));
  EXPECT_FALSE(is_allowed("io", "gridlock/simulation/run.hpp"));
  EXPECT_FALSE(is_allowed("simulation", "gridlock/workspace/sweep.hpp"));
  EXPECT_FALSE(is_allowed("workspace", "drawing/movie.hpp"));
  EXPECT_TRUE(is_allowed("apps", "drawing/movie.hpp"));
  EXPECT_FALSE(is_allowed("engine", "../grid/pairs.hpp"));
  EXPECT_TRUE(is_allowed("apps", "gridlock/command_line.hpp"));
  EXPECT_FALSE(is_allowed("simulation", "gridlock/command_line.hpp"));
}

TEST(PublicHeaders, IncludeNothingButThePublicHeadersAndTheStandardLibrary) {
  // The standard library's own headers have neither a folder nor an ending; vector instructions come with the compiler.
  std::regex const standard("[a-z_0-9]+|[a-z]mmintrin\\.h|arm_neon\\.h");
  for (Source const& source : sources_under("include/gridlock", true)) {
    for (Include const& include : includes_of(source.path)) {
      if (include.is_quoted) {
        EXPECT_EQ(include.text.rfind("gridlock/", 0), 0U) << source.name << ":" << include.line << "  " << include.text;
      } else {
        EXPECT_TRUE(std::regex_match(include.text, standard))
            << source.name << ":" << include.line << "  " << include.text;
      }
    }
  }
}

/// Every header that some header outside of detail/ includes, directly or through others, as
/// "gridlock/grid/detail/tiling.hpp".
std::set<std::string> headers_of_users() {
  std::vector<fs::path> open;
  for (Source const& source : sources_under("include/gridlock", true)) {
    if (source.name.find("/detail/") == std::string::npos) open.push_back(source.path);
  }
  for (Source const& source : sources_under("models", false)) open.push_back(source.path);
  // A model of users that asks for the cells of an engine.
  open.push_back(fs::path(GRIDLOCK_SOURCE_DIR) / "tests/tiled_colloid.hpp");
  std::set<std::string> found;
  while (!open.empty()) {
    fs::path const path = open.back();
    open.pop_back();
    for (Include const& include : includes_of(path)) {
      bool const is_ours = include.is_quoted && include.text.rfind("gridlock/", 0) == 0;
      if (is_ours && found.insert(include.text).second)
        open.push_back(fs::path(GRIDLOCK_SOURCE_DIR) / "include" / include.text);
    }
  }
  return found;
}

TEST(PublicHeaders, HaveNoDetailsThatOnlyTheLibraryNeeds) {
  std::set<std::string> const needed = headers_of_users();
  std::size_t details = 0;
  for (Source const& source : sources_under("include/gridlock", true)) {
    if (source.name.find("/detail/") == std::string::npos) continue;
    ++details;
    EXPECT_TRUE(needed.contains(source.name.substr(std::string("include/").size())))
        << source.name << ": no header of users includes it, so it belongs into src/";
  }
  EXPECT_GT(details, 0U);
}

TEST(PublicHeaders, AreEnoughForTheProgramsOfUsers) {
  std::size_t includes = 0;
  for (std::string const folder : {"examples", "tests/own_program", "tests/package"}) {
    for (Source const& source : sources_under(folder, false)) {
      for (Include const& include : includes_of(source.path)) {
        bool const is_beside = fs::exists(source.path.parent_path() / include.text);
        if (!include.is_quoted || is_beside) continue;
        ++includes;
        EXPECT_EQ(include.text.rfind("gridlock/", 0), 0U) << source.name << ":" << include.line << "  " << include.text;
        EXPECT_EQ(include.text.find("/detail/"), std::string::npos) << source.name << ":" << include.line;
      }
    }
  }
  EXPECT_GT(includes, 0U);
}

TEST(PublicHeaders, AreGuardedAndNameTheirNamespace) {
  for (Source const& source : sources_under("include/gridlock", true)) {
    std::ifstream file(source.path);
    std::string const text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    EXPECT_EQ(text.rfind("#pragma once", 0), 0U) << source.name;
    EXPECT_NE(text.find("namespace gridlock {"), std::string::npos) << source.name;
    EXPECT_EQ(text.find("using namespace"), std::string::npos) << source.name;
  }
}

TEST(Library, AsksForTheCoresOfTheMachineInOnePlace) {
  // Affinity mask and limits of containers are what usable_cores() looks at, and these do not.
  std::regex const counts(R"re(hardware_concurrency|default_concurrency|_SC_NPROCESSORS|get_nprocs)re");
  std::size_t places = 0;
  for (Source const& source : all_sources()) {
    std::ifstream file(source.path);
    std::string const text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    bool const asks = std::regex_search(text, counts);
    EXPECT_TRUE(!asks || source.name == "src/core/resources.cpp") << source.name;
    places += asks ? 1 : 0;
  }
  EXPECT_EQ(places, 1U);
}

TEST(Library, RunsParallelLoopsOnTheCoresThatTheProcessMayUse) {
  // By itself oneTBB takes all cores of the affinity mask, whatever a container's limit is.
  for (Source const& source : all_sources()) {
    std::ifstream file(source.path);
    std::string const text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    if (text.find("tbb::parallel_") == std::string::npos) continue;
    bool const is_bounded =
        text.find("on_all_cores(") != std::string::npos || text.find("jobs_for(") != std::string::npos;
    EXPECT_TRUE(is_bounded) << source.name;
  }
}

TEST(Library, NeverPrints) {
  // Only apps/ touch the terminal; files and processes are io's.
  std::regex const terminal(R"re(std::(cout|cerr|clog)\b|\bfmt::print\(("|stdout|stderr)|\b(printf|puts)\()re");
  for (std::string const folder : {"include/gridlock", "src"}) {
    for (Source const& source : sources_under(folder, true)) {
      std::ifstream file(source.path);
      std::string line;
      for (int number = 1; std::getline(file, line); ++number) {
        EXPECT_FALSE(std::regex_search(line, terminal)) << source.name << ":" << number << "  " << line;
      }
    }
  }
}

}  // namespace
