#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "program.hpp"

namespace gridlock::test {
namespace {

std::string const source = GRIDLOCK_SOURCE_DIR;

Outcome gridlock_in(Workplace const& workplace, std::vector<std::string> const& arguments) {
  return Process(GRIDLOCK_PROGRAM, arguments, workplace.path()).wait();
}

bool have_readers() {
  return std::system("/usr/bin/python3 -c 'import h5py, MDAnalysis, ase, vtk, matplotlib' 2>/dev/null") == 0;
}

void run_with_frames(Workplace const& workplace) {
  Outcome const outcome = gridlock_in(
      workplace, {"run", source + "/scenes/paper.toml", "--set", "disks.count=100", "--set", "run.steps=60", "--set",
                  "observe.every=20", "--set", "trajectory.every=20", "--no-pictures", "-o", "run"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
}

TEST(Trajectories, AndTheirExportsSayTheSameInMdanalysisAseAndVtk) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace);
  for (char const* format : {"xyz", "vtk", "csv"}) {
    Outcome const outcome = gridlock_in(workplace, {"export", "run", "--to", format});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Outcome const check =
      Process("/usr/bin/python3", {source + "/tests/reference/read_trajectory_files.py", "run", "4"}, workplace.path())
          .wait();
  EXPECT_EQ(check.exit_code, 0) << check.err;
}

TEST(Trajectories, HaveTheContactsOfAPackingAsH5pyReadsThem) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  for (std::vector<std::string> const& arguments : std::vector<std::vector<std::string>>{
           {"run", source + "/scenes/jamming.toml", "--set", "trajectory.every=1", "--no-pictures", "-o", "run"},
           {"contacts", "run/final.xyz", "-o", "contacts", "--no-pictures"}}) {
    Outcome const outcome = gridlock_in(workplace, arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Outcome const check =
      Process("/usr/bin/python3",
              {source + "/tests/reference/read_contacts.py", "run/trajectory.h5", "contacts/contacts.csv"},
              workplace.path())
          .wait();
  EXPECT_EQ(check.exit_code, 0) << check.err;
}

TEST(Trajectories, SayWhatTheyHold) {
  Workplace const workplace;
  run_with_frames(workplace);
  Outcome const outcome = gridlock_in(workplace, {"info", "run/trajectory.h5"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  for (char const* line : {"a trajectory of 4 frames of disks in run/trajectory.h5",
                           "walled box 1 × 1, 100 agents first", "steps 0 to 60", "radius", "mean_displacement"}) {
    EXPECT_NE(outcome.out.find(line), std::string::npos) << outcome.out;
  }
}

/// The number that a line of the output ends with.
double number_after(std::string const& text, std::string const& label) {
  std::size_t const at = text.find(label);
  EXPECT_NE(at, std::string::npos) << label << " is not in\n" << text;
  return at == std::string::npos ? std::nan("") : std::stod(text.substr(at + label.size()));
}

TEST(Trajectories, OfAPeriodicBoxGiveTheNumbersOfTheRunInTheExample) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  Outcome const run = gridlock_in(
      workplace, {"run", source + "/scenes/mixture.toml", "--set", "engine.kind=exact", "--set", "disks.count=200",
                  "--set", "run.steps=400", "--set", "observe.every=40", "--set", "observe.structure_every=1", "--set",
                  "observe.equilibration=0", "--set", "trajectory.every=40", "--no-pictures", "-o", "run"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  Outcome const outcome =
      Process("/usr/bin/python3", {source + "/examples/read_trajectory.py", "run/trajectory.h5"}, workplace.path())
          .wait();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("11 frames from step 0 to 400"), std::string::npos) << outcome.out;
  EXPECT_TRUE(fs::exists(workplace / "run/trajectory_read.png"));
  auto const summary = nlohmann::json::parse(text_of(workplace / "run/summary.json"));
  double const displacement = summary["mean_squared_displacement"]["value"].get<double>();
  // MDAnalysis keeps positions as numbers of 32 bits.
  EXPECT_NEAR(number_after(outcome.out, "mean squared displacement by MDAnalysis:"), displacement, 1e-5 * displacement);
  EXPECT_NEAR(number_after(outcome.out, "mean displacement at the end:"),
              summary["mean_displacement"]["value"].get<double>(), 1e-12);
  double const far = number_after(outcome.out, "g(r) far away by MDAnalysis:");
  EXPECT_NEAR(far, number_after(outcome.out, "g(r) far away by the run:"), 1e-4);
  EXPECT_NEAR(far, 1.0, 0.02);
  EXPECT_NEAR(number_after(outcome.out, "largest g(r) by MDAnalysis:"),
              number_after(outcome.out, "largest g(r) by the run:"), 1e-2);
}

TEST(Trajectories, ThatAreNoneGetOneSentenceFromTheExample) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  Outcome const outcome =
      Process("/usr/bin/python3", {source + "/examples/read_trajectory.py", "."}, workplace.path()).wait();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_EQ(outcome.err, "cannot read . as a trajectory; name the file trajectory.h5 of a run\n");
}

TEST(Trajectories, OfAgentsWithSpeciesAreReadByAse) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  Outcome const run = gridlock_in(workplace, {"run", source + "/scenes/catalyst.toml", "--set", "run.steps=20", "--set",
                                              "trajectory.every=10", "--no-pictures", "-o", "run"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  ASSERT_EQ(gridlock_in(workplace, {"export", "run", "--to", "xyz"}).exit_code, 0);
  write(workplace / "check.py",
        "import ase.io\n"
        "for name in ['run/trajectory.xyz', 'run/final.xyz']:\n"
        "    atoms = ase.io.read(name, index=-1)\n"
        "    assert len(atoms) > 0\n"
        "    kinds = ['AB'[number] for number in atoms.arrays['species_number']]\n"
        "    assert atoms.arrays['type'].tolist() == kinds\n");
  Outcome const check = Process("/usr/bin/python3", {"check.py"}, workplace.path()).wait();
  EXPECT_EQ(check.exit_code, 0) << check.err;
}

TEST(Trajectories, AreNotOverwrittenByTheirOwnExport) {
  Workplace const workplace;
  write(workplace / "run.toml", "disks.count = 9\nrun.steps = 4\ntrajectory.every = 2\n");
  ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", "run", "-q"}).exit_code, 0);
  std::string const before = text_of(workplace / "run/trajectory.h5");
  Outcome const outcome = gridlock_in(workplace, {"export", "run", "--to", "csv", "-o", "run/trajectory.h5"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.err.find("run/trajectory.h5 is read here, and would be replaced"), std::string::npos)
      << outcome.err;
  EXPECT_EQ(text_of(workplace / "run/trajectory.h5"), before);
}

TEST(Trajectories, AreExportedToStandardOutputWhateverThatIs) {
  Workplace const workplace;
  write(workplace / "run.toml", "disks.count = 9\nrun.steps = 4\ntrajectory.every = 2\n");
  ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", "run", "-q"}).exit_code, 0);
  ASSERT_EQ(symlink("/dev/stdout", (workplace / "link.csv").c_str()), 0);
  for (std::string const format : {"csv", "xyz"}) {
    std::string const file = "x." + format;
    ASSERT_EQ(gridlock_in(workplace, {"export", "run", "--to", format, "-o", file}).exit_code, 0);
    for (std::string const name : {"/dev/stdout", "/dev/fd/1", "link.csv"}) {
      // The standard output is a file here.
      Outcome const outcome = gridlock_in(workplace, {"export", "run", "--to", format, "-o", name});
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_EQ(outcome.out, text_of(workplace / file)) << name;
    }
  }
  std::string const export_to_pipe = std::string(GRIDLOCK_PROGRAM) + " export run --to csv -o /dev/stdout | cat";
  EXPECT_EQ(Process("/bin/sh", {"-c", export_to_pipe}, workplace.path()).wait().out, text_of(workplace / "x.csv"));
  std::string const append = "echo before; " + std::string(GRIDLOCK_PROGRAM) + " export run --to csv -o /dev/stdout";
  EXPECT_EQ(Process("/bin/sh", {"-c", append}, workplace.path()).wait().out, "before\n" + text_of(workplace / "x.csv"));
  Outcome const frames = gridlock_in(workplace, {"export", "run", "--to", "vtk", "-o", "/dev/stdout"});
  EXPECT_EQ(frames.exit_code, 2);
  EXPECT_NE(frames.err.find("/dev/stdout takes one file, and VTK is one for each frame"), std::string::npos)
      << frames.err;
}

TEST(Trajectories, AreExportedOverTheirFormerExportsAndOverNoOtherResult) {
  Workplace const workplace;
  write(workplace / "run.toml", "disks.count = 9\nrun.steps = 4\ntrajectory.every = 2\n");
  for (std::string const name : {"run", "other"}) {
    ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", name, "-q"}).exit_code, 0);
  }
  fs::create_symlink("run/final.xyz", workplace / "link.xyz");
  for (auto const& [place, result] : {std::pair<std::string, std::string>{"run/final.xyz", "run/final.xyz"},
                                      {"run/../run/series.csv", "run/series.csv"},
                                      {"other/final.xyz", "other/final.xyz"},
                                      {"link.xyz", "run/final.xyz"}}) {
    std::string const before = text_of(workplace / result);
    Outcome const outcome = gridlock_in(workplace, {"export", "run/trajectory.h5", "--to", "xyz", "-o", place});
    EXPECT_EQ(outcome.exit_code, 2) << place;
    EXPECT_NE(outcome.err.find("is a result that gridlock export must not replace"), std::string::npos) << outcome.err;
    EXPECT_EQ(text_of(workplace / result), before);
  }
  for (std::string const place : {"run/again.csv", "run/again.csv", "elsewhere.csv"}) {
    Outcome const outcome = gridlock_in(workplace, {"export", "run", "--to", "csv", "-o", place});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", "run", "-q", "--overwrite"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(workplace / "run/again.csv"));
}

TEST(Trajectories, ExportedAsVtkAreRemovedByAnOverwriteWithTheirFramesAndNothingElse) {
  Workplace const workplace;
  write(workplace / "run.toml", "disks.count = 9\nrun.steps = 4\ntrajectory.every = 2\n");
  ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", "run", "-q"}).exit_code, 0);
  fs::create_directory(workplace / "run/mixed");
  write(workplace / "run/mixed/step_0000000099.vtp", "mine");
  for (std::string const name : {"run/trajectory.pvd", "run/trajectory.pvd", "run/mixed.pvd", "away.pvd"}) {
    ASSERT_EQ(gridlock_in(workplace, {"export", "run", "--to", "vtk", "-o", name}).exit_code, 0);
  }
  ASSERT_TRUE(fs::exists(workplace / "run/trajectory/step_0000000004.vtp"));
  EXPECT_FALSE(fs::exists(workplace / "away/.gridlock.files"));
  ASSERT_EQ(gridlock_in(workplace, {"run", "run.toml", "-o", "run", "-q", "--overwrite"}).exit_code, 0);
  EXPECT_FALSE(fs::exists(workplace / "run/trajectory"));
  EXPECT_FALSE(fs::exists(workplace / "run/trajectory.pvd"));
  EXPECT_EQ(contents(workplace / "run/mixed"), std::vector<std::string>{"step_0000000099.vtp"});
  EXPECT_TRUE(fs::exists(workplace / "away/step_0000000004.vtp"));
}

TEST(Trajectories, BecomeMoviesInEveryColour) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace);
  for (std::string const colour : {"displacement", "psi6", "speed", "neighbourhood", "radius", "mass"}) {
    Outcome const outcome =
        gridlock_in(workplace, {"movie", "run", "--colour", colour, "--width", "201", "-o", colour + ".mp4"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    std::string const count =
        "test $(ffprobe -v error -count_frames -select_streams v:0 -show_entries "
        "stream=nb_read_frames -of csv=p=0 " +
        (workplace / (colour + ".mp4")).string() + ") = 4";
    EXPECT_EQ(std::system(count.c_str()), 0) << colour;
  }
}

TEST(Trajectories, OfAgentsWithoutARadiusBecomeMoviesByAnyColumn) {
  if (std::system("ffmpeg -version >/dev/null 2>&1") != 0) GTEST_SKIP() << "ffmpeg is not installed: ./dev install";
  Workplace const workplace;
  write(workplace / "walkers.toml",
        "[model]\nkind = \"epidemic\"\n[epidemic]\ncount = 60\nturnover_rate = 0.5\n[run]\nsteps = 30\n"
        "[trajectory]\nevery = 10\n");
  ASSERT_EQ(gridlock_in(workplace, {"run", "walkers.toml", "-o", "run"}).exit_code, 0);
  for (std::string const colour : {"health", "speed", "direction", "velocity_x"}) {
    Outcome const movie =
        gridlock_in(workplace, {"movie", "run", "--colour", colour, "--width", "201", "-o", colour + ".mp4"});
    EXPECT_EQ(movie.exit_code, 0) << movie.err;
  }
}

TEST(Trajectories, ThatAreNoneAreRefusedByName) {
  Workplace const workplace;
  write(workplace / "text.h5", "no trajectory");
  for (char const* name : {"text.h5", "nothing.h5"}) {
    Outcome const outcome = gridlock_in(workplace, {"export", name, "--to", "csv"});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_NE(outcome.err.find(name), std::string::npos) << outcome.err;
  }
}

TEST(Trajectories, ThatLeadToOtherFilesAreRefused) {
  if (!have_readers()) GTEST_SKIP() << "the readers are not installed: ./dev install";
  Workplace const workplace;
  run_with_frames(workplace);
  // Each trap leads to the true numbers, in another file: only a reader that looks where they come from refuses them.
  write(workplace / "craft.py", R"(import shutil, h5py, numpy
other = h5py.File("run/trajectory.h5", "r")
def craft(name, path, replace):
    shutil.copy("run/trajectory.h5", name)
    with h5py.File(name, "r+") as file:
        numbers = file[path][()] if isinstance(file[path], h5py.Dataset) else None
        del file[path]
        replace(file, path, numbers)
def virtual(file, path, numbers):
    layout = h5py.VirtualLayout(shape=numbers.shape, dtype=numbers.dtype)
    layout[...] = h5py.VirtualSource("run/trajectory.h5", path, shape=numbers.shape)
    file.create_virtual_dataset(path, layout)
def external(file, path, numbers):
    numbers.tofile("numbers.raw")
    file.create_dataset(path, numbers.shape, numbers.dtype, external=[("numbers.raw", 0, numbers.nbytes)])
link = h5py.ExternalLink
craft("dataset.h5", "/parameters/seed", lambda f, path, n: f.__setitem__(path, link("run/trajectory.h5", path)))
craft("group.h5", "/particles/disks/box", lambda f, path, n: f.__setitem__(path, link("run/trajectory.h5", path)))
craft("parent.h5", "/observables", lambda f, path, n: f.__setitem__(path, link("run/trajectory.h5", path)))
craft("text.h5", "/parameters/configuration", lambda f, path, n: f.__setitem__(path, link("run/trajectory.h5", path)))
craft("virtual.h5", "/particles/disks/mass/value", virtual)
craft("external.h5", "/parameters/frames/checksum", external)
craft("filter.h5", "/particles/disks/mass/value",
      lambda f, path, n: f.create_dataset(path, data=n, compression="lzf"))
craft("whole.h5", "/particles/disks/mass/value", lambda f, path, n: f.create_dataset(path, data=n))
)");
  Outcome const crafted = Process("/usr/bin/python3", {"craft.py"}, workplace.path()).wait();
  ASSERT_EQ(crafted.exit_code, 0) << crafted.err;
  EXPECT_EQ(gridlock_in(workplace, {"info", "whole.h5"}).exit_code, 0) << "what is replaced by itself is read";
  std::pair<char const*, char const*> const traps[] = {
      {"dataset.h5", "/parameters/seed is a link to another file, run/trajectory.h5"},
      {"group.h5", "/particles/disks/box is a link to another file"},
      {"parent.h5", "/observables is a link to another file"},
      {"text.h5", "/parameters/configuration is a link to another file"},
      {"virtual.h5", "/particles/disks/mass/value has its numbers in other files"},
      {"external.h5", "/parameters/frames/checksum has its numbers in other files"},
      {"filter.h5", "/particles/disks/mass/value is packed by a filter of HDF5 (number 32000)"}};
  for (auto const& [name, message] : traps) {
    Outcome const outcome = gridlock_in(workplace, {"info", name});
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_NE(outcome.err.find(message), std::string::npos) << name << ": " << outcome.err;
  }
}

}  // namespace
}  // namespace gridlock::test
