#include "io/utf8.hpp"

#include <gtest/gtest.h>

#include <string>

namespace gridlock {
namespace {

TEST(OneLine, KeepsEveryWellFormedCharacterOfAnyLanguage) {
  std::string const text = "φ = 0.70, ⟨Δr⟩, 密堆积, 😀";
  EXPECT_EQ(one_line(text), text);
}

TEST(OneLine, ReplacesBytesThatAreNoUtf8) {
  std::string const mark = "\xEF\xBF\xBD";
  EXPECT_EQ(one_line("a\xFFz"), "a" + mark + "z");                     // never a byte of UTF-8
  EXPECT_EQ(one_line("\xCF"), mark);                                   // cut off
  EXPECT_EQ(one_line("\xC0\xAF"), mark + mark);                        // "/" in too many bytes
  EXPECT_EQ(one_line("\xE0\x80\xAF"), mark + mark + mark);             // the same in three
  EXPECT_EQ(one_line("\xED\xA0\x80"), mark + mark + mark);             // half of a surrogate pair
  EXPECT_EQ(one_line("\xF4\x90\x80\x80"), mark + mark + mark + mark);  // beyond U+10FFFF
  EXPECT_EQ(one_line("\xCF<"), mark + "<");                            // must not swallow what follows
}

TEST(OneLine, TurnsControlCharactersOfTwoBytesIntoSpaces) {
  EXPECT_EQ(one_line("a\xC2\x9B"
                     "31m\xC2\xB0"),
            "a 31m°");
}

TEST(TextLength, EndsWhereTheTextEnds) {
  EXPECT_EQ(text_length(""), 0U);
  EXPECT_EQ(text_length("α\tβ"), 5U);
  EXPECT_EQ(text_length("α\nβ"), 2U);
  EXPECT_EQ(text_length("ab\xC2\x9B"
                        "31m"),
            2U);
  EXPECT_EQ(text_length("ab\xFF"), 2U);
}

TEST(OneLine, TurnsLineBreaksAndControlCharactersIntoSpaces) { EXPECT_EQ(one_line("a\nb\r\tc\x7F"), "a b  c "); }

}  // namespace
}  // namespace gridlock
