// Processes that share a run fail together or not at all.

#include "gridlock/parallel/detail/agreement.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <new>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"
#include "thread_ranks.hpp"

namespace gridlock {
namespace {

using test::ThreadRanks;

/// The failure that each of four ranks throws where `fails(rank)` is the work of all.
template <class Work>
std::vector<std::string> failures_of(Work fails) {
  constexpr std::size_t count = 4;
  std::vector<std::string> failures(count);
  ThreadRanks(count).run([&](Communicator& here) {
    try {
      agree(here, [&] { fails(here.rank()); });
    } catch (Error const& error) {
      failures[here.rank()] = std::string("Error: ") + error.what();
    } catch (RunFailure const& failure) {
      failures[here.rank()] = std::string("RunFailure: ") + failure.what();
    }
  });
  return failures;
}

TEST(Agreement, LetsAllGoOnWhereNoneFails) {
  EXPECT_EQ(failures_of([](std::size_t) {}), std::vector<std::string>(4));
}

TEST(Agreement, HasAllFailAsTheFirstDoesThatFails) {
  auto const of_input = [](std::size_t rank) {
    if (rank >= 2) throw Error({.what = "too many disks on " + std::to_string(rank), .key = "disks.count"});
  };
  std::vector<std::string> const refused = failures_of(of_input);
  EXPECT_NE(refused[2].find("Error: too many disks on 2"), std::string::npos) << refused[2];
  EXPECT_EQ(refused, std::vector<std::string>(4, refused[2]));
  auto const of_run = [](std::size_t rank) {
    if (rank == 3) throw RunFailure("the disk is full");
  };
  EXPECT_EQ(failures_of(of_run),
            (std::vector<std::string>{"RunFailure: rank 3: the disk is full", "RunFailure: rank 3: the disk is full",
                                      "RunFailure: rank 3: the disk is full", "RunFailure: rank 3: the disk is full"}));
  auto const of_memory = [](std::size_t rank) {
    if (rank == 1) throw std::bad_alloc();
  };
  EXPECT_EQ(failures_of(of_memory), std::vector<std::string>(4, "RunFailure: rank 1: not enough memory"));
}

TEST(Agreement, KeepsThePlaceOfARefusal) {
  ThreadRanks(3).run([](Communicator& here) {
    try {
      AllProcesses(here).on_root([] {
        throw Error(Problem{.what = "it is negative",
                            .hint = "use a number above 0",
                            .key = "gas.temperature",
                            .file = "gas.toml",
                            .line = 7,
                            .column = 3,
                            .source_line = "temperature = -1"});
      });
      ADD_FAILURE() << "rank " << here.rank() << " goes on";
    } catch (Error const& error) {
      Problem const& problem = error.problems().front();
      EXPECT_EQ(problem.what, "it is negative");
      EXPECT_EQ(problem.hint, "use a number above 0");
      EXPECT_EQ(problem.key, "gas.temperature");
      EXPECT_EQ(problem.file, "gas.toml");
      EXPECT_EQ(problem.line, 7);
      EXPECT_EQ(problem.column, 3);
      EXPECT_EQ(problem.source_line, "temperature = -1");
    }
  });
}

TEST(Agreement, SaysWhetherAllHaveFailedWhenTheyLastAgreed) {
  ThreadRanks(3).run([](Communicator& here) {
    EXPECT_FALSE(here.have_all_failed());
    EXPECT_THROW(agree(here, [] { throw RunFailure("over"); }), RunFailure);
    EXPECT_TRUE(here.have_all_failed());
    agree(here, [] {});
    EXPECT_FALSE(here.have_all_failed());
  });
}

TEST(AllProcesses, HaveTheValueOfTheRoot) {
  ThreadRanks(5).run([](Communicator& here) {
    AllProcesses const all(here);
    auto const value = all.of_root(std::array{10.5 + static_cast<double>(here.rank()), 2.0});
    EXPECT_EQ(value, (std::array{10.5, 2.0}));
    EXPECT_EQ(all.sum(here.rank()), 10U);
    EXPECT_EQ(all.is_root(), here.rank() == 0);
  });
  EXPECT_EQ(AllProcesses().of_root(3), 3);
}

}  // namespace
}  // namespace gridlock
