#include "gridlock/core/error.hpp"

#include <gtest/gtest.h>

namespace gridlock {
namespace {

TEST(Error, ReadsAsTheArchitectureShows) {
  Problem const problem{.what = "packing fraction 0.95 is above the closest packing of equal disks, 0.9069",
                        .hint = "use a value below 0.9069",
                        .key = "disks.packing_fraction",
                        .file = "dense.toml",
                        .line = 7,
                        .column = 20,
                        .source_line = "packing_fraction = 0.95"};
  EXPECT_EQ(to_text(problem),
            "packing fraction 0.95 is above the closest packing of equal disks, 0.9069\n"
            "  --> dense.toml:7:20   packing_fraction = 0.95\n"
            "  hint: use a value below 0.9069");
}

TEST(Error, LeavesOutWhatIsNotKnown) {
  EXPECT_EQ(to_text({.what = "too many disks"}), "too many disks");
  EXPECT_EQ(to_text({.what = "too many disks", .hint = "use fewer"}), "too many disks\n  hint: use fewer");
  EXPECT_EQ(to_text({.what = "w", .file = "f.toml"}), "w\n  --> f.toml");
  EXPECT_EQ(to_text({.what = "w", .file = "f.toml", .line = 3}), "w\n  --> f.toml:3");
  EXPECT_EQ(to_text({.what = "w", .file = "f.toml", .column = 3}), "w\n  --> f.toml")
      << "a column without a line says nothing";
}

TEST(Error, CarriesAndShowsEveryProblemInOrder) {
  Error const error({Problem{.what = "first", .hint = "one"}, Problem{.what = "second"}});
  ASSERT_EQ(error.problems().size(), 2U);
  EXPECT_EQ(error.problems()[1].what, "second");
  EXPECT_STREQ(error.what(), "first\n  hint: one\nsecond");
}

TEST(Error, IsNoRunFailure) {
  // The command line tells bad input (exit code 2) from a failed run (1) by the type alone.
  EXPECT_THROW(throw RunFailure("the disk is full"), RunFailure);
  try {
    throw Error(Problem{.what = "bad"});
  } catch (RunFailure const&) {
    FAIL();
  } catch (Error const& error) {
    EXPECT_STREQ(error.what(), "bad");
  }
}

}  // namespace
}  // namespace gridlock
