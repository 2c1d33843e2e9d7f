#include "gridlock/core/setting.hpp"

#include <gtest/gtest.h>

#include <array>

namespace gridlock {
namespace {

enum class Colour { red, green, blue };

/// Sees one choice and answers with another.
class Chooser final : public SettingVisitor {
 public:
  explicit Chooser(std::size_t answer) : answer_(answer) {}

  void enter(std::string_view, std::string_view) override {}
  void leave() override {}
  void visit(SettingInfo const&, double&) override {}
  void visit(SettingInfo const&, std::optional<double>&) override {}
  void visit(SettingInfo const&, std::uint64_t&) override {}
  void visit(SettingInfo const&, std::optional<std::uint64_t>&) override {}
  void visit(SettingInfo const&, bool&) override {}
  void visit(SettingInfo const&, std::string&) override {}
  void visit(SettingInfo const&, std::vector<double>&) override {}
  void visit_choice(SettingInfo const&, std::span<std::string_view const> choices, std::size_t& value) override {
    seen = choices[value];
    value = answer_;
  }
  void visit_tables(SettingInfo const&, std::size_t, std::function<void(std::size_t)> const&,
                    std::function<void(std::size_t, SettingVisitor&)> const&) override {}

  std::string_view seen;

 private:
  std::size_t answer_;
};

TEST(SettingVisitor, AnEnumerationIsVisitedAsItsWordAndTakesTheChoiceMade) {
  std::array<std::string_view, 3> const words{"red", "green", "blue"};
  Colour colour = Colour::green;
  Chooser chooser(2);
  visit_enum(chooser, {.key = "colour", .unit = {}, .documentation = "A colour."}, words, colour);
  EXPECT_EQ(chooser.seen, "green");
  EXPECT_EQ(colour, Colour::blue);
}

}  // namespace
}  // namespace gridlock
