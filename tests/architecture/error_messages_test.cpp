// docs/reference/error_messages.md has the words of the program: what is between the "…" of a row occurs in its
// sources.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

std::string text_of(fs::path const& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The literals of all sources, each joined where it is broken over lines or by a number that is put in between.
std::string literals() {
  static std::regex const broken(R"re("\s*\n?\s*")re");
  static std::regex const quote(R"re(\\")re");
  std::string all;
  for (char const* folder : {"src", "apps", "models", "include", "python/gridlock", "studies"}) {
    for (fs::directory_entry const& entry : fs::recursive_directory_iterator(fs::path(GRIDLOCK_SOURCE_DIR) / folder)) {
      fs::path const extension = entry.path().extension();
      if (extension == ".cpp" || extension == ".hpp" || extension == ".py") all += text_of(entry.path());
    }
  }
  // Quotes inside a literal first, under a mark, so that they do not look like its end.
  all = std::regex_replace(all, quote, "\x01");
  all = std::regex_replace(all, broken, "");
  for (char& c : all) {
    if (c == '\x01') c = '"';
  }
  return all;
}

/// The first cells of the tables of a page, below their heads.
std::vector<std::string> rows_of(std::string const& page) {
  std::vector<std::string> rows;
  bool is_below_head = false;
  std::size_t at = 0;
  while (at < page.size()) {
    std::string const line = page.substr(at, page.find('\n', at) - at);
    at += line.size() + 1;
    if (!line.starts_with("|")) is_below_head = false;
    if (is_below_head) rows.push_back(line.substr(2, line.find(" | ", 2) - 2));
    if (line.starts_with("|---")) is_below_head = true;
  }
  return rows;
}

/// What a row fixes of a message: the parts between "…" and those marks that belong to what is left out.
std::vector<std::string> fixed_words(std::string const& row) {
  static std::regex const left_out("…");
  static std::regex const ends(R"re(^[\s,;:.()"\[\]]+|[\s,;:.()"\[\]]+$)re");
  std::vector<std::string> words;
  std::sregex_token_iterator part(row.begin(), row.end(), left_out, -1);
  for (; part != std::sregex_token_iterator(); ++part) {
    std::string const text = std::regex_replace(part->str(), ends, "");
    if (text.size() > 2) words.push_back(text);
  }
  return words;
}

TEST(ErrorMessages, OfThePageAreThoseOfTheProgram) {
  std::string const sources = literals();
  std::vector<std::string> const rows =
      rows_of(text_of(fs::path(GRIDLOCK_SOURCE_DIR) / "docs/reference/error_messages.md"));
  ASSERT_GT(rows.size(), 100U);
  for (std::string const& row : rows) {
    for (std::string const& words : fixed_words(row)) {
      EXPECT_NE(sources.find(words), std::string::npos) << "no source says \"" << words << "\" of: " << row;
    }
  }
}

}  // namespace
