// Checkpoints of which several processes write a part each; here they are one process, one part after the other.

#include <gtest/gtest.h>

#include <algorithm>
#include <barrier>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "io/checkpoint.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

/// Agents of which a process has some rows, and what all processes have.
struct Agents {
  std::uint64_t step = 0;
  std::string name;
  std::vector<double> sums;
  std::vector<std::uint64_t> ids;
  std::vector<double> x;
  std::vector<std::int32_t> images;
  std::vector<std::uint32_t> kinds;
  std::vector<double> origins;  ///< none before they are noted

  void serialize(Archive& archive) {
    archive.visit("step", step);
    archive.visit("name", name);
    archive.visit("sums", sums);
    serialize_inside(archive, "agents", [&] {
      archive.visit_rows("id", ids);
      archive.visit_rows("x", x);
      archive.visit_rows("image", images);
      archive.visit_rows("kind", kinds);
      archive.visit_rows("origin", origins);
    });
  }

  friend bool operator==(Agents const&, Agents const&) = default;
};

SerializeAll serializing(Agents& agents) {
  return [&agents](Archive& archive) { agents.serialize(archive); };
}

Agents agents_at(std::uint64_t step, std::size_t rows, bool has_origins = true) {
  RandomStream random(5, step, 0, Purpose::start_position);
  Agents agents{.step = step, .name = "ants", .sums = {1.5, -0.0}};
  for (std::size_t k = 0; k < rows; ++k) {
    agents.ids.push_back(2 * k);
    agents.x.push_back(random.uniform());
    agents.images.push_back(static_cast<std::int32_t>(random.bits()));
    agents.kinds.push_back(static_cast<std::uint32_t>(random.bits()));
    if (has_origins) agents.origins.push_back(random.normal());
  }
  return agents;
}

/// Rows first … end − 1.
struct Rows {
  std::uint64_t first, end;
};

template <class Value>
std::vector<Value> rows_of(std::vector<Value> const& all, Rows const& rows) {
  if (all.empty()) return {};
  return {all.begin() + static_cast<std::ptrdiff_t>(rows.first), all.begin() + static_cast<std::ptrdiff_t>(rows.end)};
}

/// What one process has.
Agents part_of(Agents const& all, Rows const& rows) {
  Agents part = all;
  part.ids = rows_of(all.ids, rows);
  part.x = rows_of(all.x, rows);
  part.images = rows_of(all.images, rows);
  part.kinds = rows_of(all.kinds, rows);
  part.origins = rows_of(all.origins, rows);
  return part;
}

/// Shares of any sizes, some of them perhaps of no rows.
std::vector<Rows> shares_of(std::size_t count, std::size_t rows, RandomStream& random) {
  std::vector<std::uint64_t> cuts{0, rows};
  for (std::size_t k = 1; k < count; ++k) cuts.push_back(random.below(rows + 1));
  std::ranges::sort(cuts);
  std::vector<Rows> shares;
  for (std::size_t rank = 0; rank < count; ++rank) shares.push_back({cuts[rank], cuts[rank + 1]});
  return shares;
}

/// The rows that one of several processes restores.
Rows even_share(std::size_t rank, std::size_t count, std::size_t rows) {
  RowDivision const even = RowDivision::even(rows, count);
  return {even.first(rank), even.end(rank)};
}

void save(fs::path const& directory, Agents const& agents, std::vector<Rows> const& shares) {
  std::vector<CheckpointPart> parts;
  for (std::size_t rank = 0; rank < shares.size(); ++rank) {
    Agents part = part_of(agents, shares[rank]);
    parts.push_back(write_checkpoint_part(directory, {.part = rank, .count = shares.size()}, serializing(part)));
  }
  Agents root = part_of(agents, shares.front());
  write_checkpoint(directory, serializing(root), parts);
}

void save(fs::path const& directory, Agents const& agents, std::size_t count) {
  RandomStream random(6, count, 0, Purpose::start_position);
  save(directory, agents, shares_of(count, agents.ids.size(), random));
}

std::map<std::string, std::string> files_in(fs::path const& directory) {
  std::map<std::string, std::string> files;
  for (auto const& entry : fs::directory_iterator(directory)) {
    files[entry.path().filename().string()] = read_file(entry.path());
  }
  return files;
}

void put_files(fs::path const& directory, std::map<std::string, std::string> const& files) {
  for (auto const& entry : fs::directory_iterator(directory)) fs::remove(entry.path());
  for (auto const& [name, content] : files) std::ofstream(directory / name, std::ios::binary) << content;
}

std::vector<std::string> parts_in(fs::path const& directory) {
  std::vector<std::string> parts;
  for (auto const& [name, content] : files_in(directory)) {
    if (name.starts_with("checkpoint.part.")) parts.push_back(name);
  }
  return parts;
}

Agents restored_from(fs::path const& directory, std::string& note) {
  Agents restored;
  auto const found = restore_checkpoint(directory, serializing(restored));
  note = found ? found->note : "there is none";
  return restored;
}

Agents restored_from(fs::path const& directory) {
  std::string note;
  return restored_from(directory, note);
}

TEST(CheckpointParts, OfAnyNumberOfProcessesAreRestoredByAnyOther) {
  RandomStream random(1, 0, 0, Purpose::start_position);
  for (int round = 0; round < 60; ++round) {
    TemporaryDirectory const directory;
    std::size_t const rows = round % 7 == 0 ? 0 : random.below(200);
    Agents const agents = agents_at(static_cast<std::uint64_t>(round), rows, round % 3 != 0);
    std::size_t const writers = random.below(7);
    if (writers == 0) {
      Agents whole = agents;
      write_checkpoint(directory.path(), serializing(whole));
    } else {
      save(directory.path(), agents, shares_of(writers, rows, random));
    }
    EXPECT_EQ(parts_in(directory.path()).size(), writers);
    EXPECT_EQ(restored_from(directory.path()), agents);
    std::size_t const readers = 1 + random.below(6);
    for (std::size_t rank = 0; rank < readers; ++rank) {
      Agents part;
      ASSERT_TRUE(restore_checkpoint(directory.path(), serializing(part), {.part = rank, .count = readers}));
      EXPECT_EQ(part, part_of(agents, even_share(rank, readers, rows))) << writers << " writers, rank " << rank;
    }
  }
}

TEST(CheckpointParts, OfAgentsThatComeAndGoHaveListsOfAnyLengths) {
  RandomStream random(8, 0, 0, Purpose::start_position);
  for (int round = 0; round < 40; ++round) {
    TemporaryDirectory const directory;
    // What was noted is of other agents than those who live now.
    Agents all = agents_at(static_cast<std::uint64_t>(round), random.below(200));
    all.origins.resize(random.below(150), 0.5);
    std::size_t const writers = 1 + random.below(6);
    auto const of_agents = shares_of(writers, all.ids.size(), random);
    auto const of_origins = shares_of(writers, all.origins.size(), random);
    std::vector<CheckpointPart> parts;
    std::vector<Agents> written;
    for (std::size_t rank = 0; rank < writers; ++rank) {
      Agents alive = all;
      alive.origins.clear();
      Agents part = part_of(alive, of_agents[rank]);
      part.origins = rows_of(all.origins, of_origins[rank]);
      parts.push_back(write_checkpoint_part(directory.path(), {.part = rank, .count = writers}, serializing(part)));
      written.push_back(part);
    }
    write_checkpoint(directory.path(), serializing(written.front()), parts);
    EXPECT_EQ(restored_from(directory.path()), all);
    // Others get as many of each list.
    std::size_t const readers = 1 + random.below(6);
    Agents together = all;
    for (auto* list : {&together.x, &together.origins}) list->clear();
    for (std::size_t rank = 0; rank < readers; ++rank) {
      Agents part;
      ASSERT_TRUE(restore_checkpoint(directory.path(), serializing(part), {.part = rank, .count = readers}));
      EXPECT_NEAR(static_cast<double>(part.x.size()), static_cast<double>(all.x.size()) / static_cast<double>(readers),
                  1.0);
      EXPECT_EQ(part.x.size(), part.ids.size());
      together.x.insert(together.x.end(), part.x.begin(), part.x.end());
      together.origins.insert(together.origins.end(), part.origins.begin(), part.origins.end());
    }
    EXPECT_EQ(together, all) << writers << " writers, " << readers << " readers";
  }
}

TEST(CheckpointParts, OfAgentsThatComeAndGoAreNamedOnceWhereOneIsMissing) {
  TemporaryDirectory const directory;
  Agents all = agents_at(1, 20);
  CheckpointShare const share{.part = 0, .count = 1};
  write_checkpoint(directory.path(), serializing(all),
                   {write_checkpoint_part(directory.path(), share, serializing(all))});
  std::string const part = parts_in(directory.path()).front();
  fs::remove(directory.path() / part);
  try {
    restored_from(directory.path());
    FAIL() << "a part is missing";
  } catch (Error const& error) {
    EXPECT_EQ(error.problems().front().what,
              "cannot use the checkpoint " + (directory.path() / part).string() + ": it is missing");
  }
}

TEST(CheckpointParts, OnlyThoseOfTheNewestAndThePreviousCheckpointStay) {
  TemporaryDirectory const directory;
  fs::path const& path = directory.path();
  save(path, agents_at(1, 50), 3);
  EXPECT_EQ(parts_in(path).size(), 3U);
  save(path, agents_at(2, 50), 5);
  EXPECT_EQ(parts_in(path).size(), 3U + 5U);
  save(path, agents_at(3, 50), 2);
  EXPECT_EQ(parts_in(path).size(), 5U + 2U);
  save(path, agents_at(3, 50), 2);
  EXPECT_EQ(parts_in(path).size(), 2U) << "the same once more has the same parts";
  EXPECT_EQ(restored_from(path).step, 3U);
  Agents whole = agents_at(4, 50);
  write_checkpoint(path, serializing(whole));
  EXPECT_EQ(parts_in(path).size(), 2U);
  remove_previous_checkpoint(path);
  EXPECT_EQ(files_in(path).size(), 1U);
  save(path, agents_at(5, 50), 4);
  remove_checkpoints(path);
  EXPECT_TRUE(fs::is_empty(path));
}

TEST(CheckpointParts, OfACheckpointThatCouldNotBeWrittenGo) {
  TemporaryDirectory const directory;
  fs::path const& path = directory.path();
  save(path, agents_at(1, 50), 3);
  Agents next = agents_at(2, 50);
  static_cast<void>(write_checkpoint_part(path, {.part = 0, .count = 2}, serializing(next)));
  EXPECT_EQ(parts_in(path).size(), 4U);
  remove_unneeded_parts(path);
  EXPECT_EQ(parts_in(path).size(), 3U);
  EXPECT_EQ(restored_from(path).step, 1U);
}

TEST(CheckpointParts, AreNotWhatUsersHaveCalledLikeThem) {
  TemporaryDirectory const directory;
  fs::path const& path = directory.path();
  std::string const checksum(32, 'a');
  std::vector<std::string> const names{"checkpoint.part.notes.gridlock",
                                       "checkpoint.part.0.gridlock",
                                       "checkpoint.part.0.zz.gridlock",
                                       "checkpoint.part." + checksum + ".gridlock",
                                       "checkpoint.part.0." + checksum + ".copy.gridlock",
                                       "checkpoint.part..gridlock",
                                       "checkpoint.part.gridlock"};
  for (std::string const& name : names) std::ofstream(path / name) << "precious";
  fs::create_directory(path / ("checkpoint.part.1." + checksum + ".gridlock"));
  save(path, agents_at(1, 50), 3);
  save(path, agents_at(2, 50), 3);
  remove_previous_checkpoint(path);
  remove_checkpoints(path);
  std::size_t const left = static_cast<std::size_t>(std::distance(fs::directory_iterator(path), {}));
  EXPECT_EQ(left, names.size() + 1);
}

TEST(CheckpointParts, KilledBetweenAnyTwoStepsLeaveACheckpoint) {
  TemporaryDirectory const directory;
  fs::path const& path = directory.path();
  save(path, agents_at(1, 40), 3);
  save(path, agents_at(2, 40), 2);
  auto const before = files_in(path);
  save(path, agents_at(3, 40), 4);
  auto const after = files_in(path);

  // What a save does to the files, one step after the other.
  std::vector<std::map<std::string, std::string>> moments{before};
  auto const step = [&](auto const& change) {
    auto files = moments.back();
    change(files);
    moments.push_back(files);
  };
  auto const is_part = [](std::string const& name) { return name.starts_with("checkpoint.part."); };
  for (auto const& file : after) {
    if (is_part(file.first) && !before.contains(file.first)) step([&](auto& files) { files.insert(file); });
  }
  EXPECT_EQ(moments.size(), 1U + 4U);
  step([](auto& files) {
    files["checkpoint.previous.gridlock"] = files["checkpoint.gridlock"];
    files.erase("checkpoint.gridlock");
  });
  step([&](auto& files) { files["checkpoint.gridlock"] = after.at("checkpoint.gridlock"); });
  for (auto const& file : before) {
    if (is_part(file.first) && !after.contains(file.first)) step([&](auto& files) { files.erase(file.first); });
  }
  ASSERT_EQ(moments.back(), after);
  EXPECT_EQ(moments.size(), 1U + 4U + 2U + 3U);

  for (std::size_t k = 0; k < moments.size(); ++k) {
    put_files(path, moments[k]);
    std::string note;
    Agents const restored = restored_from(path, note);
    EXPECT_EQ(note, "");
    EXPECT_EQ(restored, agents_at(k < 6 ? 2 : 3, 40)) << "after step " << k;
    // The run goes on from there, and nothing is left over.
    save(path, agents_at(3, 40), 4);
    save(path, agents_at(4, 40), 2);
    EXPECT_EQ(parts_in(path).size(), 4U + 2U) << "after step " << k;
    EXPECT_EQ(restored_from(path), agents_at(4, 40));
  }
}

/// Restores from a directory in which one file is not as it was written; it has to be named, and the previous one be
/// used.
void expect_previous(fs::path const& directory, std::string const& damaged, std::string const& what) {
  std::string note;
  Agents const restored = restored_from(directory, note);
  EXPECT_EQ(restored, agents_at(1, 30)) << damaged << ": " << what;
  EXPECT_NE(note.find(damaged), std::string::npos) << note << ": " << what;
}

TEST(CheckpointParts, ThatAreDamagedAreNamedAndThePreviousCheckpointIsUsed) {
  TemporaryDirectory const directory;
  fs::path const& path = directory.path();
  save(path, agents_at(1, 30), 2);
  auto const before = files_in(path);
  save(path, agents_at(2, 30), 3);
  auto const good = files_in(path);
  RandomStream random(2, 0, 0, Purpose::start_position);
  int damaged_files = 0;
  for (auto const& file : good) {
    std::string const& name = file.first;
    if (name == "checkpoint.previous.gridlock" || before.contains(name) != (name == "checkpoint.gridlock")) continue;
    ++damaged_files;
    std::string const& content = file.second;
    auto const expect_refusal_of = [&](std::string const& bad, std::string const& what) {
      auto files = good;
      files[name] = bad;
      put_files(path, files);
      expect_previous(path, name, what);
    };
    for (std::size_t k = 0; k < content.size(); k += 1 + random.below(8)) {
      std::string flipped = content;
      flipped[k] = static_cast<char>(flipped[k] ^ (1 << random.below(8)));
      expect_refusal_of(flipped, "flipped at " + std::to_string(k));
      expect_refusal_of(content.substr(0, k), "cut at " + std::to_string(k));
    }
    expect_refusal_of(content + "x", "longer");
    if (name == "checkpoint.gridlock") continue;
    auto missing = good;
    missing.erase(name);
    put_files(path, missing);
    expect_previous(path, name, "missing");
    for (auto const& [other, other_content] : good) {
      if (other.starts_with("checkpoint.part.") && other != name) expect_refusal_of(other_content, other);
    }
  }
  EXPECT_EQ(damaged_files, 1 + 3);
}

TEST(CheckpointParts, WithAnotherNumberOfRowsThanTheCheckpointSaysAreRefusedNamingThem) {
  TemporaryDirectory const directory;
  Agents const agents = agents_at(1, 30);
  Agents part = part_of(agents, {0, 10});
  Agents other = part_of(agents, {10, 30});
  std::vector<CheckpointPart> parts{
      write_checkpoint_part(directory.path(), {.part = 0, .count = 2}, serializing(part)),
      write_checkpoint_part(directory.path(), {.part = 1, .count = 2}, serializing(other))};
  parts[0].lengths[1] = 9;
  write_checkpoint(directory.path(), serializing(part), parts);
  try {
    restored_from(directory.path());
    FAIL() << "a list lacks a value";
  } catch (Error const& error) {
    std::string const refusal = error.problems().front().what;
    EXPECT_NE(refusal.find("checkpoint.part.0."), std::string::npos) << refusal;
    EXPECT_NE(refusal.find("10 values of \"agents.x\" for 9 rows"), std::string::npos) << refusal;
  }
}

TEST(CheckpointParts, WhereOneProcessFindsDamageAllGoBackToThePreviousCheckpoint) {
  TemporaryDirectory const directory;
  save(directory.path(), agents_at(1, 30), 2);
  save(directory.path(), agents_at(2, 30), {Rows{0, 10}, Rows{10, 27}, Rows{27, 30}});
  constexpr std::size_t count = 3;
  // The last rows, which only the last process needs.
  std::string last;
  for (std::string const& name : parts_in(directory.path())) {
    if (name.starts_with("checkpoint.part.2.")) last = name;
  }
  ASSERT_NE(last, "");
  fs::resize_file(directory.path() / last, 40);

  std::vector<std::string> reasons(count);
  std::barrier meeting(static_cast<std::ptrdiff_t>(count));
  std::vector<Agents> restored(count);
  std::vector<std::string> notes(count);
  std::vector<std::thread> processes;
  for (std::size_t rank = 0; rank < count; ++rank) {
    processes.emplace_back([&, rank] {
      auto const agree = [&](std::string const& reason) {
        meeting.arrive_and_wait();
        reasons[rank] = reason;
        meeting.arrive_and_wait();
        auto const first = std::ranges::find_if(reasons, [](std::string const& text) { return !text.empty(); });
        return first == reasons.end() ? std::string() : *first;
      };
      notes[rank] =
          restore_checkpoint(directory.path(), serializing(restored[rank]), {.part = rank, .count = count}, agree)
              .value()
              .note;
    });
  }
  for (std::thread& process : processes) process.join();
  for (std::size_t rank = 0; rank < count; ++rank) {
    EXPECT_EQ(restored[rank], part_of(agents_at(1, 30), even_share(rank, count, 30))) << rank;
    EXPECT_NE(notes[rank].find(last), std::string::npos) << notes[rank];
  }
}

}  // namespace
}  // namespace gridlock
