#pragma once

#include <cctype>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock {

/// The elements of an XML document, read by the rules of well-formedness (XML 1.0, section 2.1), for tests.
///
/// Knows elements, attributes, text, references, comments, the prolog and <!DOCTYPE …>; no CDATA, which nothing here
/// writes. `problem` names the first broken rule and is empty for a well-formed document.
struct MarkupDocument {
  struct Element {
    std::string name;
    std::map<std::string, std::string> attributes;
    std::string text;  ///< directly inside it, references not resolved
  };

  explicit MarkupDocument(std::string_view source) : rest_(source) { read(); }

  /// How many elements have this name.
  [[nodiscard]] std::size_t count(std::string_view name) const { return named(name).size(); }

  [[nodiscard]] std::vector<Element> named(std::string_view name) const {
    std::vector<Element> found;
    for (Element const& element : elements) {
      if (element.name == name) found.push_back(element);
    }
    return found;
  }

  /// The values of one attribute, wherever it stands.
  [[nodiscard]] std::vector<std::string> values_of(std::string const& attribute) const {
    std::vector<std::string> values;
    for (Element const& element : elements) {
      if (auto const found = element.attributes.find(attribute); found != element.attributes.end()) {
        values.push_back(found->second);
      }
    }
    return values;
  }

  std::vector<Element> elements;
  std::string problem;

 private:
  void fail(std::string what) {
    if (problem.empty()) problem = std::move(what) + " before: " + std::string(rest_.substr(0, 60));
  }

  bool skip(std::string_view from, std::string_view to) {
    if (!rest_.starts_with(from)) return false;
    std::size_t const end = rest_.find(to);
    if (end == std::string_view::npos) {
      fail("unfinished " + std::string(from));
      rest_ = {};
    } else {
      rest_.remove_prefix(end + to.size());
    }
    return true;
  }

  void read() {
    while (!rest_.empty() && problem.empty()) {
      if (rest_.front() != '<') {
        read_text();
      } else if (!skip("<?", "?>") && !skip("<!--", "-->") && !skip("<!DOCTYPE", ">")) {
        rest_.starts_with("</") ? read_end() : read_start();
      }
    }
    if (!open_.empty()) fail("unclosed " + elements[open_.back()].name);
    if (elements.empty()) fail("no element");
  }

  void read_text() {
    std::string_view const text = rest_.substr(0, rest_.find('<'));
    check_references(text);
    if (!open_.empty()) {
      elements[open_.back()].text += text;
    } else if (text.find_first_not_of(" \r\n\t") != std::string_view::npos) {
      fail("text outside the root");
    }
    rest_.remove_prefix(text.size());
  }

  void check_references(std::string_view text) {
    for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
      std::size_t const end = text.find(';', at);
      if (end == std::string_view::npos || end - at > 8 || end == at + 1) fail("a bare &");
    }
    for (char const c : text) {
      if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' && c != '\r') fail("a control character");
    }
  }

  std::string read_name() {
    std::size_t length = 0;
    while (length < rest_.size() && (std::isalnum(static_cast<unsigned char>(rest_[length])) != 0 ||
                                     std::string_view("_:-.").find(rest_[length]) != std::string_view::npos)) {
      ++length;
    }
    if (length == 0) fail("no name");
    std::string name(rest_.substr(0, length));
    rest_.remove_prefix(length);
    return name;
  }

  bool skip_space() {
    std::size_t const length = std::min(rest_.find_first_not_of(" \r\n\t"), rest_.size());
    rest_.remove_prefix(length);
    return length > 0;
  }

  void read_end() {
    rest_.remove_prefix(2);
    std::string const name = read_name();
    skip_space();
    if (!rest_.starts_with('>')) return fail("an end tag goes on");
    if (open_.empty() || elements[open_.back()].name != name) return fail("</" + name + "> closes nothing");
    open_.pop_back();
    rest_.remove_prefix(1);
  }

  void read_start() {
    rest_.remove_prefix(1);
    if (open_.empty() && !elements.empty()) return fail("a second root");
    Element element{.name = read_name(), .attributes = {}, .text = {}};
    bool is_separated = skip_space();
    while (problem.empty() && !rest_.empty() && rest_.front() != '>' && rest_.front() != '/') {
      if (!is_separated) fail("no space before an attribute");
      read_attribute(element);
      is_separated = skip_space();
    }
    bool const is_empty = rest_.starts_with("/>");
    if (!is_empty && !rest_.starts_with('>')) return fail("an unfinished tag");
    rest_.remove_prefix(is_empty ? 2 : 1);
    elements.push_back(std::move(element));
    if (!is_empty) open_.push_back(elements.size() - 1);
  }

  void read_attribute(Element& element) {
    std::string const name = read_name();
    skip_space();
    if (!rest_.starts_with('=')) return fail("no value for " + name);
    rest_.remove_prefix(1);
    skip_space();
    char const quote = rest_.empty() ? ' ' : rest_.front();
    std::size_t const end = quote == '"' || quote == '\'' ? rest_.find(quote, 1) : std::string_view::npos;
    if (end == std::string_view::npos) return fail("no quotes around " + name);
    std::string const value(rest_.substr(1, end - 1));
    if (value.find('<') != std::string::npos) fail("< in " + name);
    check_references(value);
    if (!element.attributes.emplace(name, value).second) fail(name + " twice");
    rest_.remove_prefix(end + 1);
  }

  std::string_view rest_;
  std::vector<std::size_t> open_;
};

}  // namespace gridlock
