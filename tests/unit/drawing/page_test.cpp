#include "drawing/page.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "drawing/picture.hpp"
#include "drawing/plot.hpp"
#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "unit/io/markup_document.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

MarkupDocument read(Page const& page) {
  MarkupDocument document(page.html());
  EXPECT_EQ(document.problem, "");
  return document;
}

/// The HTML a paragraph of this text becomes.
std::string paragraph_html(std::string_view text) {
  std::string const html = Page("t").paragraph(text).html();
  std::size_t const begin = html.find("<p>") + 3;
  return html.substr(begin, html.rfind("</p>") - begin);
}

void expect_unique_ids_and_live_references(MarkupDocument const& document) {
  std::vector<std::string> const ids = document.values_of("id");
  std::set<std::string> const unique(ids.begin(), ids.end());
  EXPECT_EQ(unique.size(), ids.size());
  auto const expect_target = [&](std::string const& id) { EXPECT_TRUE(unique.contains(id)) << id; };
  for (char const* const attribute : {"href", "xlink:href"}) {
    for (std::string const& target : document.values_of(attribute)) {
      if (target.starts_with('#')) expect_target(target.substr(1));
    }
  }
  for (char const* const attribute : {"clip-path", "filter", "fill", "style", "mask"}) {
    for (std::string const& value : document.values_of(attribute)) {
      std::size_t const begin = value.find("url(#");
      if (begin != std::string::npos) expect_target(value.substr(begin + 5, value.find(')') - begin - 5));
    }
  }
}

TEST(Page, EscapesTextEverywhere) {
  std::string const text = "<script>alert(\"R&D\")</script>";
  Page page(text, text);
  std::vector<std::string> const items{text};
  page.heading(text).subheading(text).paragraph(text).list(items).code(text).verdict(Verdict::agrees, text);
  page.heading(text).heading(text);
  page.table({.header = {text}, .rows = {{text}, {{Verdict::differs, text}}}, .caption = text});
  MarkupDocument const document = read(page);
  EXPECT_EQ(document.count("script"), 0U);
  std::string const escaped = "&lt;script&gt;alert(&quot;R&amp;D&quot;)&lt;/script&gt;";
  for (char const* const name : {"title", "h1", "h2", "h3", "li", "pre", "th", "td", "caption"}) {
    ASSERT_GT(document.count(name), 0U) << name;
    EXPECT_NE(document.named(name).back().text.find(escaped), std::string::npos) << name;
  }
  EXPECT_EQ(page.html().find("<script"), std::string::npos);
}

TEST(Page, ReadsCodeEmphasisAndLinksAndNothingElse) {
  EXPECT_EQ(paragraph_html("run `a<b` **now**"), "run <code>a&lt;b</code> <strong>now</strong>");
  EXPECT_EQ(paragraph_html("see [the *data*](fig6.csv)"), "see <a href=\"fig6.csv\">the *data*</a>");
  EXPECT_EQ(paragraph_html("[x](https://a.org/?b=1&c=2)"), "<a href=\"https://a.org/?b=1&amp;c=2\">x</a>");
  EXPECT_EQ(paragraph_html("**`time_step`**"), "<strong><code>time_step</code></strong>");
  for (char const* const plain : {"5 * 3 ** 2", "P*", "a ` b", "[0, 1)", "[a] (b)", "[](x)", "x[i](", "****", "``"}) {
    EXPECT_EQ(paragraph_html(plain), plain);
  }
}

TEST(Page, LinksToNothingThatRuns) {
  EXPECT_EQ(paragraph_html("[x](javascript:alert(1))").find("<a"), std::string::npos);
  EXPECT_EQ(paragraph_html("[x](data:text/html,y)").find("<a"), std::string::npos);
  EXPECT_NE(paragraph_html("[x](plots/a:b.csv)").find("<a"), std::string::npos);
}

TEST(Page, SetsColumnsOfNumbersFlushRight) {
  Page page("t");
  page.table({.header = {"claim", "paper", "measured", "verdict"},
              .rows = {{"3 claims in all, of which this is the longest", "0.5", "0.514 ± 0.003", Verdict::agrees},
                       {"b", "–", "≈ −1.2e-3"},
                       {"c", "", "nan", {Verdict::undecided, "too short"}}}});
  MarkupDocument const document = read(page);
  auto const headers = document.named("th");
  ASSERT_EQ(headers.size(), 4U);
  EXPECT_FALSE(headers[0].attributes.contains("class"));
  EXPECT_EQ(headers[1].attributes.at("class"), "number");
  EXPECT_EQ(headers[2].attributes.at("class"), "number");
  EXPECT_FALSE(headers[3].attributes.contains("class"));
  EXPECT_EQ(document.count("td"), 12U);  // short rows are filled up
}

TEST(Page, SetsTablesOfManyColumnsSmallAndLetsNothingScrollOutOfPrint) {
  PageTable table{.header = {"a", "b", "c", "d", "e", "f"}};
  EXPECT_EQ(Page("t").table(table).html().find("class=\"wide\""), std::string::npos);
  table.header.emplace_back("g");
  std::string const html = Page("t").table(table).html();
  EXPECT_NE(html.find("<table class=\"wide\">"), std::string::npos);
  std::string const print = html.substr(html.find("@media print"));
  EXPECT_NE(print.find(".scroll { overflow: visible; }"), std::string::npos);
}

TEST(Page, ShowsEachVerdictInItsOwnWords) {
  Page page("t");
  for (Verdict const verdict : {Verdict::agrees, Verdict::differs, Verdict::undecided}) page.verdict(verdict, "x");
  std::vector<std::string> words;
  for (auto const& span : read(page).named("span")) words.push_back(span.attributes.at("class") + ": " + span.text);
  EXPECT_EQ(words, (std::vector<std::string>{"verdict agrees: agrees", "verdict differs: differs",
                                             "verdict undecided: not decided"}));
}

TEST(Page, ListsItsSectionsWhenThereAreThree) {
  Page page("t");
  page.heading("one").heading("two");
  EXPECT_EQ(read(page).count("nav"), 0U);
  page.heading("`three`");
  MarkupDocument const document = read(page);
  EXPECT_EQ(document.count("nav"), 1U);
  EXPECT_EQ(document.values_of("href"), (std::vector<std::string>{"#section-1", "#section-2", "#section-3"}));
  expect_unique_ids_and_live_references(document);
}

TEST(Page, HoldsPicturesFromGnuplotAndOfDisksWithEveryIdUnique) {
  TemporaryDirectory const directory;
  write_file(directory / "series.csv", "x,y,error\n0,1,0.1\n1,2,0.1\n");
  PlotCurve const curve{.label = "c",
                        .file = "series.csv",
                        .x = "x",
                        .y = "y",
                        .error = "error",
                        .where = {},
                        .style = PlotStyle::line_and_points};
  std::vector<Plot> const plots{{.name = "a", .curves = {curve, curve}}, {.name = "b", .curves = {curve}}};
  ASSERT_EQ(draw_plots(plots, directory.path()), PlotOutcome::drawn);
  State state;
  state.agents.add(0.5, 0.5, 0, 0, 0.1, 1, 0, 0);
  draw_disks(state, {}, directory / "disks.svg");
  std::vector<std::filesystem::path> const files{directory / "a.svg", directory / "b.svg", directory / "disks.svg",
                                                 directory / "a.svg"};
  Page page("t");
  page.figure(files, "four").figure(files.back(), "and \"one\" <more>");
  MarkupDocument const document = read(page);
  EXPECT_EQ(document.count("svg"), 5U);
  EXPECT_EQ(document.count("figure"), 2U);
  EXPECT_EQ(document.count("figcaption"), 2U);
  EXPECT_GT(document.count("use"), 0U);
  EXPECT_EQ(document.named("svg").back().attributes.at("aria-label"), "and &quot;one&quot; &lt;more&gt;");
  expect_unique_ids_and_live_references(document);
  // Nothing but the name of a curve pops up over a plot, and no prolog is in the middle of the page.
  for (auto const& title : document.named("title")) EXPECT_TRUE(title.text == "t" || title.text == "c") << title.text;
  EXPECT_EQ(page.html().find("<?xml"), std::string::npos);
}

TEST(Page, KeepsReferencesOfEveryFormAlive) {
  TemporaryDirectory const directory;
  write_file(directory / "a.svg",
             "<?xml version='1.0'?>\n<svg xmlns='http://www.w3.org/2000/svg' id='root'>\n"
             "<g id=\"glyph-0-0\"/><g\n id='mask'/><use xlink:href='#glyph-0-0'/><use href=\"#glyph-0-0\"/>"
             "<rect fill=\"url(#mask)\" style=\"mask: url('#mask')\" data-id=\"mine\"/><text>url(#mask) id=\"x\"</text>"
             "<a href='https://example.org/#mask'/></svg>");
  Page page("t");
  page.figure(directory / "a.svg", "x").figure(directory / "a.svg", "y");
  MarkupDocument const document = read(page);
  expect_unique_ids_and_live_references(document);
  EXPECT_EQ(document.values_of("id").size(), 6U);
  EXPECT_EQ(document.named("rect").at(0).attributes.at("style"), "mask: url('#picture-1-mask')");
  EXPECT_EQ(document.named("rect").at(0).attributes.at("data-id"), "mine");
  EXPECT_EQ(document.named("text").at(0).text, "url(#mask) id=\"x\"");
  EXPECT_EQ(document.named("a").at(0).attributes.at("href"), "https://example.org/#mask");
}

TEST(Page, HoldsAPngAsData) {
  TemporaryDirectory const directory;
  State state;
  draw_disks(state, {.width = 32}, directory / "a.png");
  auto const images = read(Page("t").figure(directory / "a.png", "x")).named("img");
  ASSERT_EQ(images.size(), 1U);
  EXPECT_TRUE(images[0].attributes.at("src").starts_with("data:image/png;base64,iVBORw0KGgo"));
}

TEST(Page, FetchesAndRunsNothing) {
  TemporaryDirectory const directory;
  write_file(directory / "a.svg", "<svg xmlns='http://www.w3.org/2000/svg'><script>x</script></svg>");
  MarkupDocument const document = read(Page("t").figure(directory / "a.svg", "x"));
  for (char const* const name : {"script", "link", "iframe", "object"}) EXPECT_EQ(document.count(name), 0U) << name;
  for (std::string const& source : document.values_of("src")) EXPECT_TRUE(source.starts_with("data:"));
  EXPECT_EQ(document.named("style").at(0).text.find("url("), std::string::npos);
  EXPECT_EQ(document.named("style").at(0).text.find("@import"), std::string::npos);
}

TEST(Page, RefusesAFigureItCannotShow) {
  TemporaryDirectory const directory;
  write_file(directory / "a.gif", "GIF89a");
  Page page("t");
  EXPECT_THROW(page.figure(directory / "a.gif", "x"), Error);
  EXPECT_THROW(page.figure(directory / "missing.svg", "x"), Error);
  EXPECT_EQ(read(page).count("figure"), 0U);
}

TEST(Page, SurvivesSvgFilesThatAreDamaged) {
  TemporaryDirectory const directory;
  std::string const whole = "<svg id='a'><g id=\"b\" fill=\"url(#b)\"/><use href='#b'/></svg>";
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    write_file(directory / "a.svg", whole.substr(0, length));
    EXPECT_NE(Page("t").figure(directory / "a.svg", "x").html().find("</html>"), std::string::npos) << length;
  }
}

}  // namespace
}  // namespace gridlock
