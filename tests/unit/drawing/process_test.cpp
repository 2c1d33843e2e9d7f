#include "drawing/process.hpp"

#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <string>

#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

using namespace std::chrono_literals;

TEST(ChildProcess, ReadsWhatItIsGivenHoweverMuchThatIs) {
  TemporaryDirectory const directory;
  std::string const text(3'000'000, 'x');
  ChildProcess process({"/bin/sh", "-c", "cat > copy"}, directory.path(), ProcessInput::pipe);
  EXPECT_TRUE(process.write(text, 30s));
  EXPECT_TRUE(process.write("end", 30s));
  ProcessResult const result = process.wait(30s);
  EXPECT_TRUE(result.succeeded);
  EXPECT_EQ(read_file(directory / "copy"), text + "end");
}

TEST(ChildProcess, ThatReadsNoMoreDoesNotEndTheWriter) {
  TemporaryDirectory const directory;
  ChildProcess process({"/bin/sh", "-c", "echo enough >&2; exit 3"}, directory.path(), ProcessInput::pipe);
  bool is_read = true;
  for (int n = 0; n < 100 && is_read; ++n) is_read = process.write(std::string(100'000, 'x'), 30s);
  EXPECT_FALSE(is_read);
  ProcessResult const result = process.wait(30s);
  EXPECT_FALSE(result.succeeded);
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.errors, "enough\n");
}

TEST(ChildProcess, ThatComplainsALotBeforeItReadsIsHeard) {
  TemporaryDirectory const directory;
  ChildProcess process({"/bin/sh", "-c", "head -c 300000 /dev/zero >&2; cat > /dev/null"}, directory.path(),
                       ProcessInput::pipe);
  EXPECT_TRUE(process.write(std::string(3'000'000, 'x'), 30s));
  EXPECT_TRUE(process.wait(30s).succeeded);
}

TEST(ChildProcess, ThatDoesNotReadInTimeIsEnded) {
  TemporaryDirectory const directory;
  ChildProcess process({"/bin/sh", "-c", "sleep 100"}, directory.path(), ProcessInput::pipe);
  EXPECT_FALSE(process.write(std::string(3'000'000, 'x'), 20ms));
  ProcessResult const result = process.wait(20ms);
  EXPECT_TRUE(result.timed_out);
  EXPECT_FALSE(result.succeeded);
}

TEST(ChildProcess, ThatIsNoProgramIsNotFound) {
  TemporaryDirectory const directory;
  ChildProcess process({"no-such-program"}, directory.path(), ProcessInput::pipe);
  EXPECT_FALSE(process.write("text", 20ms));
  EXPECT_FALSE(process.wait(20ms).was_found);
}

TEST(ChildProcess, IsKilledWithAParentThatIsKilled) {
  TemporaryDirectory const directory;
  ASSERT_EQ(prctl(PR_SET_CHILD_SUBREAPER, 1), 0) << "to wait for the child of a child";
  pid_t const parent = fork();
  if (parent == 0) {
    ChildProcess const process({"/bin/sleep", "20"}, directory.path(), ProcessInput::pipe);
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(parent, &status, 0), parent);
  ASSERT_TRUE(WIFSIGNALED(status));
  ASSERT_GT(waitpid(-1, &status, 0), 0);
  EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

}  // namespace
}  // namespace gridlock
