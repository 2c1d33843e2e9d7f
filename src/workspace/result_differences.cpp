#include "workspace/result_differences.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "gridlock/core/world.hpp"
#include "io/file.hpp"
#include "workspace/summary.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::ordered_json;

std::string name_of(std::filesystem::path const& file) { return file.filename().string(); }

bool is_same(double one, double other) { return is_same_number(one, other); }

bool is_same(std::string const& one, std::string const& other) { return one == other; }

/// Returns the first row in which two columns of equal length differ. Counts are compared as numbers, since a column of
/// numbers that are whole is read as one of counts.
std::optional<std::size_t> first_other_row(Table const& one, Table const& other, std::string const& name) {
  auto const first_of = [](auto const& a, auto const& b) -> std::optional<std::size_t> {
    for (std::size_t row = 0; row < a.size(); ++row) {
      if (!is_same(a[row], b[row])) return row;
    }
    return std::nullopt;
  };
  auto const* const words = std::get_if<std::vector<std::string>>(&one.column(name));
  auto const* const others = std::get_if<std::vector<std::string>>(&other.column(name));
  if (words != nullptr && others != nullptr) return first_of(*words, *others);
  if (words != nullptr || others != nullptr) return 0;
  return first_of(one.numbers(name), other.numbers(name));
}

std::string cell_text(Table const& table, std::string const& name, std::size_t row) {
  return std::visit([&](auto const& values) { return fmt::format("{}", values[row]); }, table.column(name));
}

/// Returns the word of a line around a place, and no more of it than fits into a message.
std::string_view word_at(std::string_view text, std::size_t place) {
  constexpr std::size_t longest = 40;
  constexpr std::string_view separators = " \n";
  std::size_t const before = place == 0 ? std::string_view::npos : text.find_last_of(separators, place - 1);
  std::size_t const first = before == std::string_view::npos ? 0 : before + 1;
  std::size_t const end = std::min(text.find_first_of(separators, place), text.size());
  return text.substr(first, std::min(end - first, longest));
}

/// Returns the entries of a summary that a replay repeats, by their paths: "mean_displacement/value".
Json repeatable_entries(Json json) {
  for (char const* const name : {"gridlock", "timing", "notes"}) json.erase(name);
  return json.flatten();
}

}  // namespace

bool is_same_number(double one, double other) {
  return (std::isnan(one) && std::isnan(other)) || word_of(one) == word_of(other);
}

std::string difference_of_table(std::filesystem::path const& file, Table const& replay) {
  Table const recorded = read_csv(file);
  Table const present = parse_csv(to_csv(replay), name_of(file));
  if (recorded.row_count() != present.row_count()) {
    return fmt::format("{} has {} rows, where the replay has {}", name_of(file), recorded.row_count(),
                       present.row_count());
  }
  for (std::string const& name : present.names()) {
    if (!recorded.contains(name)) return fmt::format("{} has no column {}, which the replay has", name_of(file), name);
    std::optional<std::size_t> const row = first_other_row(recorded, present, name);
    if (!row) continue;
    return fmt::format("{} has {} = {} in row {}, where the replay has {}", name_of(file), name,
                       cell_text(recorded, name, *row), *row + 1, cell_text(present, name, *row));
  }
  return "";
}

std::string difference_of_summary(std::filesystem::path const& file, std::string const& replay) {
  Json const recorded = repeatable_entries(read_summary_json(file));
  Json const present = repeatable_entries(Json::parse(replay));
  for (auto const& [path, value] : present.items()) {
    auto const found = recorded.find(path);
    if (found != recorded.end() && *found == value) continue;
    return fmt::format("{} has {} = {}, where the replay has {}", name_of(file), path.substr(1),
                       found == recorded.end() ? "nothing" : found->dump(), value.dump());
  }
  return "";
}

std::string difference_of_text(std::filesystem::path const& file, std::string const& replay) {
  std::string const recorded = read_file(file, std::numeric_limits<std::uint64_t>::max());
  auto const [at, other] = std::ranges::mismatch(recorded, replay);
  if (at == recorded.end() && other == replay.end()) return "";
  if (recorded.empty()) return name_of(file) + " is empty";
  auto const place = static_cast<std::size_t>(at - recorded.begin());
  return fmt::format("{}, line {}, has \"{}\", where the replay has \"{}\"", name_of(file),
                     1 + std::count(recorded.begin(), at, '\n'), word_at(recorded, place), word_at(replay, place));
}

std::string difference_of_fields(std::span<Field const> recorded, std::span<Field const> replay) {
  for (Field const& present : replay) {
    auto const found = std::ranges::find(recorded, present.name(), &Field::name);
    if (found == recorded.end() || found->columns() != present.columns() || found->rows() != present.rows()) {
      return fmt::format("no field {} of {} × {} cells, which the replay has", present.name(), present.columns(),
                         present.rows());
    }
    for (std::size_t cell = 0; cell < present.size(); ++cell) {
      double const before = found->values()[cell];
      if (is_same_number(before, present.values()[cell])) continue;
      return fmt::format("{} = {} in row {}, column {}, where the replay has {}", present.name(), before,
                         cell / present.columns(), cell % present.columns(), present.values()[cell]);
    }
  }
  return "";
}

std::string difference_of_networks(std::span<Network const> recorded, std::span<Network const> replay) {
  for (Network const& present : replay) {
    auto const found = std::ranges::find(recorded, present.name(), &Network::name);
    if (found == recorded.end() || found->is_directed() != present.is_directed()) {
      return fmt::format("no {} network {}, which the replay has", present.is_directed() ? "directed" : "undirected",
                         present.name());
    }
    auto const [one, other] = std::ranges::mismatch(found->edges(), present.edges());
    if (one == found->edges().end() && other == present.edges().end()) continue;
    auto const edge_text = [](auto const& edge, auto const& end) {
      return edge == end
                 ? std::string("no more edge")
                 : fmt::format("an edge of agents {} and {} with the weight {}", edge->from, edge->to, edge->weight);
    };
    return fmt::format("{} in the network {}, where the replay has {}", edge_text(one, found->edges().end()),
                       present.name(), edge_text(other, present.edges().end()));
  }
  return "";
}

}  // namespace gridlock
