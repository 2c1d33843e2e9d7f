// Checkpoints of processes that share a run, here threads: written and restored by all of them, or by none.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/checkpoint.hpp"
#include "thread_ranks.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

using test::ThreadRanks;

/// Rows of one process, and a step that all have.
struct SavedRows {
  std::uint64_t step = 0;
  std::vector<std::uint64_t> rows;
  std::string failure = {};  ///< why they cannot be saved

  void serialize(Archive& archive) {
    archive.visit("step", step);
    archive.visit_rows("rows", rows);
    if (!failure.empty()) throw RunFailure(failure);
  }
};

/// The rows that each of three processes gets back; the step is 0 where there is nothing to restore.
std::vector<SavedRows> restored(std::filesystem::path const& directory) {
  std::vector<SavedRows> parts(3);
  ThreadRanks(3).run([&](Communicator& here) {
    SavedRows& own = parts[here.rank()];
    static_cast<void>(restore_checkpoint_of_all(
        directory, [&](Archive& archive) { own.serialize(archive); }, here));
  });
  return parts;
}

TEST(CheckpointOfAll, GivesEachProcessAsManyRows) {
  TemporaryDirectory const directory;
  ThreadRanks(2).run([&](Communicator& here) {
    SavedRows own{.step = 7,
                  .rows = here.rank() == 0 ? std::vector<std::uint64_t>{0, 1, 2, 3, 4} : std::vector<std::uint64_t>{5}};
    write_checkpoint_of_all(
        directory.path(), [&](Archive& archive) { own.serialize(archive); }, here);
  });
  std::vector<SavedRows> const parts = restored(directory.path());
  for (std::size_t rank = 0; rank < 3; ++rank) {
    EXPECT_EQ(parts[rank].step, 7U);
    EXPECT_EQ(parts[rank].rows, (std::vector<std::uint64_t>{2 * rank, 2 * rank + 1}));
  }
}

TEST(CheckpointOfAll, FailsInAllProcessesWhereOneCannotSaveItsRowsAndLeavesTheOneBefore) {
  TemporaryDirectory const directory;
  for (std::uint64_t const step : {1U, 2U}) {
    ThreadRanks(3).run([&](Communicator& here) {
      SavedRows own{.step = step, .rows = {10 * step + here.rank()}};
      if (step == 2 && here.rank() == 1) own.failure = "no space left on the device";
      std::string why;
      try {
        write_checkpoint_of_all(
            directory.path(), [&](Archive& archive) { own.serialize(archive); }, here);
      } catch (RunFailure const& failure) {
        why = failure.what();
      }
      EXPECT_EQ(why, step == 2 ? "rank 1: no space left on the device" : "") << "rank " << here.rank();
    });
  }
  std::vector<SavedRows> const parts = restored(directory.path());
  for (std::size_t rank = 0; rank < 3; ++rank) {
    EXPECT_EQ(parts[rank].step, 1U);
    EXPECT_EQ(parts[rank].rows, std::vector<std::uint64_t>{10 + rank});
  }
}

}  // namespace
}  // namespace gridlock
