#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock {

/// What a comparison came to.
enum class Verdict { agrees, differs, undecided };

/// One cell of a table: text, or a verdict as a coloured badge, whose text is then a remark beside it.
struct PageCell {
  PageCell(char const* words) : text(words) {}             // NOLINT: a table reads as a list of its entries
  PageCell(std::string words) : text(std::move(words)) {}  // NOLINT
  PageCell(Verdict v, std::string remark = {}) : text(std::move(remark)), verdict(v) {}  // NOLINT

  std::string text;
  std::optional<Verdict> verdict;
};

/// A table of a page. Columns of numbers are set flush right.
struct PageTable {
  std::vector<std::string> header;
  std::vector<std::vector<PageCell>> rows;  ///< shorter rows end in empty cells
  std::string caption;
};

/// A report as one HTML file that needs nothing beside it: style and pictures are inside, no script, nothing is
/// fetched. It reads well on light and dark screens and on paper.
///
/// All text is plain and may hold any character; `code` in backquotes, **emphasis** and [links](page.html) are the only
/// markup. Parts appear in the order they are added.
class Page {
 public:
  /// `summary` is below the title.
  explicit Page(std::string_view title, std::string_view summary = {});

  /// Opens a section; with three sections or more the page begins with a list of them.
  Page& heading(std::string_view text);
  Page& subheading(std::string_view text);
  Page& paragraph(std::string_view text);
  Page& list(std::span<std::string const> items);
  /// Text as it is, such as commands.
  Page& code(std::string_view text);
  Page& verdict(Verdict verdict, std::string_view text);
  Page& table(PageTable const& table);

  /// A picture from a .svg or .png file with a caption; several stand side by side.
  ///
  /// The ids inside an SVG are made unique within the page, so that two plots may use the same ones; an SVG that holds
  /// a script goes in as an image, which runs none.
  /// Errors: Error where the file cannot be read or has another extension.
  Page& figure(std::filesystem::path const& file, std::string_view caption);
  Page& figure(std::span<std::filesystem::path const> files, std::string_view caption);

  /// The whole document.
  [[nodiscard]] std::string html() const;

 private:
  std::string picture(std::filesystem::path const& file, std::string_view caption);

  std::string title_;
  std::string summary_;
  std::string body_;
  std::vector<std::string> headings_;
  std::size_t pictures_ = 0;
};

}  // namespace gridlock
