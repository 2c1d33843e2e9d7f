// Files in extended XYZ that other programs write, given to the program.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

#include "program.hpp"

namespace gridlock::test {
namespace {

/// Two disks of radius 0.1 in a box of 2 × 1, which touch each other through the edge in x where that is periodic.
std::string touching(std::string const& entries, std::string const& name = "radius:R:1",
                     std::string const& size = "0.1") {
  return "2\nLattice=\"2 0 0 0 1 0 0 0 1\" Properties=species:S:1:pos:R:3:" + name + " " + entries + "\nA 0.05 0.5 0 " +
         size + "\nA 1.9 0.5 0 " + size + "\n";
}

Outcome outcome_of(Workplace const& workplace, std::vector<std::string> words) {
  return Process(GRIDLOCK_PROGRAM, std::move(words), workplace.path()).wait();
}

/// "periodic box 2 × 1, 1 contacts", as `gridlock contacts` has it.
std::string found_in(Workplace const& workplace, std::string const& text) {
  write(workplace / "a.xyz", text);
  Outcome const outcome = outcome_of(workplace, {"contacts", "a.xyz"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  std::string const box = outcome.out.substr(outcome.out.find("\n  ") + 3);
  Outcome const numbers = outcome_of(workplace, {"contacts", "a.xyz", "--json"});
  return box.substr(0, box.find('\n')) + ", " + nlohmann::json::parse(numbers.out)["contacts"].dump() + " contacts";
}

TEST(ForeignXyz, ContactsSeeTheBoxThatTheFileHas) {
  Workplace const workplace;
  std::string const periodic = "periodic box 2 × 1, 1 contacts";
  EXPECT_EQ(found_in(workplace, touching("pbc=[T, T, F]")), periodic);
  EXPECT_EQ(found_in(workplace, touching("pbc = \"true true false\"")), periodic);
  EXPECT_EQ(found_in(workplace, touching("note=\"cut from \\\"Lattice={9 0 0 0 9 0 0 0 1} \\\" before\"")), periodic);
  EXPECT_EQ(found_in(workplace, touching("step=-1 seed=None Time=2024-01-01")), periodic);
  EXPECT_EQ(found_in(workplace, touching("Origin=\"-1 -0.5 0\"")), periodic);
  EXPECT_EQ(found_in(workplace, touching("", "diameter:R:1", "0.2")), periodic);
  EXPECT_EQ(found_in(workplace, touching("pbc=[F, F, F]")).substr(0, 16), "walled box 2 × ");
}

TEST(ForeignXyz, ColumnsThatContactsDoNotUseAreNamed) {
  Workplace const workplace;
  write(workplace / "a.xyz", touching("", "radius:R:1:size:R:1", "0.1 7"));
  Outcome const outcome = outcome_of(workplace, {"contacts", "a.xyz"});
  EXPECT_NE(outcome.err.find("note: columns of a.xyz that are not used: size"), std::string::npos) << outcome.err;
}

TEST(ForeignXyz, ARunTellsInTheTerminalAndInItsLogWhatItReplaces) {
  Workplace const workplace;
  write(workplace / "start.xyz", touching("pbc=\"F F F\" step=None", "radius:R:1:forces:R:1", "0.04 3"));
  write(workplace / "a.toml", "disks.file = \"start.xyz\"\nengine.kind = \"exact\"\nrun.steps = 1\n");
  Outcome const outcome = outcome_of(workplace, {"run", "a.toml", "-o", "out", "--no-pictures"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::string const log = text_of(workplace / "out/run.log");
  for (char const* text : {"the start file has no velocities: they are drawn anew",
                           "columns of the start file that are not used: forces", "the start file has step=None"}) {
    EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    EXPECT_NE(log.find(text), std::string::npos) << log;
  }
}

TEST(ForeignXyz, AStartAroundTheOriginOrAtTheFarEdgeRunsInAPeriodicBoxAndIsRefusedBetweenWalls) {
  Workplace const workplace;
  auto const run = [&](std::string const& pbc, std::string const& row) {
    write(workplace / "start.xyz",
          "1\nLattice=\"2 0 0 0 1 0 0 0 1\" pbc=\"" + pbc + "\" Properties=pos:R:2:radius:R:1:velo:R:2\n" + row + "\n");
    write(workplace / "a.toml", "disks.file = \"start.xyz\"\nengine.kind = \"exact\"\nrun.steps = 1\n");
    return outcome_of(workplace, {"run", "a.toml", "-o", "out", "--no-pictures", "--overwrite"});
  };
  for (char const* row : {"-0.25 -0.25 0.1 1 0", "2.0 1.0 0.1 1 0"}) {
    Outcome const folded = run("T T F", row);
    EXPECT_EQ(folded.exit_code, 0) << folded.err;
    Outcome const outside = run("F F F", row);
    EXPECT_EQ(outside.exit_code, 2) << row;
    EXPECT_NE(outside.err.find("start.xyz"), std::string::npos) << outside.err;
  }
  EXPECT_EQ(run("T F F", "-0.25 0.5 0.1 1 0").exit_code, 0) << "periodic along x";
  EXPECT_EQ(run("T F F", "0.5 -0.25 0.1 1 0").exit_code, 2) << "between walls along y";
}

TEST(ForeignXyz, AFrameOfOurOwnExportIsChosenByItsNumber) {
  Workplace const workplace;
  write(
      workplace / "a.toml",
      "disks = {count = 9, packing_fraction = 0.3}\nengine.kind = \"exact\"\nrun.steps = 20\ntrajectory.every = 10\n");
  ASSERT_EQ(outcome_of(workplace, {"run", "a.toml", "-o", "out", "--no-pictures"}).exit_code, 0);
  ASSERT_EQ(outcome_of(workplace, {"export", "out", "--to", "xyz", "-o", "frames.xyz"}).exit_code, 0);
  Outcome const info = outcome_of(workplace, {"info", "frames.xyz"});
  EXPECT_NE(info.out.find("3 frames; this is frame 2"), std::string::npos) << info.out << info.err;
  EXPECT_NE(info.out.find("step 20,"), std::string::npos) << info.out;
  EXPECT_NE(outcome_of(workplace, {"info", "frames.xyz", "--frame", "1"}).out.find("step 10,"), std::string::npos);
  Outcome const contacts = outcome_of(workplace, {"contacts", "frames.xyz"});
  EXPECT_EQ(contacts.exit_code, 2);
  EXPECT_NE(contacts.err.find("choose one: --frame from 0 to 2"), std::string::npos) << contacts.err;
  EXPECT_EQ(outcome_of(workplace, {"contacts", "frames.xyz", "--frame", "-1"}).exit_code, 0);
  write(workplace / "on.toml",
        "disks.file = \"frames.xyz\"\ndisks.frame = 1\nengine.kind = \"exact\"\nrun.steps = 1\n");
  Outcome const onward = outcome_of(workplace, {"run", "on.toml", "-o", "on", "--no-pictures"});
  EXPECT_EQ(onward.exit_code, 0) << onward.err;
  EXPECT_NE(text_of(workplace / "on/start.xyz").find("step=10 "), std::string::npos);
}

TEST(ForeignXyz, ATiltBeyondHalfAWidthIsToldAsFolded) {
  Workplace const workplace;
  write(workplace / "a.xyz",
        "1\nLattice=\"2 0 0 1.5 2 0 0 0 1\" Properties=species:S:1:pos:R:3:radius:R:1 pbc=\"T T F\"\nA 1 1 0 0.25\n");
  Outcome const info = outcome_of(workplace, {"info", "a.xyz"});
  EXPECT_NE(info.out.find("periodic box 2 × 2, tilt -0.25, folded from the tilt 0.75 of the file,"), std::string::npos)
      << info.out << info.err;
  write(workplace / "on.toml", "disks.file = \"a.xyz\"\nengine.kind = \"exact\"\nrun.steps = 1\n");
  Outcome const run = outcome_of(workplace, {"run", "on.toml", "-o", "on", "--no-pictures"});
  EXPECT_NE(run.err.find("box.tilt = 0.75 has the images of a box with the tilt -0.25, which is used"),
            std::string::npos)
      << run.err;
}

TEST(ForeignXyz, InfoKnowsTheEndingsOfOtherPrograms) {
  Workplace const workplace;
  for (char const* name : {"a.xyz", "a.extxyz", "a.exyz"}) {
    write(workplace / name, touching(""));
    EXPECT_NE(outcome_of(workplace, {"info", name}).out.find("2 disks in"), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace gridlock::test
