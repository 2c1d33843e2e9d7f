#include "gridlock/io/settings_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/file.hpp"
#include "io/file_format.hpp"
#include "io/settings_reader.hpp"
#include "io/text.hpp"
#include "io/toml_tree.hpp"

namespace gridlock {

namespace {

using Kind = TomlValue::Kind;

/// Largest settings file in bytes. Settings are written by hand, so a larger file is probably another kind of file.
constexpr std::uint64_t largest_settings_file = std::uint64_t{1} << 20;

/// A part of a dotted key: "disks.species[1].mass" has the parts disks, species with index 1, and mass.
struct KeyPart {
  std::string name;
  std::optional<std::size_t> place;
};

std::vector<KeyPart> parts_of(std::string_view key) {
  std::vector<KeyPart> parts;
  while (true) {
    std::size_t const dot = key.find('.');
    std::string_view const word = key.substr(0, dot);
    KeyPart part{.name = std::string(word)};
    std::size_t const bracket = word.find('[');
    if (bracket != std::string_view::npos && word.back() == ']') {
      part.place = parse_number<std::size_t>(word.substr(bracket + 1, word.size() - bracket - 2));
      // Brackets without an index stay part of the name, so that the key is reported as unknown.
      if (part.place) part.name = word.substr(0, bracket);
    }
    parts.push_back(std::move(part));
    if (dot == std::string_view::npos) return parts;
    key.remove_prefix(dot + 1);
  }
}

/// The value at a dotted key, or at the longest part of the key that exists.
struct Found {
  TomlValue const* value = nullptr;
  bool is_whole_key = false;
};

Found follow(TomlValue const& root, std::string_view key) {
  Found found;
  TomlValue const* at = &root;
  for (KeyPart const& part : parts_of(key)) {
    at = at->find(part.name);
    if (at != nullptr) found.value = at;
    if (at != nullptr && part.place) {
      at = at->kind == Kind::array && *part.place < at->items.size() ? &at->items[*part.place] : nullptr;
      if (at != nullptr) found.value = at;
    }
    if (at == nullptr) return found;
  }
  found.is_whole_key = true;
  return found;
}

bool is_usable_key(std::string_view key) {
  if (key.empty()) return false;
  return std::ranges::all_of(parts_of(key), [](KeyPart const& part) {
    return !part.name.empty() &&
           part.name.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") ==
               std::string::npos;
  });
}

constexpr std::string_view lists_of_sweep = "sweep.";

/// Returns whether a key below [sweep] contains an index, as `sweep.protocol[0].step`. A file needs quotes around the
/// part after `sweep`; --set works without them.
bool is_place_in_sweep(std::string_view key) {
  return key.starts_with(lists_of_sweep) && key.find('[') != std::string_view::npos;
}

void set_list_of_place(TomlValue& root, std::string_view key, TomlValue value, SettingLocation const& where) {
  std::string_view name = key.substr(lists_of_sweep.size());
  if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
  TomlValue* sweep = root.find("sweep");
  if (sweep == nullptr) sweep = &root.put("sweep", {.kind = Kind::table, .location = where, .key_location = where});
  if (!sweep->is_table()) {
    throw Error(problem_at(where, std::string(key),
                           fmt::format("{} cannot be set, because sweep is {}, not a table", key, in_words(*sweep)),
                           "write [sweep] and below it lists"));
  }
  sweep->put(name, std::move(value));
}

/// Returns the table at an index of a list. Errors: Error if the list has no table there.
TomlValue& table_at(TomlValue* list, std::string_view key, std::size_t place, SettingLocation const& where) {
  std::size_t const size = list == nullptr || list->kind != Kind::array ? 0 : list->items.size();
  if (place < size && list->items[place].is_table()) return list->items[place];
  throw Error(problem_at(
      where, std::string(key),
      fmt::format("{} cannot be set: the list has {} table{}, counted from 0", key, size, size == 1 ? "" : "s"),
      "set a table that the settings file has"));
}

/// Collects the lists in a table and in the tables that its dotted keys form.
void collect_lists(TomlValue const& table, std::string const& prefix, std::string const& outer,
                   std::vector<SettingList>& lists, std::vector<Problem>& problems) {
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    TomlValue const& member = table.items[i];
    std::string const key = prefix.empty() ? table.names[i] : fmt::format("{}.{}", prefix, table.names[i]);
    auto const report = [&](SettingLocation const& where, std::string what, std::string hint) {
      problems.push_back(problem_at(where, fmt::format("{}.{}", outer, key), std::move(what), std::move(hint)));
    };
    if (member.is_table()) {
      collect_lists(member, key, outer, lists, problems);
    } else if (!is_usable_key(key)) {
      report(member.key_location, fmt::format("{} in [{}] is not a setting", in_quotes(key), outer),
             "write dotted keys, as in disks.packing_fraction = [0.5, 0.6]");
    } else if (member.kind != Kind::array) {
      report(member.location, fmt::format("{} in [{}] is {}, but must be a list", key, outer, in_words(member)),
             fmt::format("write {} = [{}]", key, to_toml(member)));
    } else if (member.items.empty()) {
      report(member.location, fmt::format("{} in [{}] is an empty list", key, outer),
             "list at least one value, or take the line out");
    } else if (std::ranges::find(lists, key, &SettingList::key) != lists.end()) {
      report(member.key_location, fmt::format("{} is given twice in [{}]", key, outer), "join the two lists");
    } else {
      SettingList list{.key = key, .values = {}, .value_locations = {}, .location = member.location};
      for (TomlValue const& item : member.items) {
        list.values.push_back(to_toml(item));
        list.value_locations.push_back(item.location);
      }
      lists.push_back(std::move(list));
    }
  }
}

}  // namespace

struct SettingsFile::Content {
  TomlValue root;
  std::string name;  ///< of the file, for errors; empty if there is no file
  std::filesystem::path directory = ".";
};

SettingsFile::SettingsFile() : content_(std::make_unique<Content>()) {}
SettingsFile::~SettingsFile() = default;
SettingsFile::SettingsFile(SettingsFile const& other) : content_(std::make_unique<Content>(*other.content_)) {}
SettingsFile::SettingsFile(SettingsFile&& other) noexcept = default;
SettingsFile& SettingsFile::operator=(SettingsFile other) noexcept {
  std::swap(content_, other.content_);
  return *this;
}

SettingsFile SettingsFile::from_path(std::filesystem::path const& path) {
  if (auto const format = recognize_format(path)) throw wrong_format(*format, path.string(), "a settings file (TOML)");
  SettingsFile file = from_text(read_file(path, largest_settings_file), path.string());
  if (path.has_parent_path()) file.content_->directory = path.parent_path();
  return file;
}

SettingsFile SettingsFile::from_text(std::string_view text, std::string const& name) {
  SettingsFile file;
  file.content_->root = parse_toml(text, name);
  file.content_->name = name;
  return file;
}

void SettingsFile::set(std::string_view assignment) {
  SettingLocation const where{.file = "--set", .source_line = shown_line(assignment)};
  std::size_t const equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    throw Error(problem_at(where, "", fmt::format("{} sets nothing", in_quotes(assignment)),
                           "write --set key=value, as in --set disks.packing_fraction=0.7"));
  }
  set(trimmed(assignment.substr(0, equals)), trimmed(assignment.substr(equals + 1)), where);
}

void SettingsFile::set(std::string_view key, std::string_view value, SettingLocation const& where) {
  if (is_place_in_sweep(key)) return set_list_of_place(content_->root, key, parse_toml_value(value, where), where);
  if (!is_usable_key(key)) {
    throw Error(problem_at(where, "", fmt::format("{} is not the key of a setting", in_quotes(key)),
                           "write the table, a dot and the setting, as in disks.packing_fraction"));
  }
  TomlValue* table = &content_->root;
  std::string path;
  for (KeyPart const& part : parts_of(key)) {
    if (!path.empty()) path += '.';
    path += part.name;
    if (part.place) {
      path += fmt::format("[{}]", *part.place);
      table = &table_at(table->find(part.name), key, *part.place, where);
      continue;
    }
    if (path.size() == key.size()) {
      TomlValue given = parse_toml_value(value, where);
      table->put(part.name, std::move(given));
      return;
    }
    TomlValue* inner = table->find(part.name);
    if (inner == nullptr) {
      inner = &table->put(part.name, {.kind = Kind::table, .location = where, .key_location = where});
    }
    if (!inner->is_table()) {
      throw Error(
          problem_at(where, std::string(key),
                     fmt::format("{} cannot be set, because {} is {}, not a table", key, path, in_words(*inner)),
                     inner->kind == Kind::array ? fmt::format("set the whole list: {}=[…]", path) : ""));
    }
    table = inner;
  }
  throw Error(problem_at(where, std::string(key), fmt::format("{} is a table, not a setting", key),
                         "name a setting of it, after a dot"));
}

void SettingsFile::leave_out(std::string_view key) {
  TomlValue* table = &content_->root;
  std::vector<KeyPart> const parts = parts_of(key);
  for (std::size_t k = 0; k + 1 < parts.size() && table != nullptr; ++k) table = table->find(parts[k].name);
  if (table == nullptr || !table->is_table()) return;
  auto const found = std::ranges::find(table->names, parts.back().name);
  if (found == table->names.end()) return;
  table->items.erase(table->items.begin() + (found - table->names.begin()));
  table->names.erase(found);
}

std::vector<SettingList> SettingsFile::take_lists(std::string_view table) {
  TomlValue& root = content_->root;
  auto const found = std::ranges::find(root.names, table);
  if (found == root.names.end()) return {};
  auto const place = found - root.names.begin();
  TomlValue const taken = std::move(root.items[static_cast<std::size_t>(place)]);
  root.names.erase(found);
  root.items.erase(root.items.begin() + place);

  std::vector<SettingList> lists;
  std::vector<Problem> problems;
  if (taken.is_table()) {
    collect_lists(taken, "", std::string(table), lists, problems);
  } else {
    problems.push_back(problem_at(taken.location, std::string(table),
                                  fmt::format("{} is {}, but must be a table of lists", table, in_words(taken)),
                                  fmt::format("write [{}] and below it lists, as in run.seed = [1, 2, 3]", table)));
  }
  std::ranges::stable_sort(problems, {},
                           [](Problem const& problem) { return std::pair(problem.line, problem.column); });
  if (!problems.empty()) throw Error(std::move(problems));
  // TOML tables are unordered, so the lists are sorted by line, the order that the user sees.
  std::ranges::stable_sort(lists, {}, [](SettingList const& list) {
    return std::pair(list.location.line == 0, std::pair(list.location.line, list.location.column));
  });
  return lists;
}

void SettingsFile::read_into(Describe const& describe) const {
  SettingsReader reader(content_->root);
  describe(reader);
  std::vector<Problem> problems = reader.problems();
  if (!problems.empty()) throw Error(std::move(problems));
}

bool SettingsFile::is_given(std::string_view key) const { return follow(content_->root, key).is_whole_key; }

std::optional<SettingLocation> SettingsFile::location(std::string_view key) const {
  Found const found = follow(content_->root, key);
  if (found.value == nullptr) return std::nullopt;
  return found.value->location;
}

Error SettingsFile::locate(Error const& error) const {
  std::vector<Problem> problems = error.problems();
  for (Problem& problem : problems) {
    if (problem.key.empty() || !problem.file.empty()) continue;
    auto const where = location(problem.key);
    if (!where) continue;
    problem.file = where->file;
    problem.line = where->line;
    problem.column = where->column;
    problem.source_line = where->source_line;
  }
  return Error(std::move(problems));
}

std::filesystem::path SettingsFile::directory() const { return content_->directory; }

}  // namespace gridlock
