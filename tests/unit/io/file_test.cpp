#include "io/file.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gridlock/core/error.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

namespace fs = std::filesystem;

std::size_t entries_in(fs::path const& directory) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

std::string failure_of(auto const& action) {
  try {
    action();
  } catch (RunFailure const& failure) {
    return failure.what();
  }
  return "";
}

Problem problem_of(auto const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.problems().at(0);
  }
  return {};
}

TEST(File, ReadsBackEveryByteThatWasWritten) {
  TemporaryDirectory const directory;
  std::string content;
  for (unsigned i = 0; i < 1'000'000; ++i) content += static_cast<char>(i * 7919U >> 3U);
  write_file(directory / "bytes", content);
  EXPECT_TRUE(read_file(directory / "bytes") == content);
  write_file(directory / "bytes", "");
  EXPECT_EQ(read_file(directory / "bytes"), "");
  EXPECT_EQ(entries_in(directory.path()), 1U);
}

TEST(File, PiecesOfAnySizeComeOutInTheirOrder) {
  TemporaryDirectory const directory;
  std::string expected;
  AtomicFile file(directory / "pieces");
  for (std::size_t size : {1UL, 0UL, 100'000UL, 262'144UL, 1UL, 262'143UL, 300'000UL, 5UL}) {
    std::string const piece(size, static_cast<char>('a' + expected.size() % 26));
    file.append(piece);
    expected += piece;
  }
  file.commit();
  EXPECT_TRUE(read_file(directory / "pieces") == expected);
}

TEST(File, WithoutACommitTheOldFileStaysAndNothingIsLeftBehind) {
  TemporaryDirectory const directory;
  write_file(directory / "kept", "old");
  {
    AtomicFile file(directory / "kept");
    file.append(std::string(1'000'000, 'x'));
  }
  EXPECT_EQ(read_file(directory / "kept"), "old");
  EXPECT_EQ(entries_in(directory.path()), 1U);
}

TEST(File, TheNameShowsTheOldContentUntilTheCommit) {
  TemporaryDirectory const directory;
  write_file(directory / "kept", "old");
  AtomicFile file(directory / "kept");
  file.append("new");
  EXPECT_EQ(read_file(directory / "kept"), "old");
  file.commit();
  EXPECT_EQ(read_file(directory / "kept"), "new");
}

TEST(File, WritingThroughALinkKeepsTheLink) {
  TemporaryDirectory const directory;
  write_file(directory / "target", "old");
  fs::create_symlink("target", directory / "link");
  write_file(directory / "link", "new");
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_EQ(read_file(directory / "target"), "new");
}

TEST(File, WrittenInThePlaceOfALinkOrPipeLeavesWhatTheLinkLeadsTo) {
  TemporaryDirectory const directory;
  write_file(directory / "target", "old");
  fs::create_symlink("target", directory / "link");
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);
  for (char const* name : {"link", "pipe"}) {
    AtomicFile file(directory / name, AtName::replaced);
    file.append("new");
    file.commit();
    EXPECT_TRUE(fs::is_regular_file(fs::symlink_status(directory / name))) << name;
    EXPECT_EQ(read_file(directory / name), "new");
  }
  EXPECT_EQ(read_file(directory / "target"), "old");
}

TEST(File, AFullDiskIsARunFailureWithTheReason) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this system";
  EXPECT_EQ(failure_of([] { write_file("/dev/full", "text"); }), "cannot write /dev/full: No space left on device");
}

TEST(File, AFileThatCannotBeMadeIsARunFailureWithTheReason) {
  TemporaryDirectory const directory;
  EXPECT_NE(failure_of([&] { write_file(directory / "no" / "file", ""); }).find("No such file or directory"),
            std::string::npos);
  EXPECT_NE(failure_of([&] { write_file(directory.path(), ""); }).find("Is a directory"), std::string::npos);
}

TEST(File, AMissingFileADirectoryAndATooLargeFileAreRefusedByName) {
  TemporaryDirectory const directory;
  Problem const missing = problem_of([&] { read_file(directory / "missing.toml"); });
  EXPECT_EQ(missing.what, "cannot read " + (directory / "missing.toml").string() + ": No such file or directory");
  EXPECT_EQ(missing.file, (directory / "missing.toml").string());
  EXPECT_FALSE(missing.hint.empty());
  EXPECT_NE(problem_of([&] { read_file(directory.path()); }).what.find("it is a directory"), std::string::npos);
  write_file(directory / "large", "12345");
  EXPECT_EQ(read_file(directory / "large", 5), "12345");
  EXPECT_NE(problem_of([&] { read_file(directory / "large", 4); }).what.find("larger than 4 bytes"), std::string::npos);
}

TEST(File, ADeviceWithoutEndIsRefusedAtTheLimit) {
  EXPECT_NE(problem_of([] { read_file("/dev/zero", 1 << 20); }).what.find("it is a device, and has no end"),
            std::string::npos);
}

TEST(File, AnOutputDirectoryIsMadeWithItsParentsAndLeftEmpty) {
  TemporaryDirectory const directory;
  make_output_directory(directory / "a" / "b");
  make_output_directory(directory / "a" / "b");
  EXPECT_TRUE(fs::is_directory(directory / "a" / "b"));
  EXPECT_EQ(entries_in(directory / "a" / "b"), 0U);
}

TEST(File, AnOutputDirectoryThatCannotBeWrittenIsRefusedUnderItsOption) {
  TemporaryDirectory const directory;
  write_file(directory / "file", "");
  for (fs::path const& path :
       {directory / "file", directory / "file" / "below", fs::path("/proc/nowhere"), fs::path("/proc"), fs::path("")}) {
    Problem const problem = problem_of([&] { make_output_directory(path); });
    EXPECT_EQ(problem.key, "-o") << path;
    EXPECT_NE(problem.what.find("cannot write into the directory " + path.string() + ": "), std::string::npos)
        << problem.what;
    EXPECT_FALSE(problem.hint.empty());
  }
  EXPECT_TRUE(fs::is_regular_file(directory / "file"));
}

/// Starts a process that has begun a file and not finished it, and returns its number.
pid_t start_writer(fs::path const& file) {
  int ready[2];
  if (pipe(ready) != 0) return -1;
  pid_t const writer = fork();
  if (writer == 0) {
    AtomicFile unfinished(file);
    unfinished.append("half");
    static_cast<void>(write(ready[1], "x", 1));
    pause();
    _exit(0);
  }
  char byte = 0;
  EXPECT_EQ(read(ready[0], &byte, 1), 1);
  close(ready[0]);
  close(ready[1]);
  return writer;
}

void kill_writer(pid_t writer) {
  kill(writer, SIGKILL);
  waitpid(writer, nullptr, 0);
}

TEST(Leftovers, OfAKilledProcessAreRemovedAndThoseOfALivingOneStay) {
  TemporaryDirectory const directory;
  pid_t const killed = start_writer(directory / "killed.csv");
  pid_t const living = start_writer(directory / "living.csv");
  kill_writer(killed);
  EXPECT_EQ(entries_in(directory.path()), 2U);
  remove_leftovers(directory.path());
  std::string const part = fmt::format(".living.csv.{}-0.part", living);
  EXPECT_TRUE(fs::exists(directory / part));
  EXPECT_EQ(entries_in(directory.path()), 1U);
  kill_writer(living);
  make_output_directory(directory.path());
  EXPECT_EQ(entries_in(directory.path()), 0U);
}

TEST(Leftovers, AreNotTakenForThemWhatHasAnotherName) {
  TemporaryDirectory const directory;
  char const* const names[] = {"x.csv.12-0.part", ".x.csv.part",  ".x.csv.12.part", ".12-0.part",
                               ".x.12-0.partial", ".x.12-a.part", "x.csv"};
  for (char const* name : names) write_file(directory / name, "mine");
  fs::create_directories(directory / ".x.csv.12-0.part");
  ASSERT_EQ(mkfifo((directory / ".y.csv.12-0.part").c_str(), 0600), 0);
  remove_leftovers(directory.path());
  EXPECT_EQ(entries_in(directory.path()), std::size(names) + 2);
}

TEST(Leftovers, OfAFileThatIsBeingWrittenHereStay) {
  TemporaryDirectory const directory;
  AtomicFile file(directory / "a.csv");
  file.append("whole");
  remove_leftovers(directory.path());
  file.commit();
  EXPECT_EQ(read_file(directory / "a.csv"), "whole");
  EXPECT_EQ(entries_in(directory.path()), 1U);
}

TEST(RequireRegularFile, RefusesAPipeInsteadOfWaitingForItsWriter) {
  TemporaryDirectory const directory;
  ASSERT_EQ(mkfifo((directory / "pipe").c_str(), 0600), 0);
  EXPECT_THROW(require_regular_file(directory / "pipe"), Error);
  EXPECT_THROW(require_regular_file(directory.path()), Error);
  write_file(directory / "file", "");
  require_regular_file(directory / "file");
}

}  // namespace
}  // namespace gridlock
