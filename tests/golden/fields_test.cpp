// The bits of a model with fields, for ever, on 1, 2, 3 and 8 threads. hashes_test.cpp says how to accept others.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "golden/model_scenes.hpp"
#include "golden/table.hpp"
#include "herd.hpp"

namespace gridlock {
namespace {

template <Schedule order>
void expect_golden_herd(std::string const& scene) {
  Box const box(2.0, 1.0, Edge::periodic, Edge::wall);
  Hashes const now = golden::hashes_of(test::Herd<order>{}, box, 60, {.threads = 1});
  for (std::uint64_t const threads : {2, 3, 8}) {
    Hashes const other = golden::hashes_of(test::Herd<order>{}, box, 60, {.threads = threads});
    EXPECT_EQ(other.end, now.end) << threads << " threads";
  }
  HashTable("fields.csv").expect({scene, "herd"}, now);
}

TEST(GoldenFields, OfAHerdThatEatsAndFollowsAScent) {
  expect_golden_herd<Schedule::synchronous>("synchronous");
  expect_golden_herd<Schedule::tiled>("tiled");
  expect_golden_herd<Schedule::sequential>("sequential");
}

}  // namespace
}  // namespace gridlock
