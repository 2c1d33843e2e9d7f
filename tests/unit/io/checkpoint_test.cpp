#include "io/checkpoint.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>

#include "checkpoint_header.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "io/file.hpp"

namespace {

using namespace gridlock;
using gridlock::test::with_header;
namespace fs = std::filesystem;

struct Everything {
  bool flag = true;
  double number = -0.0;
  std::uint64_t count = ~std::uint64_t{0};
  std::string text = "σ, \"quotes\" and a\nnew line";
  std::vector<double> reals{1.0 / 3.0, -0.0, std::numeric_limits<double>::infinity(),
                            std::numeric_limits<double>::denorm_min()};
  std::vector<std::int32_t> integers{-1, 0, std::numeric_limits<std::int32_t>::min()};
  std::vector<std::uint32_t> places{7};
  std::vector<std::uint64_t> ids;

  void serialize(Archive& archive) {
    archive.visit("flag", flag);
    archive.visit("number", number);
    archive.visit("count", count);
    archive.visit("text", text);
    serialize_inside(archive, "lists", [&] {
      archive.visit("reals", reals);
      archive.visit("integers", integers);
      archive.visit("places", places);
      archive.visit("ids", ids);
    });
  }
};

Everything nothing() {
  return {.flag = false, .number = 5.0, .count = 0, .text = "", .reals = {}, .integers = {}, .places = {}, .ids = {1}};
}

SerializeAll serializing(Everything& thing) {
  return [&thing](Archive& archive) { thing.serialize(archive); };
}

std::string message_of(std::function<void()> const& action) {
  try {
    action();
  } catch (Error const& error) {
    return error.what();
  }
  return "";
}

class Directory {
 public:
  Directory() : path_(fs::temp_directory_path() / ("gridlock-checkpoint-" + std::to_string(getpid()))) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Directory() { fs::remove_all(path_); }
  [[nodiscard]] fs::path operator/(char const* name) const { return path_ / name; }
  [[nodiscard]] fs::path const& path() const { return path_; }

 private:
  fs::path path_;
};

TEST(Checkpoint, BringsEveryBitBack) {
  Everything saved;
  saved.number = std::bit_cast<double>(std::uint64_t{0xFFF8'0000'0000'1234});  // a NaN with a payload
  Everything restored = nothing();
  from_checkpoint(to_checkpoint(serializing(saved)), "a", serializing(restored));
  EXPECT_EQ(restored.flag, saved.flag);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(restored.number), std::bit_cast<std::uint64_t>(saved.number));
  EXPECT_EQ(restored.count, saved.count);
  EXPECT_EQ(restored.text, saved.text);
  EXPECT_EQ(restored.reals, saved.reals);
  EXPECT_TRUE(std::signbit(restored.reals[1]));
  EXPECT_EQ(restored.integers, saved.integers);
  EXPECT_EQ(restored.places, saved.places);
  EXPECT_EQ(restored.ids, saved.ids);
}

TEST(Checkpoint, RefusesEveryFlippedBit) {
  Everything saved;
  std::string const good = to_checkpoint(serializing(saved));
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << bit % 8));
    Everything restored = nothing();
    EXPECT_THROW(from_checkpoint(bad, "a", serializing(restored)), Error) << "bit " << bit;
  }
}

TEST(Checkpoint, RefusesEveryBeginningOfItself) {
  Everything saved;
  std::string const good = to_checkpoint(serializing(saved));
  for (std::size_t size = 0; size < good.size(); ++size) {
    Everything restored = nothing();
    EXPECT_THROW(from_checkpoint(good.substr(0, size), "a", serializing(restored)), Error) << size << " bytes";
  }
}

TEST(Checkpoint, OfAnotherFormatIsRefusedSayingSo) {
  Everything saved;
  std::string other = to_checkpoint(serializing(saved));
  other[8] = 1;
  EXPECT_NE(message_of([&] { from_checkpoint(other, "a", serializing(saved)); }).find("format 1"), std::string::npos);
}

TEST(Checkpoint, WithoutAMemberIsRefusedNamingIt) {
  Everything saved;
  std::string const bytes = to_checkpoint(serializing(saved));
  std::string const message = message_of([&] {
    from_checkpoint(bytes, "a", [](Archive& archive) {
      serialize_inside(archive, "lists", [&] {
        std::vector<double> more;
        archive.visit("more", more);
      });
    });
  });
  EXPECT_NE(message.find("lists.more"), std::string::npos) << message;
  std::string const kind = message_of([&] {
    from_checkpoint(bytes, "a", [](Archive& archive) {
      std::vector<double> places;
      serialize_inside(archive, "lists", [&] { archive.visit("places", places); });
    });
  });
  EXPECT_NE(kind.find("another kind"), std::string::npos) << kind;
}

TEST(Checkpoint, ThatHoldsAMemberTwiceIsRefused) {
  std::uint64_t a = 0;
  std::uint64_t b = 0;
  SerializeAll const serialize = [&](Archive& archive) {
    archive.visit("a", a);
    if (!archive.is_restoring()) archive.visit("b", b);
  };
  a = 1, b = 2;
  std::string content = to_checkpoint(serialize).substr(32);
  a = 0;
  from_checkpoint(with_header(content), "once", serialize);
  EXPECT_EQ(a, 1U);
  std::size_t const name = content.find('b');
  ASSERT_NE(name, std::string::npos);
  content[name] = 'a';
  std::string const message = message_of([&] { from_checkpoint(with_header(content), "twice", serialize); });
  EXPECT_NE(message.find("its content cannot be read"), std::string::npos) << message;
  EXPECT_EQ(a, 1U);
}

TEST(Checkpoint, LeavesThePreviousOneAndGoesBackToItSayingSo) {
  Directory const directory;
  Everything first;
  first.count = 1;
  Everything second;
  second.count = 2;
  EXPECT_EQ(restore_checkpoint(directory.path(), serializing(first)), std::nullopt);
  write_checkpoint(directory.path(), serializing(first));
  write_checkpoint(directory.path(), serializing(second));

  Everything restored = nothing();
  auto const newest = restore_checkpoint(directory.path(), serializing(restored));
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->note, "");
  EXPECT_EQ(restored.count, 2U);

  std::string damaged = read_file(directory / "checkpoint.gridlock");
  damaged[damaged.size() / 2] = static_cast<char>(damaged[damaged.size() / 2] ^ 4);
  write_file(directory / "checkpoint.gridlock", damaged);
  auto const previous = restore_checkpoint(directory.path(), serializing(restored));
  ASSERT_TRUE(previous);
  EXPECT_NE(previous->note.find("damaged"), std::string::npos);
  EXPECT_EQ(restored.count, 1U);

  fs::remove(directory / "checkpoint.gridlock");  // as a crash between two renames leaves it
  EXPECT_EQ(restore_checkpoint(directory.path(), serializing(restored))->file.filename(),
            "checkpoint.previous.gridlock");
  write_file(directory / "checkpoint.previous.gridlock", "GRIDLOCK");
  EXPECT_THROW(static_cast<void>(restore_checkpoint(directory.path(), serializing(restored))), Error);
}

TEST(Checkpoint, OfAPopulationGivesTheSameNamesToTheAgentsBornAfterwards) {
  Disks disks;
  for (int i = 0; i < 5; ++i) disks.add(0.1 * i, 0.2, 0, 0, 0.01, 1, 0, 0);
  disks.remove(3);
  disks.remove(0);
  Disks restored;
  from_checkpoint(to_checkpoint([&](Archive& archive) { disks.serialize(archive); }), "a",
                  [&](Archive& archive) { restored.serialize(archive); });
  EXPECT_TRUE(std::ranges::equal(disks.ids(), restored.ids()));
  EXPECT_TRUE(std::ranges::equal(disks.column<X>(), restored.column<X>()));
  EXPECT_FALSE(restored.contains(0));
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(disks.add(0, 0, 0, 0, 0, 1, 0, 0), restored.add(0, 0, 0, 0, 0, 1, 0, 0)) << "birth " << i;
  }
}

}  // namespace
