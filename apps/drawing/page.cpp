#include "drawing/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/markup.hpp"

namespace gridlock {

namespace {

constexpr std::string_view style = R"(
:root { color-scheme: light dark; --ink: #1d2126; --paper: #ffffff; --faint: #5d6672; --line: #d7dbe0; --tint: #f4f6f8;
  --link: #0063a8; --good: #00664a; --good-tint: #d9f2e8; --bad: #a33c00; --bad-tint: #fde6d8; --open: #4d5561;
  --open-tint: #e8ebef; }
@media (prefers-color-scheme: dark) { :root { --ink: #e4e7eb; --paper: #16191d; --faint: #9ba5b1; --line: #363d46;
  --tint: #20252b; --link: #6db8f2; --good: #7fe0bd; --good-tint: #123b2e; --bad: #ffb48a; --bad-tint: #472410;
  --open: #c3cad3; --open-tint: #333a43; } }
* { box-sizing: border-box; }
body { margin: 0 auto; padding: 2.5rem 1.25rem 4rem; max-width: 62rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.55 system-ui, -apple-system, "Segoe UI", "Helvetica Neue", Arial, "Liberation Sans", sans-serif; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.35rem; margin: 2.6rem 0 .6rem; padding-top: 1rem; border-top: 1px solid var(--line); }
h3 { font-size: 1.08rem; margin: 1.8rem 0 .4rem; }
p, li { max-width: 46rem; }
a { color: var(--link); }
.summary { font-size: 1.08rem; color: var(--faint); margin: 0 0 1.2rem; }
nav ol { margin: 0; padding-left: 1.4rem; }
code, pre { font-family: ui-monospace, "SFMono-Regular", Menlo, Consolas, "DejaVu Sans Mono", monospace; font-size: .9em; }
code { background: var(--tint); padding: .1em .3em; border-radius: .25em; }
pre { background: var(--tint); padding: .8rem 1rem; border-radius: .4rem; overflow-x: auto; }
.scroll { overflow-x: auto; margin: 1rem 0; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
caption { caption-side: bottom; text-align: left; color: var(--faint); font-size: .92rem; padding-top: .4rem; }
th, td { padding: .4rem .8rem; text-align: left; vertical-align: top; border-bottom: 1px solid var(--line); }
th { border-bottom: 2px solid var(--ink); vertical-align: bottom; }
.number { text-align: right; white-space: nowrap; }
.wide { font-size: .84rem; }
.wide th, .wide td { padding: .3rem .45rem; }
.wide .number { white-space: normal; }
.verdict { display: inline-block; padding: .05em .6em; border-radius: 1em; font-size: .88em; font-weight: 600;
  white-space: nowrap; }
.agrees { color: var(--good); background: var(--good-tint); }
.differs { color: var(--bad); background: var(--bad-tint); }
.undecided { color: var(--open); background: var(--open-tint); }
figure { margin: 1.4rem 0; }
.pictures { display: flex; flex-wrap: wrap; gap: 1rem; }
.pictures > * { flex: 1 1 20rem; min-width: 0; max-width: 50rem; background: #fff; border-radius: .4rem; padding: .3rem; }
.pictures svg, .pictures img { display: block; width: 100%; height: auto; }
figcaption { color: var(--faint); font-size: .92rem; margin-top: .5rem; max-width: 46rem; }
@media print { body { max-width: none; padding: 0; font-size: 10pt; } .scroll { overflow: visible; }
  table { width: 100%; font-size: 8pt; } .wide { font-size: 7pt; } th, td, .wide th, .wide td { padding: .15rem .25rem; }
  .number, .verdict { white-space: normal; } td, th { overflow-wrap: anywhere; } pre { white-space: pre-wrap; } figure, tr { break-inside: avoid; } h2, h3 { break-after: avoid; } }
)";

/// Whether a link leads to a page or file and cannot run anything, as "javascript:" would.
bool is_plain_link(std::string_view target) {
  std::size_t const colon = target.find(':');
  if (colon == std::string_view::npos || target.find('/') < colon) return true;
  return target.starts_with("http:") || target.starts_with("https:");
}

std::string inline_markup(std::string_view text);

/// The link the text begins with as HTML, taken off the text; empty for none.
std::string take_link(std::string_view& text) {
  std::size_t const middle = text.find("](");
  std::size_t const end = text.find(')', middle == std::string_view::npos ? text.size() : middle);
  if (end == std::string_view::npos || text.find('\n') < end) return {};
  std::string_view const label = text.substr(1, middle - 1);
  std::string_view const target = text.substr(middle + 2, end - middle - 2);
  if (label.empty() || label.find('[') != std::string_view::npos || !is_plain_link(target)) return {};
  text.remove_prefix(end + 1);
  return fmt::format("<a href=\"{}\">{}</a>", escape_markup(target), inline_markup(label));
}

/// The text between two marks at the beginning of the text, both taken off; nothing where the second is missing.
std::optional<std::string_view> take_between(std::string_view& text, std::string_view mark) {
  if (!text.starts_with(mark)) return {};
  std::size_t const end = text.find(mark, mark.size());
  if (end == std::string_view::npos || end == mark.size()) return {};
  std::string_view const inside = text.substr(mark.size(), end - mark.size());
  text.remove_prefix(end + mark.size());
  return inside;
}

/// Text with `code`, **emphasis** and [links](target) as HTML; everything else is kept.
std::string inline_markup(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    std::size_t const plain = std::min(text.find_first_of("`*["), text.size());
    html += escape_markup(text.substr(0, plain));
    text.remove_prefix(plain);
    if (text.empty()) break;
    if (auto const words = take_between(text, "`")) {
      html += fmt::format("<code>{}</code>", escape_markup(*words));
    } else if (auto const strong = take_between(text, "**")) {
      html += fmt::format("<strong>{}</strong>", inline_markup(*strong));
    } else if (std::string const link = text.front() == '[' ? take_link(text) : std::string(); !link.empty()) {
      html += link;
    } else {
      html += escape_markup(text.substr(0, 1));
      text.remove_prefix(1);
    }
  }
  return html;
}

std::string badge(Verdict verdict) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 3> names{
      {{"agrees", "agrees"}, {"differs", "differs"}, {"undecided", "not decided"}}};
  auto const& [name, words] = names[static_cast<std::size_t>(verdict)];
  return fmt::format("<span class=\"verdict {}\">{}</span>", name, words);
}

/// Whether a cell reads as a number, perhaps with an error or unit behind it, or says that there is none.
bool reads_as_number(PageCell const& cell) {
  constexpr std::size_t longest = 32;
  if (cell.verdict || cell.text.size() > longest) return false;
  std::string_view text = cell.text;
  if (text == "–" || text == "—" || text == "-" || text == "nan") return true;
  for (std::string_view const sign : {"≈", "~", "<", ">", " ", "±", "+", "-", "−"}) {
    if (text.starts_with(sign)) text.remove_prefix(sign.size());
  }
  return !text.empty() && text.front() >= '0' && text.front() <= '9';
}

bool holds_numbers(PageTable const& table, std::size_t column) {
  bool has_number = false;
  for (auto const& row : table.rows) {
    if (column >= row.size() || (row[column].text.empty() && !row[column].verdict)) continue;
    if (!reads_as_number(row[column])) return false;
    has_number = true;
  }
  return has_number;
}

std::string cell_html(PageCell const& cell) {
  if (!cell.verdict) return inline_markup(cell.text);
  return badge(*cell.verdict) + (cell.text.empty() ? "" : " " + inline_markup(cell.text));
}

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Gives the ids of one SVG a prefix of their own, wherever a tag defines one or refers to one.
///
/// Ids appear as id="a", href="#a", xlink:href="#a" and url(#a), with either quote. gnuplot names the drawing of a
/// curve and its line in the key alike; the second of the same name gets a number, since a page must not repeat one.
class IdPrefixer {
 public:
  explicit IdPrefixer(std::string_view prefix) : prefix_(prefix) {}

  std::string operator()(std::string_view tag) {
    std::string out;
    while (!tag.empty()) {
      std::size_t const start = length_of_start(tag);
      bool const is_definition = is_space(tag.front());
      out += tag.substr(0, std::max<std::size_t>(start, 1));
      tag.remove_prefix(std::max<std::size_t>(start, 1));
      if (start == 0) continue;
      std::size_t const end = std::min(tag.find_first_of("'\")"), tag.size());
      std::string const id = prefix_ + std::string(tag.substr(0, end));
      out += id;
      if (is_definition && ++uses_[id] > 1) out += fmt::format("--{}", uses_[id]);
      tag.remove_prefix(end);
    }
    return out;
  }

 private:
  /// How many characters stand before the id where the text begins with a definition or reference; 0 if with neither.
  static std::size_t length_of_start(std::string_view text) {
    if (is_space(text.front())) {
      text.remove_prefix(1);
      return text.starts_with("id=\"") || text.starts_with("id='") ? 5 : 0;
    }
    for (std::string_view const start : {"href=\"#", "href='#", "url(#", "url('#", "url(\"#"}) {
      if (text.starts_with(start)) return start.size();
    }
    return 0;
  }

  std::string prefix_;
  std::unordered_map<std::string, int> uses_;
};

/// An SVG document as an element of the page: no prolog, its own ids, a name for those who cannot see it.
std::string svg_element(std::string_view document, std::string_view prefix, std::string_view name) {
  document.remove_prefix(std::min(document.find("<svg"), document.size()));
  std::string element;
  element.reserve(document.size() + document.size() / 16);
  // gnuplot calls every plot "Gnuplot" and every curve "gnuplot_plot_1", which would pop up where the pointer rests.
  constexpr std::string_view plot_name = "<title>Gnuplot";
  constexpr std::string_view curve_name = "<title>gnuplot_plot_";
  constexpr std::string_view name_end = "</title>";
  IdPrefixer prefixed(prefix);
  bool is_root = true;
  while (!document.empty()) {
    std::size_t const open = std::min(document.find('<'), document.size());
    element += document.substr(0, open);
    document.remove_prefix(open);
    std::size_t const close = std::min(document.find('>'), document.size() - 1);
    if (document.empty()) break;
    if (document.starts_with(plot_name) || document.starts_with(curve_name)) {
      document.remove_prefix(std::min(document.find(name_end), document.size() - name_end.size()) + name_end.size());
      continue;
    }
    std::string tag = prefixed(document.substr(0, close + 1));
    if (is_root) tag.insert(4, fmt::format(" role=\"img\" aria-label=\"{}\"", name));
    is_root = false;
    element += tag;
    document.remove_prefix(close + 1);
  }
  return element;
}

std::string image_element(std::string_view type, std::string_view bytes, std::string_view name) {
  return fmt::format("<img src=\"data:image/{};base64,{}\" alt=\"{}\"/>", type, to_base64(bytes), name);
}

}  // namespace

Page::Page(std::string_view title, std::string_view summary) : title_(title), summary_(summary) {}

Page& Page::heading(std::string_view text) {
  headings_.emplace_back(text);
  body_ += fmt::format("<h2 id=\"section-{}\">{}</h2>\n", headings_.size(), inline_markup(text));
  return *this;
}

Page& Page::subheading(std::string_view text) {
  body_ += fmt::format("<h3>{}</h3>\n", inline_markup(text));
  return *this;
}

Page& Page::paragraph(std::string_view text) {
  body_ += fmt::format("<p>{}</p>\n", inline_markup(text));
  return *this;
}

Page& Page::list(std::span<std::string const> items) {
  body_ += "<ul>\n";
  for (std::string const& item : items) body_ += fmt::format("<li>{}</li>\n", inline_markup(item));
  body_ += "</ul>\n";
  return *this;
}

Page& Page::code(std::string_view text) {
  body_ += fmt::format("<pre>{}</pre>\n", escape_markup(text));
  return *this;
}

Page& Page::verdict(Verdict verdict, std::string_view text) {
  body_ += fmt::format("<p>{} {}</p>\n", badge(verdict), inline_markup(text));
  return *this;
}

Page& Page::table(PageTable const& table) {
  std::size_t columns = table.header.size();
  for (auto const& row : table.rows) columns = std::max(columns, row.size());
  std::vector<std::string_view> kinds;
  for (std::size_t c = 0; c < columns; ++c) kinds.push_back(holds_numbers(table, c) ? " class=\"number\"" : "");
  auto out = std::back_inserter(body_);
  // More columns than a screen holds at full size; their cells are smaller and break between words.
  constexpr std::size_t most_columns = 6;
  body_ +=
      columns > most_columns ? "<div class=\"scroll\"><table class=\"wide\">\n" : "<div class=\"scroll\"><table>\n";
  if (!table.caption.empty()) fmt::format_to(out, "<caption>{}</caption>\n", inline_markup(table.caption));
  if (!table.header.empty()) {
    body_ += "<thead><tr>";
    for (std::size_t c = 0; c < columns; ++c) {
      fmt::format_to(out, "<th{}>{}</th>", kinds[c],
                     c < table.header.size() ? inline_markup(table.header[c]) : std::string());
    }
    body_ += "</tr></thead>\n";
  }
  body_ += "<tbody>\n";
  for (auto const& row : table.rows) {
    body_ += "<tr>";
    for (std::size_t c = 0; c < columns; ++c) {
      fmt::format_to(out, "<td{}>{}</td>", kinds[c], c < row.size() ? cell_html(row[c]) : std::string());
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody>\n</table></div>\n";
  return *this;
}

std::string Page::picture(std::filesystem::path const& file, std::string_view caption) {
  std::string const name = escape_markup(one_line(caption));
  if (file.extension() == ".png") return image_element("png", read_file(file), name);
  if (file.extension() != ".svg") {
    throw Error({.what = fmt::format("{}: a page shows .svg and .png files", file.string())});
  }
  std::string const svg = read_file(file);
  if (svg.find("<script") != std::string::npos) return image_element("svg+xml", svg, name);
  return svg_element(svg, fmt::format("picture-{}-", ++pictures_), name);
}

Page& Page::figure(std::filesystem::path const& file, std::string_view caption) {
  return figure(std::span(&file, 1), caption);
}

Page& Page::figure(std::span<std::filesystem::path const> files, std::string_view caption) {
  std::string html = "<figure><div class=\"pictures\">\n";
  for (std::filesystem::path const& file : files) html += fmt::format("<div>{}</div>\n", picture(file, caption));
  html += fmt::format("</div><figcaption>{}</figcaption></figure>\n", inline_markup(caption));
  body_ += html;
  return *this;
}

std::string Page::html() const {
  constexpr std::size_t sections_worth_a_list = 3;
  std::string contents;
  if (headings_.size() >= sections_worth_a_list) {
    contents = "<nav><ol>\n";
    for (std::size_t i = 0; i < headings_.size(); ++i) {
      contents += fmt::format("<li><a href=\"#section-{}\">{}</a></li>\n", i + 1, escape_markup(headings_[i]));
    }
    contents += "</ol></nav>\n";
  }
  std::string const summary =
      summary_.empty() ? std::string() : fmt::format("<p class=\"summary\">{}</p>\n", inline_markup(summary_));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n<title>{}</title>\n"
      "<style>{}</style>\n</head>\n<body>\n<h1>{}</h1>\n{}{}{}</body>\n</html>\n",
      escape_markup(one_line(title_)), style, inline_markup(title_), summary, contents, body_);
}

}  // namespace gridlock
