#include "gridlock/io/h5md.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "io/file.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

H5mdSettings settings() {
  return {.agents = "ants",
          .configuration = "[run]\nsteps = 3  # Ångström\n",
          .version = "1.2.3",
          .author = "A. Nobody",
          .observables = {{"energy", "mass"}, {"order", ""}},
          .value_names = {{"kind", {"soldier", "Königin"}}, {"mother", {"none"}}}};
}

/// A frame of agents of a kind nobody has, every number of it random.
H5mdFrame random_frame(std::uint64_t step, std::size_t agents, Edge edge_y = Edge::periodic) {
  RandomStream random(7, step, 0, Purpose::start_position);
  Frame frame{
      .box = Box(2.0, 3.0, Edge::periodic, edge_y), .clock = {step, 0.5 * static_cast<double>(step)}, .seed = 11};
  std::vector<double> x, y, heading;
  std::vector<std::int32_t> image_x, image_y;
  std::vector<std::uint32_t> kind;
  std::vector<std::uint64_t> mother;
  for (std::size_t i = 0; i < agents; ++i) {
    frame.ids.push_back((std::uint64_t{step % 3} << 32) + 2 * i);
    x.push_back(static_cast<double>(random.bits()) * 1e-19);
    y.push_back(-static_cast<double>(random.bits()));
    image_x.push_back(static_cast<std::int32_t>(random.bits()));
    image_y.push_back(0);
    heading.push_back(i == 0 ? std::numeric_limits<double>::infinity() : -0.0);
    kind.push_back(static_cast<std::uint32_t>(random.bits()));
    mother.push_back(random.bits());
  }
  frame.columns = {{"x", x},       {"y", y},          {"image_x", image_x}, {"image_y", image_y}, {"heading", heading},
                   {"kind", kind}, {"mother", mother}};
  return {
      .frame = std::move(frame), .observables = {1.5 * static_cast<double>(step), 0.25}, .state_hash = random.bits()};
}

void expect_same(H5mdFrame const& read, H5mdFrame const& written) {
  EXPECT_EQ(read.frame, written.frame);
  EXPECT_EQ(read.observables, written.observables);
  EXPECT_EQ(read.state_hash, written.state_hash);
}

TEST(H5md, GivesBackEveryBitOfEveryFrame) {
  for (std::uint64_t const compression : {0, 1, 9}) {
    TemporaryDirectory const directory;
    H5mdSettings head = settings();
    head.compression = compression;
    std::vector<H5mdFrame> frames;
    Edge const edge_y = compression == 1 ? Edge::wall : Edge::periodic;
    for (std::uint64_t step = 0; step < 70; ++step) frames.push_back(random_frame(step, 70, edge_y));
    H5mdWriter writer = H5mdWriter::create(directory / "t.h5", head, frames[0].frame);
    for (H5mdFrame const& frame : frames) writer.write(frame);
    H5mdReader const reader(directory / "t.h5");
    ASSERT_EQ(reader.frame_count(), frames.size());
    for (std::size_t k = 0; k < frames.size(); ++k) expect_same(reader.frame(k), frames[k]);
  }
}

TEST(H5md, KeepsTheContactsOfTheStart) {
  TemporaryDirectory const directory;
  H5mdFrame const frame = random_frame(3, 5);
  FrameContacts const contacts{
      .clock = frame.frame.clock, .ids = {0, 2, 2, 8, std::uint64_t{1} << 33, 4}, .forces = {0.5, 1e-300, 0.0}};
  for (std::optional<FrameContacts> const& written :
       {std::optional<FrameContacts>(), std::optional(contacts), std::optional(FrameContacts{.clock = {7, 0.25}})}) {
    H5mdSettings head = settings();
    head.contacts = written;
    H5mdWriter writer = H5mdWriter::create(directory / "t.h5", head, frame.frame);
    EXPECT_EQ(H5mdReader(directory / "t.h5").contacts(), written);
    writer.write(frame);
    writer = H5mdWriter::append(directory / "t.h5", frame.frame);
    writer.write(random_frame(4, 6));
    EXPECT_EQ(H5mdReader(directory / "t.h5").contacts(), written);
  }
}

TEST(H5md, KeepsWhatTheTrajectoryIsOf) {
  TemporaryDirectory const directory;
  H5mdWriter const writer = H5mdWriter::create(directory / "t.h5", settings(), random_frame(0, 3).frame);
  H5mdReader const reader(directory / "t.h5");
  EXPECT_EQ(reader.settings().value_names, settings().value_names);
  EXPECT_EQ(reader.settings().agents, "ants");
  EXPECT_EQ(reader.settings().configuration, settings().configuration);
  EXPECT_EQ(reader.settings().version, "1.2.3");
  EXPECT_EQ(reader.settings().author, "A. Nobody");
  ASSERT_EQ(reader.settings().observables.size(), 2U);
  EXPECT_EQ(reader.settings().observables[0].name, "energy");
  EXPECT_EQ(reader.settings().observables[0].unit, "mass");
  EXPECT_EQ(reader.frame_count(), 0U);
}

TEST(H5md, FollowsAPopulationThatGrowsShrinksAndDiesOut) {
  TemporaryDirectory const directory;
  std::vector<std::size_t> const sizes{0, 5, 300, 64, 65, 0, 1, 1000};
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", settings(), random_frame(0, sizes[0]).frame);
  for (std::size_t k = 0; k < sizes.size(); ++k) writer.write(random_frame(k, sizes[k]));
  H5mdReader const reader(directory / "t.h5");
  for (std::size_t k = 0; k < sizes.size(); ++k) expect_same(reader.frame(k), random_frame(k, sizes[k]));
}

TEST(H5md, FramesLargerThanAChunkAreWholeOnAnyNumberOfCores) {
  TemporaryDirectory const directory;
  H5mdFrame const frame = random_frame(1, 140'000);
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", settings(), frame.frame);
  writer.write(frame);
  expect_same(H5mdReader(directory / "t.h5").frame(0), frame);
}

// More chunks than are in memory at a time, and rows that are not in the order of the Ids.
TEST(H5md, AFrameInPiecesIsTheFrameThatItWouldBeAtOnce) {
  TemporaryDirectory const directory;
  RandomStream random(8, 0, 0, Purpose::start_position);
  State state{.box = Box(1.0, 1.0, Edge::periodic), .clock = {3, 0.75}, .seed = 9};
  for (std::size_t k = 0; k < 300'000; ++k) {
    state.agents.add(random.uniform(), random.uniform(), random.normal(), 0.0, 0.01, 1.0, 0,
                     static_cast<std::int32_t>(random.bits()));
  }
  for (Id id = 0; id < 50'000; id += 7) state.agents.remove(id);
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", {}, *frame_source_of(state));
  writer.write(*frame_source_of(state), {}, 5);
  H5mdFrame const read = H5mdReader(directory / "t.h5").frame(0);
  EXPECT_EQ(read.frame, frame_of(state));
  EXPECT_EQ(read.state_hash, 5U);
}

TEST(H5md, GoesOnWhereItStopped) {
  TemporaryDirectory const directory;
  H5mdFrame const first = random_frame(0, 10);
  H5mdWriter::create(directory / "t.h5", settings(), first.frame).write(first);
  H5mdWriter writer = H5mdWriter::append(directory / "t.h5", first.frame);
  EXPECT_EQ(writer.frame_count(), 1U);
  EXPECT_EQ(writer.last_step(), 0U);
  EXPECT_EQ(writer.state_hash_at(0), first.state_hash);
  EXPECT_EQ(writer.state_hash_at(1), std::nullopt);
  writer.write(random_frame(4, 12));
  EXPECT_EQ(writer.state_hash_at(2), std::nullopt) << "a step between two frames";
  EXPECT_EQ(writer.state_hash_at(4), random_frame(4, 12).state_hash);
  H5mdReader const reader(directory / "t.h5");
  expect_same(reader.frame(0), first);
  expect_same(reader.frame(1), random_frame(4, 12));
}

// A kill cuts a write in two where it crosses a page, and what is cut in two loses its checksum.
TEST(H5md, NothingThatIsWrittenAgainInItsPlaceCrossesAPage) {
  TemporaryDirectory const directory;
  H5mdSettings const head = settings();
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", head, random_frame(0, 20).frame);
  for (std::uint64_t step = 0; step < 350; ++step) writer.write(random_frame(step, 20 + step % 9));
  std::string const bytes = read_file(directory / "t.h5");
  // The signatures of HDF5 for object headers, and for the heads and nodes of B-trees and extensible arrays.
  std::map<std::string, std::size_t> const sizes{{"OHDR", 512}, {"BTHD", 512}, {"BTLF", 2048}, {"BTIN", 2048},
                                                 {"EAHD", 512}, {"EAIB", 512}, {"EADB", 2048}};
  for (auto const& [signature, size] : sizes) {
    std::size_t found = 0;
    for (std::size_t at = bytes.find(signature); at != std::string::npos; at = bytes.find(signature, at + 1), ++found) {
      EXPECT_LE(at % 4096 + size, 4096U) << signature << " at " << at;
    }
    EXPECT_GT(found, 3U) << signature;
  }
}

TEST(H5md, RefusesAFrameOfOtherColumns) {
  TemporaryDirectory const directory;
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", settings(), random_frame(0, 5).frame);
  H5mdFrame other = random_frame(0, 5);
  other.frame.columns.pop_back();
  EXPECT_THROW(writer.write(other), RunFailure);
  H5mdFrame walled = random_frame(0, 5);
  walled.frame.box = Box(walled.frame.box.width(), walled.frame.box.height(), Edge::wall);
  EXPECT_THROW(writer.write(walled), RunFailure);
  EXPECT_THROW(H5mdWriter::append(directory / "t.h5", Frame{.columns = {{"smell", std::vector<double>{}}}}), Error);
}

TEST(H5md, SaysWhatCannotBeReadOrWritten) {
  TemporaryDirectory const directory;
  EXPECT_THROW(H5mdReader(directory / "nothing.h5"), Error);
  write_file(directory / "text.h5", "this is no HDF5 file, whatever its name says\n");
  try {
    H5mdReader const reader(directory / "text.h5");
    FAIL();
  } catch (Error const& error) {
    EXPECT_NE(error.problems()[0].what.find("text.h5"), std::string::npos);
    EXPECT_EQ(error.problems()[0].file, (directory / "text.h5").string());
  }
  EXPECT_THROW(H5mdWriter::create(directory / "no" / "t.h5", settings(), random_frame(0, 5).frame), RunFailure);
}

/// Reads all there is; the frames and contacts that come out must be right.
bool is_read_rightly_or_refused(std::filesystem::path const& file, std::vector<H5mdFrame> const& frames,
                                FrameContacts const& contacts) {
  try {
    H5mdReader const reader(file);
    if (reader.contacts() != contacts) return false;
    for (std::size_t k = 0; k < std::min(reader.frame_count(), frames.size()); ++k) {
      H5mdFrame const frame = reader.frame(k);
      if (frame.frame != frames[k].frame || frame.observables != frames[k].observables) return false;
    }
  } catch (Error const&) {
    return true;
  }
  return true;
}

TEST(H5md, DamageIsRefusedAndNeverReadAsSomethingElse) {
  TemporaryDirectory const directory;
  std::vector<H5mdFrame> frames;
  for (std::uint64_t step = 0; step < 3; ++step) frames.push_back(random_frame(step, 40));
  H5mdSettings head = settings();
  head.contacts = {.clock = frames[0].frame.clock, .ids = std::vector<Id>(80, 2), .forces = std::vector(40, 0.25)};
  H5mdWriter writer = H5mdWriter::create(directory / "t.h5", head, frames[0].frame);
  for (H5mdFrame const& frame : frames) writer.write(frame);
  std::string const whole = read_file(directory / "t.h5");
  RandomStream random(20, 0, 0, Purpose::start_position);
  for (int round = 0; round < 120; ++round) {
    std::string damaged = whole;
    if (round % 4 == 0) {
      damaged.resize(random.below(whole.size()));
    } else {
      for (int flip = 0; flip <= round % 5; ++flip)
        damaged[random.below(whole.size())] ^= static_cast<char>(1U << random.below(8));
    }
    std::ofstream(directory / "damaged.h5", std::ios::binary) << damaged;
    EXPECT_TRUE(is_read_rightly_or_refused(directory / "damaged.h5", frames, *head.contacts)) << "round " << round;
  }
}

/// Why the writer refuses to go on with a file; empty where it goes on.
std::string refusal_to_append(std::filesystem::path const& file) {
  try {
    H5mdWriter::append(file, random_frame(0, 5).frame);
  } catch (Error const& error) {
    return error.problems()[0].what;
  }
  return "";
}

std::string refusal_to_read(std::filesystem::path const& file) {
  try {
    H5mdReader const reader(file);
    for (std::size_t k = 0; k < reader.frame_count(); ++k) static_cast<void>(reader.frame(k));
  } catch (Error const& error) {
    return error.problems()[0].what;
  }
  return "";
}

TEST(H5md, CutOffAnywhereItIsRefusedAndLeftAsItIsOrHasLostNoFrame) {
  TemporaryDirectory const directory;
  std::filesystem::path const file = directory / "t.h5";
  std::size_t const frames = 90;
  {
    H5mdWriter writer = H5mdWriter::create(file, settings(), random_frame(0, 40).frame);
    for (std::uint64_t step = 0; step < frames; ++step) writer.write(random_frame(step, 40));
  }
  std::string const whole = read_file(file);
  RandomStream random(21, 0, 0, Purpose::start_position);
  std::vector<std::size_t> lengths{1, 47, 48, 3000, 20'000, whole.size() - 1};
  for (int k = 0; k < 40; ++k) lengths.push_back(1 + random.below(whole.size() - 1));
  for (int k = 0; k < 20; ++k) lengths.push_back(whole.size() - random.below(30'000));
  std::size_t refused = 0;
  for (std::size_t const length : lengths) {
    std::string const cut = whole.substr(0, length);
    write_file(file, cut);
    std::string const refusal = refusal_to_append(file);
    if (refusal.empty()) {
      EXPECT_EQ(H5mdReader(file).frame_count(), frames);
      EXPECT_EQ(refusal_to_read(file), "") << length;
      continue;
    }
    ++refused;
    EXPECT_EQ(read_file(file) == cut, true) << "changed at " << length;
    EXPECT_NE(refusal.find("t.h5: "), std::string::npos) << refusal;
    if (length < 48) continue;  // the head that says how long the file is
    std::string const expected = "it is cut off: " + std::to_string(length) + " of its " + std::to_string(whole.size());
    EXPECT_NE(refusal.find(expected), std::string::npos) << refusal;
    EXPECT_NE(refusal_to_read(file).find(expected), std::string::npos) << length;
  }
  EXPECT_GT(refused, lengths.size() / 2);
}

TEST(H5md, WhatIsNoFileOrEmptyIsRefusedInPlainWords) {
  TemporaryDirectory const directory;
  ASSERT_EQ(mkfifo((directory / "pipe.h5").c_str(), 0600), 0);
  std::filesystem::create_directory(directory / "directory.h5");
  std::filesystem::create_symlink("/dev/zero", directory / "device.h5");
  write_file(directory / "empty.h5", "");
  for (auto const& [name, reason] : {std::pair{"pipe.h5", "it is not a regular file"},
                                     {"directory.h5", "it is a directory"},
                                     {"device.h5", "it is not a regular file"},
                                     {"empty.h5", "it is empty"}}) {
    std::string const expected = "cannot read " + (directory / name).string() + ": " + reason;
    EXPECT_EQ(refusal_to_read(directory / name), expected);
    EXPECT_EQ(refusal_to_append(directory / name), expected);
  }
  EXPECT_EQ(read_file(directory / "empty.h5"), "");
}

}  // namespace
}  // namespace gridlock
