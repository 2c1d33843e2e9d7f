#include "unit/io/markup_document.hpp"

#include <gtest/gtest.h>

#include <tuple>

namespace gridlock {
namespace {

TEST(MarkupDocument, RefusesWhatIsNotWellFormed) {
  for (char const* const source :
       {"", "<a>", "<a></b>", "</a>", "<a/><b/>", "<a>&</a>", "<a>\x01</a>", "<a b=c/>", "<a b='1' b='2'/>",
        "<a b='<'/>", "<a b='1'c='2'/>", "<a", "<!-- <a/>", "x<a/>", "<a b/>", "<a><b></a></b>"}) {
    EXPECT_NE(MarkupDocument(source).problem, "") << source;
  }
}

TEST(MarkupDocument, ReadsElementsAttributesAndText) {
  MarkupDocument const document("<?xml version='1.0'?><!DOCTYPE a><a id='1'>x&lt;<b id=\"2\"/><!-- > --></a>\n");
  EXPECT_EQ(document.problem, "");
  EXPECT_EQ(document.values_of("id"), (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(document.named("a").at(0).text, "x&lt;");
}

}  // namespace
}  // namespace gridlock
