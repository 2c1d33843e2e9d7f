// A command that the program does not have is a program of its own, gridlock-WORD, beside it or on the path.
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

/// A copy of the program in `bin`, an empty directory `path` that is the whole PATH, and the scripts that tests put
/// there.
class OtherProgram : public testing::Test {
 protected:
  OtherProgram() {
    for (char const* name : {"bin", "path", "work"}) fs::create_directory(workplace_ / name);
    fs::copy_file(GRIDLOCK_PROGRAM, workplace_ / "bin/gridlock");
  }

  /// `where` is the name of the script from the workplace.
  void add_script(std::string const& where, std::string const& text) const {
    write(workplace_ / where, text);
    fs::permissions(workplace_ / where, fs::perms::owner_all);
  }

  [[nodiscard]] Process begin(std::vector<std::string> words, std::string const& program = "bin/gridlock") const {
    words.insert(words.begin(), {"PATH=" + (workplace_ / "path").string(), (workplace_ / program).string()});
    return {"/usr/bin/env", std::move(words), workplace_ / "work"};
  }
  [[nodiscard]] Outcome run(std::vector<std::string> words) const { return begin(std::move(words)).wait(); }

  void expect_unknown(std::string const& word) const {
    Outcome const outcome = run({word, "x"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find("there is no command \"" + word + "\"\n  hint: "), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }

  Workplace workplace_;
};

constexpr char const* print_arguments = "#!/bin/sh\nfor word in \"$@\"; do echo \"<$word>\"; done\n";

TEST_F(OtherProgram, BesideTheProgramOrOnThePathIsRun) {
  expect_unknown("greet");
  add_script("path/gridlock-greet", "#!/bin/sh\necho path\n");
  EXPECT_EQ(run({"greet"}).out, "path\n");
  add_script("bin/gridlock-greet", "#!/bin/sh\necho beside\n");
  EXPECT_EQ(run({"greet"}).out, "beside\n");
  // Beside the program itself, not beside a link to it.
  fs::create_directory(workplace_ / "links");
  fs::create_symlink("../bin/gridlock", workplace_ / "links/gridlock");
  add_script("links/gridlock-greet", "#!/bin/sh\necho link\n");
  EXPECT_EQ(begin({"greet"}, "links/gridlock").wait().out, "beside\n");
}

TEST_F(OtherProgram, GetsTheOtherWordsAsTheyAre) {
  add_script("path/gridlock-print_it", print_arguments);
  Outcome const outcome =
      run({"print_it", "two words", "a'b\"c", "", "--set", "*", "$HOME", "-h", "--version", "ψ\n6"});
  expect_good(outcome);
  EXPECT_EQ(outcome.out, "<two words>\n<a'b\"c>\n<>\n<--set>\n<*>\n<$HOME>\n<-h>\n<--version>\n<ψ\n6>\n");
  EXPECT_EQ(run({"help", "print_it"}).out, "<--help>\n");
}

TEST_F(OtherProgram, EndsAsItEnds) {
  add_script("path/gridlock-fail", "#!/bin/sh\necho out; echo err >&2; exit 37\n");
  Outcome const failed = run({"fail"});
  EXPECT_EQ(failed.exit_code, 37);
  EXPECT_EQ(failed.out, "out\n");
  EXPECT_EQ(failed.err, "err\n");
  add_script("path/gridlock-die", "#!/bin/sh\nkill -TERM $$\n");
  EXPECT_EQ(run({"die"}).exit_code, 128 + SIGTERM);
}

TEST_F(OtherProgram, GetsTheSignals) {
  add_script("path/gridlock-wait",
             "#!/bin/sh\ntrap 'echo caught; exit 5' INT\n: >begun\nwhile :; do /bin/sleep 0.01; done\n");
  Process const process = begin({"wait"});
  wait_for(workplace_ / "work/begun");
  process.signal(SIGINT);
  Outcome const outcome = process.wait();
  EXPECT_EQ(outcome.exit_code, 5);
  EXPECT_EQ(outcome.out, "caught\n");
}

TEST_F(OtherProgram, IsNoFileThatCannotBeOne) {
  write(workplace_ / "path/gridlock-text", print_arguments);  // may not be executed
  expect_unknown("text");
  fs::create_directory(workplace_ / "path/gridlock-folder");
  expect_unknown("folder");
  fs::create_symlink("nowhere", workplace_ / "path/gridlock-broken");
  expect_unknown("broken");
  add_script("gridlock-out", print_arguments);
  fs::create_directory(workplace_ / "path/gridlock-up");
  for (char const* word : {"../out", "up/../../gridlock-out", "x.y", "a b", "ψ"}) expect_unknown(word);
  for (char const* name : {"gridlock-", "gridlock--help"}) add_script(std::string("path/") + name, print_arguments);
  EXPECT_EQ(run({""}).exit_code, 2);
  EXPECT_NE(run({"--help"}).out.find("Commands:"), std::string::npos);
}

TEST_F(OtherProgram, ThatCannotBeStartedIsAnErrorThatNamesIt) {
  add_script("path/gridlock-odd", "#!/no/such/interpreter\n");
  Outcome const outcome = run({"odd"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("path/gridlock-odd could not be started: "), std::string::npos) << outcome.err;
}

TEST_F(OtherProgram, NeverTakesThePlaceOfACommand) {
  add_script("bin/gridlock-explain", "#!/bin/sh\nexit 9\n");
  expect_good(run({"explain", "run.seed"}));
}

TEST_F(OtherProgram, IsListedByTheHelpAndMeantByANearlyEqualWord) {
  EXPECT_EQ(run({"--help"}).out.find("Other programs"), std::string::npos);
  add_script("path/gridlock-greet", print_arguments);
  add_script("bin/gridlock-greet", print_arguments);
  add_script("bin/gridlock-explain", print_arguments);
  std::string const help = run({"--help"}).out;
  std::size_t const group = help.find("Other programs:\n  greet  ");
  ASSERT_NE(group, std::string::npos) << help;
  EXPECT_EQ(help.find("greet", group + 20), help.rfind("greet")) << "listed twice\n" << help;
  EXPECT_EQ(help.find("gridlock-explain"), std::string::npos) << help;
  EXPECT_EQ(run({"help"}).out, help);
  EXPECT_NE(run({"gret"}).err.find("did you mean gridlock greet?"), std::string::npos);
}

TEST_F(OtherProgram, OfAProgramWithOwnModelsHasTheSameName) {
  fs::copy_file(GRIDLOCK_OWN_PROGRAM, workplace_ / "bin/town");
  add_script("path/gridlock-greet", "#!/bin/sh\necho hello\n");
  EXPECT_EQ(begin({"greet"}, "bin/town").wait().out, "hello\n");
}

TEST_F(OtherProgram, IsFoundWithoutAPath) {
  add_script("bin/gridlock-greet", "#!/bin/sh\necho hello\n");
  EXPECT_EQ(
      Process("/usr/bin/env", {"-i", (workplace_ / "bin/gridlock").string(), "greet"}, workplace_.path()).wait().out,
      "hello\n");
}

}  // namespace
