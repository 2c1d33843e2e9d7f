#include "io/markup.hpp"

#include <gtest/gtest.h>

#include <string>

namespace gridlock {
namespace {

TEST(EscapeMarkup, ReplacesEveryCharacterThatIsMarkup) {
  EXPECT_EQ(escape_markup("<a href=\"x\">'R&D'</a>"), "&lt;a href=&quot;x&quot;&gt;&#39;R&amp;D&#39;&lt;/a&gt;");
}

TEST(EscapeMarkup, KeepsEveryWellFormedCharacterOfAnyLanguage) {
  std::string const text = "φ = 0.70, ⟨Δr⟩, 密堆积, 😀\tx\ny";
  EXPECT_EQ(escape_markup(text), text);
}

TEST(EscapeMarkup, DropsControlCharactersThatNoDocumentMayHold) {
  EXPECT_EQ(escape_markup(std::string("a\0b\x01\x1B[1mc\x7F", 9)), "ab[1mc");
}

TEST(EscapeMarkup, ReplacesBytesThatAreNoUtf8) {
  std::string const mark = "\xEF\xBF\xBD";
  EXPECT_EQ(escape_markup("a\xFFz"), "a" + mark + "z");                     // never a byte of UTF-8
  EXPECT_EQ(escape_markup("\xCF"), mark);                                   // cut off
  EXPECT_EQ(escape_markup("\xC0\xAF"), mark + mark);                        // "/" in too many bytes
  EXPECT_EQ(escape_markup("\xE0\x80\xAF"), mark + mark + mark);             // the same in three
  EXPECT_EQ(escape_markup("\xED\xA0\x80"), mark + mark + mark);             // half of a surrogate pair
  EXPECT_EQ(escape_markup("\xF4\x90\x80\x80"), mark + mark + mark + mark);  // beyond U+10FFFF
  EXPECT_EQ(escape_markup("\xCF<"), mark + "&lt;");                         // must not swallow what follows
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

TEST(ToBase64, GivesTheExamplesOfTheStandard) {
  // RFC 4648, section 10.
  EXPECT_EQ(to_base64(""), "");
  EXPECT_EQ(to_base64("f"), "Zg==");
  EXPECT_EQ(to_base64("fo"), "Zm8=");
  EXPECT_EQ(to_base64("foo"), "Zm9v");
  EXPECT_EQ(to_base64("foob"), "Zm9vYg==");
  EXPECT_EQ(to_base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(to_base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(to_base64("\xFF\xFE\xFB"), "//77");
}

}  // namespace
}  // namespace gridlock
