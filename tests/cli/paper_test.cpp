// The study of the paper as a job that is stopped and goes on, through the program itself.
#include <gtest/gtest.h>

#include <chrono>
#include <string>
#include <thread>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

TEST(Paper, StoppedByASignalInFigure5KeepsWhatIsDoneAndSaysHowToGoOn) {
  for (int const signal : {SIGINT, SIGTERM}) {
    Workplace const workplace;
    Process const process(GRIDLOCK_PROGRAM, {"paper", "--figure", "5", "-o", "out"}, workplace.path());
    wait_for(workplace / "out/.lock");
    process.signal(signal);
    Outcome const outcome = process.wait();
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_NE(outcome.err.find("the same command does the rest"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
    // Nothing is drawn of a study that is not finished.
    EXPECT_EQ(contents(workplace / "out"), std::vector<std::string>{"partial_results"});
    EXPECT_EQ(contents(workplace / "out/partial_results").size(), 1U);
  }
}

TEST(Paper, ThatIsFinishedIsMadeAnewOnlyWhenAsked) {
  Workplace const workplace;
  auto const paper = [&](std::vector<std::string> const& more) {
    std::vector<std::string> words{"paper", "--figure", "4", "-o", "out"};
    words.insert(words.end(), more.begin(), more.end());
    return gridlock::test::gridlock(words, workplace.path());
  };
  EXPECT_EQ(paper({}).exit_code, 0);
  Outcome const refused = paper({});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("holds results already"), std::string::npos) << refused.err;
  EXPECT_EQ(paper({"--overwrite"}).exit_code, 0);
}

}  // namespace
