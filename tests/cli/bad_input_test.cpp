// Every mistake a user can make in the input: the program says what, where and what to do, ends with 2, and leaves the
// directory as it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace {

using namespace gridlock::test;

struct Mistake {
  char const* name;
  std::string toml;                      ///< becomes bad.toml
  std::vector<std::string> said;         ///< what standard error must hold
  std::vector<std::string> arguments{};  ///< empty: run bad.toml -o out
};

void PrintTo(Mistake const& mistake, std::ostream* stream) { *stream << mistake.name; }

std::string const good_xyz =
    "2\n"
    "Lattice=\"1 0 0 0 1 0 0 0 1\" pbc=\"F F F\" Properties=species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:masses:R:1\n"
    "Ar 0.25 0.5 0 0 0.5 0 0 0.1 1\n"
    "Ar 0.75 0.5 0 1 -0.5 0 0 0.1 1\n";

std::string const from_file = "[disks]\nfile = \"start.xyz\"\n";

/// A start file with one piece replaced.
std::string damaged(std::string const& piece, std::string const& by) {
  std::string text = good_xyz;
  text.replace(text.find(piece), piece.size(), by);
  return text;
}

class BadInput : public testing::TestWithParam<Mistake> {};

TEST_P(BadInput, IsRefusedWithPlaceAndHintAndLeavesNothingBehind) {
  Workplace const workplace;
  write(workplace / "bad.toml", GetParam().toml);
  write(workplace / "start.xyz", good_xyz);
  write(workplace / "file", "not a directory");
  auto const before = contents(workplace.path());
  std::vector<std::string> arguments = GetParam().arguments;
  if (arguments.empty()) arguments = {"run", "bad.toml", "-o", "out"};

  Outcome const outcome = gridlock::test::gridlock(arguments, workplace.path());

  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_TRUE(outcome.err.starts_with("error: ")) << outcome.err;
  EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  for (std::string const& words : GetParam().said) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << "missing: " << words << "\nin: " << outcome.err;
  }
  EXPECT_EQ(contents(workplace.path()), before);
}

std::vector<Mistake> const mistakes_in_settings{
    {"UnknownKey", "[disks]\ncuont = 10\n", {"cuont", "bad.toml:2:1", "count"}},
    {"FormerKey",
     "[observe]\ndiscard = 0.5\n",
     {"bad.toml:2:1", "observe.discard was renamed to observe.equilibration"}},
    {"UnknownTable", "[dissk]\ncount = 10\n", {"dissk", "bad.toml:1", "disks"}},
    {"UnknownModel", "[model]\nkind = \"flock\"\n", {"flock", "bad.toml:2", "flocking"}},
    {"DisksForAModel", "model.kind = \"flocking\"\n[disks]\ncount = 10\n", {"[disks]", "bad.toml:2", "[flocking]"}},
    {"ModelThatIsNotRun", "[flocking]\nnoise = 0.1\n", {"[flocking]", "bad.toml:1", "model.kind"}},
    {"OtherModel", "model.kind = \"flocking\"\n[epidemic]\n", {"[epidemic]", "bad.toml:2", "model.kind"}},
    {"TextForNumber", "[disks]\npacking_fraction = \"dense\"\n", {"packing_fraction", "bad.toml:2:20"}},
    {"NumberForText", "[disks]\nstart = 3\n", {"start", "bad.toml:2"}},
    {"NumberForTrue", "[velocities]\nredraw = 1\n", {"redraw", "bad.toml:2"}},
    {"FractionForCount", "[disks]\ncount = 10.5\n", {"count", "bad.toml:2"}},
    {"ListForNumber", "[disks]\ncount = [1, 2]\n", {"count", "bad.toml:2"}},
    {"NumberForTable", "disks = 3\n", {"disks", "bad.toml:1"}},
    {"NaN", "[disks]\npacking_fraction = nan\n", {"nan", "bad.toml:2"}},
    {"Infinity", "[box]\nside = inf\n", {"inf", "bad.toml:2"}},
    {"NegativeCount", "[disks]\ncount = -5\n", {"-5", "bad.toml:2"}},
    {"NoDisks", "[disks]\ncount = 0\n", {"0", "bad.toml:2", "at least 1"}},
    {"NegativeSide", "[box]\nside = -1.0\n", {"-1", "bad.toml:2"}},
    {"NoSide", "[box]\nside = 0\n", {"side", "bad.toml:2"}},
    {"NegativeRadius", "[disks]\nradius = -0.1\n", {"-0.1", "bad.toml:2"}},
    {"NoPackingFraction", "[disks]\npacking_fraction = 0.0\n", {"packing_fraction", "bad.toml:2"}},
    {"PackingFractionAboveOne", "[disks]\npacking_fraction = 1.2\n", {"1.2", "bad.toml:2"}},
    {"AboveClosestPacking", "[disks]\npacking_fraction = 0.95\n", {"0.95", "0.9069", "bad.toml:2:20"}},
    {"AboveSquarePacking", "[disks]\npacking_fraction = 0.8\n", {"0.8", "0.785398", "bad.toml:2", "triangular"}},
    {"AboveTriangularPacking", "[disks]\nstart = \"triangular\"\npacking_fraction = 0.88\n", {"0.865", "bad.toml:3"}},
    {"AboveRandomPacking",
     "[disks]\ncount = 2000\nstart = \"random\"\npacking_fraction = 0.7\n",
     {"0.547", "bad.toml:4"}},
    {"RadiusLargerThanBox", "[disks]\ncount = 1\nradius = 0.6\n", {"0.6", "bad.toml:3"}},
    {"BothSizes", "[disks]\nradius = 0.01\npacking_fraction = 0.5\n", {"radius", "packing_fraction", "both"}},
    {"FileStartWithoutFile", "[disks]\nstart = \"file\"\n", {"file", "bad.toml:2"}},
    {"EmptyNameOfStartFile", "[disks]\nfile = \"\"\n", {"disks.file is empty", "bad.toml:2:8", "name a file"}},
    {"StepsOfAStage",
     "[[protocol]]\nstage = \"run\"\nsteps = 100\n",
     {"no setting \"steps\" in [protocol[0]]", "bad.toml:3:1", "steps belongs in [run]", "gridlock explain protocol"}},
    {"MissingStartFile", "[disks]\nfile = \"none.xyz\"\n", {"none.xyz"}},
    {"UnknownStart", "[disks]\nstart = \"sqare\"\n", {"sqare", "bad.toml:2", "square"}},
    {"UnknownEdge", "[box]\nedge = \"walls\"\n", {"walls", "bad.toml:2", "wall"}},
    {"UnknownVelocities", "[velocities]\nkind = \"maxwel\"\n", {"maxwel", "bad.toml:2", "maxwell"}},
    {"UnknownContact", "[engine]\ncontact = \"never\"\n", {"never", "bad.toml:2", "approaching"}},
    {"UnknownEngine", "[engine]\nkind = \"steped\"\n", {"steped", "bad.toml:2", "stepped"}},
    {"UnknownEngineAndKeyAtOnce",
     "[engine]\nkind = \"steped\"\nkinds = 3\n[disks]\ncuont = 9\n",
     {"bad.toml:2:8", "did you mean \"stepped\"?", "bad.toml:3:1", "bad.toml:5:1"}},
    {"HugeBox", "[box]\nside = 1e308\n", {"box.side is 1e+308", "bad.toml:2:8", "at most 1e+60"}},
    {"TinyBox", "[box]\nside = 1e-200\n", {"box.side is 1e-200", "bad.toml:2:8", "at least 1e-60"}},
    {"HugeAndTinySides",
     "[box]\nwidth = 1e200\nheight = 1e-200\n",
     {"box.width is 1e+200", "bad.toml:2:9", "box.height is 1e-200", "bad.toml:3:10"}},
    {"ElongatedBox", "[box]\nwidth = 1e20\nheight = 1e-20\n", {"1e+20 × 1e-20", "elongated", "bad.toml:1"}},
    {"HugeRadius", "[disks]\nradius = 1e300\n", {"disks.radius is 1e+300", "bad.toml:2:10"}},
    {"HugeSizeRatio",
     "[[disks.species]]\nfraction = 1\nsize_ratio = 1e300\n",
     {"size_ratio is 1e+300", "bad.toml:3:14"}},
    {"StepOfEndlessLength", "[engine]\nspeed = 1e-308\n", {"engine.speed = 1e-308", "too long", "bad.toml:2:9"}},
    {"SeedBeyondTheProgram", "[run]\nseed = \"1180591620717411303424\"\n", {"2⁶⁴ − 1", "bad.toml:2:8"}},
    {"DecimalComma", "[disks]\npacking_fraction = 0,7\n", {"bad.toml:2:21", "decimal point and no comma"}},
    {"BinaryFile",
     std::string("\x7f"
                 "ELF\x02\x01\x01\x00\x80\xff",
                 10),
     {"bad.toml:1", "right file"}},
    {"VelocitiesFromNoFile", "[velocities]\nkind = \"file\"\n", {"file", "bad.toml:2"}},
    {"NegativeSpeed", "[velocities]\nmax = -2\n", {"-2", "bad.toml:2"}},
    {"NoTimeStep", "[engine]\ntime_step = 0\n", {"time_step", "bad.toml:2"}},
    {"SubstepJumpsOverDisk", "[engine]\ntime_step = 5.0\n", {"jump", "bad.toml:2", "substeps"}},
    {"NoSubsteps", "[engine]\nsubsteps = 0\n", {"substeps", "bad.toml:2"}},
    {"NoCells", "[engine]\ncells = 0\n", {"cells", "bad.toml:2", "at least 1"}},
    {"NegativeCells", "[engine]\ncells = -3\n", {"-3", "bad.toml:2"}},
    {"NoSampling", "[observe]\nevery = 0\n", {"every", "bad.toml:2"}},
    {"EquilibrateForever", "[observe]\ndiscard = 1.5\n", {"1.5", "bad.toml:2"}},
    {"NegativeSeed", "[run]\nseed = -1\n", {"-1", "bad.toml:2"}},
    {"NegativeTime", "[run]\ntime = -1.0\n", {"-1", "bad.toml:2"}},
    {"CollisionsOfDisksAtRest", "[velocities]\nmax = 0\n[run]\ncollisions_per_disk = 5\n", {"collide", "bad.toml:4"}},
    {"SpeedWhoseSquareIsZero", "[velocities]\nmax = 1e-170\n", {"velocities.max is 1e-170", "1e-60", "bad.toml:2:7"}},
    {"SpeedWhoseSquareIsInfinite",
     "[velocities]\nmax = 1e160\n",
     {"velocities.max is 1e+160", "at most 1e+60", "bad.toml:2:7"}},
    {"SpeedsOfLightDisks",
     "[velocities]\nkind = \"maxwell\"\nmax = 1e50\n[[disks.species]]\nfraction = 1\nmass = 1e-50\n",
     {"the largest component of a velocity is ", "1e60"}},
    {"SpeedWhoseSquareIsZeroOfExact",
     "[velocities]\nmax = 1e-170\n[engine]\nkind = \"exact\"\n",
     {"velocities.max is 1e-170", "1e-60", "bad.toml:2:7"}},
    {"DiskThatFillsItsBox",
     "[disks]\ncount = 1\npacking_fraction = 0.7853981633974483\n[engine]\nkind = \"exact\"\n",
     {"disk 0", "two opposite walls", "while no time passes"}},
    {"FractionsBelowOne",
     "[disks]\nspecies = [{fraction = 0.5}, {fraction = 0.2, size_ratio = 1.4}]\n",
     {"0.7", "bad.toml:2", "fraction"}},
    {"SizesAndSpecies",
     "[disks]\nsizes = \"uniform\"\nspecies = [{fraction = 1.0}]\n",
     {"disks.sizes and disks.species", "bad.toml:2"}},
    {"SpreadOfEqualDisks", "[disks]\nsize_spread = 0.2\n", {"equal disks", "bad.toml:2", "inverse_cube"}},
    {"SpreadTooWide",
     "[disks]\nsizes = \"normal\"\nsize_spread = 0.4\npacking_fraction = 0.2\n",
     {"below 0", "bad.toml:3", "0.328"}},
    {"SizesOfAFile", from_file + "sizes = \"normal\"\n", {"disks.sizes are dealt out", "bad.toml:3"}},
    {"HardDisksAtUniformPoints",
     "[disks]\nstart = \"uniform\"\npacking_fraction = 0.86\n",
     {"disks at uniform points overlap", "bad.toml:2", "quench"}},
    {"UnknownSpeciesKey", "[[disks.species]]\nfraction = 1.0\nsize = 2.0\n", {"size", "bad.toml:3", "size_ratio"}},
    {"TooManyDisksForMemory", "[disks]\ncount = 2_000_000_000\n", {"2000000000", "memory"}},
    {"SyntaxError", "[disks]\ncount = = 3\n", {"bad.toml:2"}},
    {"OpenString", "[disks]\nstart = \"square\n", {"bad.toml:2"}},
    {"KeyTwice", "[disks]\ncount = 3\ncount = 4\n", {"count", "bad.toml:3"}},
    {"BytesThatAreNoText", std::string("\xff\xfe\x00\x01", 4), {"bad.toml"}},
    {"TwoMistakesAtOnce", "[disks]\ncuont = 3\n[run]\nsteps = -1\n", {"bad.toml:2", "bad.toml:4"}},
    {"PeriodicBoxSmallerThanDisk",
     "[box]\nedge = \"periodic\"\n[disks]\ncount = 1\nradius = 0.7\n",
     {"0.7", "bad.toml:5"}},
};
INSTANTIATE_TEST_SUITE_P(Settings, BadInput, testing::ValuesIn(mistakes_in_settings),
                         [](auto const& one) { return std::string(one.param.name); });

std::vector<Mistake> const mistakes_on_the_command_line{
    {"NoCommand", "", {"needs a command before --quiet"}, {"--quiet"}},
    {"UnknownCommand", "", {"rnu", "did you mean gridlock run?"}, {"rnu", "bad.toml"}},
    {"OptionBeforeTheCommand", "", {"before the command", "gridlock run -q"}, {"-q", "run", "bad.toml"}},
    {"NoFile", "", {"gridlock run needs FILE"}, {"run"}},
    {"OpposedOptions", "", {"--quiet and --verbose cannot be given together"}, {"run", "bad.toml", "-q", "-v"}},
    {"UnknownFormat", "", {"--to must be one of xyz, vtk, csv, but is foo"}, {"export", "out", "--to", "foo"}},
    {"UnknownOption", "", {"no option --sett", "did you mean --set?"}, {"run", "bad.toml", "--sett", "a=1"}},
    {"NearOption", "", {"no option --ouput", "did you mean --output?"}, {"sweep", "bad.toml", "--ouput", "x"}},
    {"OptionLikeNoOther", "", {"no option --colour", "gridlock run --help"}, {"run", "bad.toml", "--colour", "x"}},
    {"SettingAsOption",
     "",
     {"gridlock run has no option --steps", "--set run.steps=100"},
     {"run", "bad.toml", "--steps", "100"}},
    {"SettingAsOptionWithDash",
     "",
     {"no option --time-step", "--set engine.time_step=0.05"},
     {"check", "bad.toml", "--time-step=0.05"}},
    {"KeyAsOption", "", {"no option --run.seed", "--set run.seed=7"}, {"run", "bad.toml", "--run.seed", "7"}},
    {"SettingAsOptionWithoutValue", "", {"--set run.steps=…"}, {"run", "bad.toml", "--steps", "--json"}},
    {"NearSettingAsOption", "", {"--set engine.threads=2"}, {"check", "bad.toml", "--thread", "2"}},
    {"OptionOfOtherCommands", "", {"no option -j", "--set engine.threads=4"}, {"check", "bad.toml", "-j", "4"}},
    {"SettingAsOptionOfACommandWithoutSettings", "", {"no option --seed", "--help"}, {"resume", "out", "--seed", "5"}},
    {"ExtraWord",
     "",
     {"\"results/x\" is one word too many", "takes FILE only", "-o results/x"},
     {"run", "bad.toml", "results/x"}},
    {"AssignmentWithoutSet", "", {"write --set run.steps=5"}, {"run", "bad.toml", "run.steps=5", "run.seed=3"}},
    {"ExtraWordForACommandWithoutOutput", "", {"\"b\" is one word too many", "PATH"}, {"info", "a", "b"}},
    {"OutputTwice", "", {"--output is given 2 times"}, {"run", "bad.toml", "-o", "a", "-o", "b"}},
    {"OutputMissing", "", {"--output needs a value", "DIR"}, {"run", "bad.toml", "-o"}},
    {"EmptyFile", "", {"FILE must not be empty"}, {"run", "", "-o", "out"}},
    {"EmptyOutput", "", {"--output must not be empty"}, {"run", "bad.toml", "-o", ""}},
    {"EmptyShard",
     "[sweep]\nrun.seed = [1, 2]\n",
     {"--shard must not be empty"},
     {"sweep", "bad.toml", "-o", "out", "--shard", ""}},
    {"TooManyThreads",
     "[sweep]\nrun.seed = [1, 2]\n",
     {"--threads", "from 1 to 4096, but is 5000"},
     {"sweep", "bad.toml", "-j", "5000"}},
    {"NegativeThreads", "", {"--threads", "from 0 to 1024, but is -1"}, {"resume", "out", "-j", "-1"}},
    {"ThreadsBeyondNumbers", "", {"--threads", "from 0 to 1024"}, {"resume", "out", "-j", "99999999999999999999"}},
    {"EveryZeroth", "", {"--every", "at least 1, but is 0"}, {"export", "out", "--to", "xyz", "--every", "0"}},
    {"FlagWithAValue", "", {"--pictures takes no value", "maybe"}, {"run", "bad.toml", "--pictures=maybe"}},
    {"LengthIsAWord", "", {"--time needs a number", "abc"}, {"resume", "out", "--time", "abc"}},
    {"TimeBeyondCounting", "[run]\ntime = 1e300\n", {"bad.toml:2", "no run reaches time 1e+300"}},
    {"CollisionsBeyondCounting", "[run]\ncollisions_per_disk = 1e300\n", {"bad.toml:2", "1e+300 collisions"}},
    {"MissingConfiguration", "", {"none.toml"}, {"run", "none.toml", "-o", "out"}},
    {"ConfigurationIsDirectory", "", {"."}, {"check", "."}},
    {"OutputUnderFile", "", {"file"}, {"run", "bad.toml", "-o", "file/out"}},
    {"OutputIsFile", "", {"file"}, {"run", "bad.toml", "-o", "file"}},
    {"OutputInProc", "", {"/proc"}, {"run", "bad.toml", "-o", "/proc/gridlock"}},
    {"SetWithoutEquals", "", {"run.steps"}, {"run", "bad.toml", "-o", "out", "--set", "run.steps"}},
    {"SetUnknownKey", "", {"run.stepps", "steps"}, {"run", "bad.toml", "-o", "out", "--set", "run.stepps=3"}},
    {"SetFormerKey",
     "",
     {"--set", "observe.discard was renamed to observe.equilibration"},
     {"run", "bad.toml", "-o", "out", "--set", "observe.discard=0.5"}},
    {"SetBadValue", "", {"--set", "-3"}, {"run", "bad.toml", "-o", "out", "--set", "run.steps=-3"}},
    {"SetWithALineBreak",
     "",
     {"--set   run.steps=5…"},
     {"run", "bad.toml", "-o", "out", "--set", "run.steps=5\nrun.seed=3"}},
    {"SetWithoutTable", "", {"steps"}, {"run", "bad.toml", "-o", "out", "--set", "steps=3"}},
    {"RunOfSweep", "[sweep]\nrun.seed = [1, 2]\n", {"sweep"}},
    {"SweepWithoutList", "[disks]\ncount = 9\n", {"[sweep]"}, {"sweep", "bad.toml", "-o", "out"}},
    {"SweepOfNumber", "[sweep]\nrun.seed = 3\n", {"bad.toml:2"}, {"sweep", "bad.toml", "-o", "out"}},
    {"SweepOfNothing", "[sweep]\nrun.seed = []\n", {"bad.toml:2"}, {"sweep", "bad.toml", "-o", "out"}},
    {"SweepOfUnknownKey", "[sweep]\nrun.sed = [1]\n", {"sed", "bad.toml:2"}, {"sweep", "bad.toml", "-o", "out"}},
    {"SweepOfFormerKey",
     "[sweep]\nobserve.discard = [0.1]\n",
     {"bad.toml:2", "observe.discard was renamed to observe.equilibration"},
     {"sweep", "bad.toml", "-o", "out"}},
    {"SweepOfBadValue", "[sweep]\ndisks.count = [9, -4]\n", {"-4", "bad.toml:2"}, {"sweep", "bad.toml", "-o", "out"}},
    {"SweepWhereNothingFits",
     "[sweep]\ndisks.packing_fraction = [0.9, 0.89]\n",
     {"bad.toml:2", "0.785398"},
     {"sweep", "bad.toml", "-o", "out"}},
    {"SweepWithNoThreads", "[sweep]\nrun.seed = [1]\n", {"--threads"}, {"sweep", "bad.toml", "-j", "0"}},
    {"ExplainUnknownKey", "", {"packing_fracton", "packing_fraction"}, {"explain", "disks.packing_fracton"}},
    {"ExplainFormerKey", "", {"renamed to observe.equilibration"}, {"explain", "observe.discard"}},
    {"ExplainFormerColumn", "", {"blocked_share was renamed to halted_fraction"}, {"explain", "blocked_share"}},
    {"ExplainNearColumn", "", {"no column \"mean_sped\"", "did you mean mean_speed?"}, {"explain", "mean_sped"}},
    {"ExplainNeither", "", {"no setting and no column \"colour\"", "explain observables"}, {"explain", "colour"}},
    {"ExplainPartOfNames",
     "",
     {"no column \"correlation\"", "observe.pair_correlation_bins",
      "pair_correlation, stress_autocorrelation, velocity_autocorrelation"},
     {"explain", "correlation"}},
    {"InfoOnNothing", "", {"nowhere"}, {"info", "nowhere"}},
    {"InfoOnOtherFile", "", {"bad.toml"}, {"info", "bad.toml"}},
};
INSTANTIATE_TEST_SUITE_P(CommandLine, BadInput, testing::ValuesIn(mistakes_on_the_command_line),
                         [](auto const& one) { return std::string(one.param.name); });

struct Damage {
  char const* name;
  std::string xyz;
  std::vector<std::string> said;
  std::string toml = from_file;
};

void PrintTo(Damage const& damage, std::ostream* stream) { *stream << damage.name; }

std::string const exactly_from_file = from_file + "[engine]\nkind = \"exact\"\n";

std::string damaged_periodic(std::string const& piece, std::string const& by) {
  std::string text = damaged(piece, by);
  text.replace(text.find("F F F"), 5, "T T F");
  return text;
}

class DamagedStart : public testing::TestWithParam<Damage> {};

TEST_P(DamagedStart, IsRefusedWithPlaceAndHintAndLeavesNothingBehind) {
  Workplace const workplace;
  write(workplace / "bad.toml", GetParam().toml);
  write(workplace / "start.xyz", GetParam().xyz);
  auto const before = contents(workplace.path());
  Outcome const outcome = gridlock::test::gridlock({"run", "bad.toml", "-o", "out"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  EXPECT_NE(outcome.err.find("hint: "), std::string::npos) << outcome.err;
  for (std::string const& words : GetParam().said) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << "missing: " << words << "\nin: " << outcome.err;
  }
  EXPECT_EQ(contents(workplace.path()), before);
}

std::vector<Damage> const damages{
    {"Empty", "", {"start.xyz"}},
    {"NoCount", damaged("2\n", "two\n"), {"start.xyz:1"}},
    {"CountTooLarge", damaged("2\n", "3\n"), {"start.xyz"}},
    {"CountTooSmall", damaged("2\n", "1\n"), {"start.xyz:4"}},
    {"CountBeyondMemory", damaged("2\n", "1000000000000000000\n"), {"start.xyz"}},
    {"NoLattice", damaged("Lattice=", "Latice="), {"start.xyz:2", "Lattice"}},
    {"SlantedLattice", damaged("1 0 0 0 1 0", "1 0.5 0 0 1 0"), {"start.xyz:2"}},
    {"WordForNumber", damaged("0.75", "x.75"), {"start.xyz:4:4", "x.75"}},
    {"NotANumber", damaged("0.75", "nan"), {"start.xyz:4:4"}},
    {"ColumnMissing", damaged(" 0.1 1\nAr 0.75", " 0.1\nAr 0.75"), {"start.xyz:3"}},
    {"IdTwice", damaged("0 1 -0.5", "0 0 -0.5"), {"start.xyz:4"}},
    {"NegativeRadius", damaged("-0.5 0 0 0.1", "-0.5 0 0 -0.1"), {"start.xyz:4"}},
    {"Overlap", damaged("0.75", "0.3"), {"0 and 1", "overlap", "0.15"}},
    {"Outside", damaged("0.75", "0.95"), {"disk 1", "inside"}},
    {"OutsidePeriodicForExact",
     damaged_periodic("0.75", "5.3e12"),
     {"start.xyz:4", "5.3e+12", "boxes outside", "in one unit"},
     exactly_from_file},
    {"MassBeyondSquares", damaged("0.1 1\nAr", "0.1 1.7e308\nAr"), {"disk 0", "mass 1.7e+308", "1e60"}},
    {"AllMoveAlike",
     damaged_periodic("1 -0.5", "1 0.5"),
     {"collide", "bad.toml:4"},
     from_file + "[run]\ncollisions_per_disk = 5\n"},
    {"OneMovesOnAFreeLine",
     damaged("0.75 0.5 0 1 -0.5", "0.75 0.8 0 1 0"),
     {"collide", "bad.toml:4"},
     from_file + "[run]\ncollisions_per_disk = 5\n"},
    {"OtherCount", good_xyz, {"2", "3", "bad.toml:3"}, from_file + "count = 3\n"},
    {"OtherPackingFraction", good_xyz, {"0.5", "bad.toml:3"}, from_file + "packing_fraction = 0.5\n"},
    {"OtherBox", good_xyz, {"bad.toml"}, from_file + "[box]\nside = 2.0\n"},
    {"OtherEdge", good_xyz, {"bad.toml:4"}, from_file + "[box]\nedge = \"periodic\"\n"},
};
INSTANTIATE_TEST_SUITE_P(Start, DamagedStart, testing::ValuesIn(damages),
                         [](auto const& one) { return std::string(one.param.name); });

TEST(BadInput, ResultsThatAreThereAlreadyAreNotTouched) {
  Workplace const workplace;
  write(workplace / "good.toml", "[disks]\ncount = 9\n[run]\nsteps = 10\n");
  std::vector<std::string> const again{"run", "good.toml", "-o", "out", "--no-pictures", "--set", "run.seed=2"};
  ASSERT_EQ(gridlock::test::gridlock({"run", "good.toml", "-o", "out", "--no-pictures"}, workplace.path()).exit_code,
            0);
  std::string const summary = text_of(workplace / "out/summary.json");
  Outcome const refused = gridlock::test::gridlock(again, workplace.path());
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("--overwrite"), std::string::npos) << refused.err;
  EXPECT_EQ(text_of(workplace / "out/summary.json"), summary);
  auto replacing = again;
  replacing.push_back("--overwrite");
  EXPECT_EQ(gridlock::test::gridlock(replacing, workplace.path()).exit_code, 0);
  EXPECT_NE(text_of(workplace / "out/summary.json"), summary);
}

std::string const dense_mixture =
    "box = { edge = \"periodic\", width = 2.0, height = 1.0 }\n"
    "disks.count = 200\n"
    "disks.species = [{ fraction = 0.5 }, { fraction = 0.5, size_ratio = 1.4 }]\n"
    "engine.kind = \"exact\"\n";

TEST(TooDenseStart, IsToldOfTheStageThatReachesItsDensityUnlessNoneDoes) {
  for (char const* start : {"random", "square", "triangular"}) {
    for (auto const& [density, names_it] : std::vector<std::pair<char const*, bool>>{{"0.80", true}, {"0.89", false}}) {
      Workplace const workplace;
      write(workplace / "a.toml",
            dense_mixture + "disks.start = \"" + start + "\"\ndisks.packing_fraction = " + density);
      Outcome const outcome = in(workplace, {"check", "a.toml"});
      EXPECT_EQ(outcome.exit_code, 2) << outcome.out;
      EXPECT_EQ(outcome.err.find("a [[protocol]] with stage = \"grow\", which reaches it") != std::string::npos,
                names_it)
          << start << " " << density << ": " << outcome.err;
    }
  }
}

TEST(TooDenseStart, IsReachedByTheStageOfItsHint) {
  Workplace const workplace;
  write(workplace / "a.toml", dense_mixture +
                                  "disks.start = \"random\"\ndisks.packing_fraction = 0.4\n"
                                  "[[protocol]]\nstage = \"grow\"\nuntil_packing_fraction = 0.80\n");
  Outcome const outcome = in(workplace, {"run", "a.toml", "-o", "out", "--no-pictures"});
  expect_good(outcome);
  std::string const summary = text_of(workplace / "out/summary.json");
  std::string const key = "\"packing_fraction\": ";
  EXPECT_NEAR(std::stod(summary.substr(summary.find(key) + key.size())), 0.80, 1e-12);
}

TEST(TooDenseStart, OfASweepIsToldOnceForAllSeeds) {
  Workplace const workplace;
  write(workplace / "a.toml", dense_mixture +
                                  "disks.start = \"random\"\n[sweep]\ndisks.packing_fraction = [0.5, 0.7, 0.8]\n"
                                  "run.seed = [1, 2, 3]\n");
  Outcome const outcome = in(workplace, {"check", "a.toml"});
  EXPECT_EQ(outcome.exit_code, 2);
  std::string const& said = outcome.err;
  auto const times = [&](std::string const& words) {
    std::size_t count = 0;
    for (std::size_t at = said.find(words); at != std::string::npos; at = said.find(words, at + 1)) ++count;
    return count;
  };
  EXPECT_EQ(times("error: "), 2U) << said;
  EXPECT_EQ(times("; 2 other seeds are refused too"), 2U) << said;
  EXPECT_EQ(times("packing_fraction=0.7_seed=1: "), 1U) << said;
  EXPECT_EQ(times("packing_fraction=0.8_seed=1: "), 1U) << said;
}

TEST(BadInput, TheUndamagedFilesAreGood) {
  Workplace const workplace;
  write(workplace / "good.toml", from_file + "[run]\nsteps = 10\n");
  write(workplace / "start.xyz", good_xyz);
  Outcome const outcome =
      gridlock::test::gridlock({"run", "good.toml", "-o", "out", "--no-pictures"}, workplace.path());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
}

}  // namespace
