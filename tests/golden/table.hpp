#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <utility>

#include "golden/hashes.hpp"

namespace gridlock {

/// A committed table: scene and engine → hashes. With GRIDLOCK_WRITE_GOLDEN set it takes what it is asked to compare.
class HashTable {
 public:
  using Name = std::pair<std::string, std::string>;

  explicit HashTable(std::string const& file) : path_(std::string(GRIDLOCK_SOURCE_DIR) + "/tests/golden/" + file) {
    std::ifstream stream(path_);
    std::string line;
    std::getline(stream, line);  // the names of the columns
    while (std::getline(stream, line)) {
      std::stringstream fields(line);
      Name name;
      Hashes hashes;
      std::getline(fields, name.first, ',');
      std::getline(fields, name.second, ',');
      std::getline(fields, hashes.start, ',');
      std::getline(fields, hashes.end, ',');
      rows_[name] = hashes;
    }
  }

  void expect(Name const& name, Hashes const& now) {
    if (is_writing()) {
      rows_[name] = now;
      write();
      return;
    }
    auto const found = rows_.find(name);
    ASSERT_NE(found, rows_.end()) << "no row for " << name.first << " " << name.second << " yet; see hashes_test.cpp";
    EXPECT_EQ(now.start, found->second.start) << "already the start differs";
    EXPECT_EQ(now.end, found->second.end);
  }

  /// Fails for rows of what does not exist any more.
  void expect_only(std::set<Name> const& known) {
    if (is_writing()) {
      std::erase_if(rows_, [&](auto const& row) { return !known.contains(row.first); });
      write();
      return;
    }
    for (auto const& [name, hashes] : rows_) EXPECT_TRUE(known.contains(name)) << name.first << " " << name.second;
  }

 private:
  static bool is_writing() { return std::getenv("GRIDLOCK_WRITE_GOLDEN") != nullptr; }

  void write() const {
    std::ofstream file(path_);
    file << "scene,engine,start,end\n";
    for (auto const& [name, hashes] : rows_) {
      file << name.first << ',' << name.second << ',' << hashes.start << ',' << hashes.end << '\n';
    }
  }

  std::string path_;
  std::map<Name, Hashes> rows_;
};

}  // namespace gridlock
