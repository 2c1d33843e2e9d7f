#include "io/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "gridlock/core/error.hpp"
#include "gridlock/parallel/detail/row_division.hpp"
#include "io/checkpoint_file.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;
using FileKind = checkpoint::File::Kind;

constexpr char const* newest_name = "checkpoint.gridlock";
constexpr char const* previous_name = "checkpoint.previous.gridlock";
constexpr std::string_view part_prefix = "checkpoint.part.";
constexpr std::string_view part_suffix = ".gridlock";

/// The member with the list of parts: the checksum of each part, as numbers of 64 bits.
constexpr char const* parts_member = "parts";
constexpr std::size_t numbers_per_part = 2;

char in_parts(char letter) { return static_cast<char>(std::toupper(static_cast<unsigned char>(letter))); }

std::string name_of_part(std::size_t number, CheckpointPart const& part) {
  return fmt::format("{}{}.{:016x}{:016x}{}", part_prefix, number, part.checksum[1], part.checksum[0], part_suffix);
}

/// Returns whether a file is a part: checkpoint.part.NUMBER.CHECKSUM.gridlock with 32 hexadecimal digits. Files of
/// users with other names must not be removed.
bool is_name_of_part(std::string_view name) {
  if (!name.starts_with(part_prefix) || !name.ends_with(part_suffix)) return false;
  name = name.substr(part_prefix.size(), name.size() - part_prefix.size() - part_suffix.size());
  std::size_t const point = name.find('.');
  if (point == 0 || point == std::string_view::npos) return false;
  std::string_view const checksum = name.substr(point + 1);
  constexpr std::string_view digits = "0123456789";
  constexpr std::string_view hexadecimal = "0123456789abcdef";
  return name.substr(0, point).find_first_not_of(digits) == std::string_view::npos && checksum.size() == 32 &&
         checksum.find_first_not_of(hexadecimal) == std::string_view::npos;
}

/// Gives each member the path to it as its name ("disks.x"), so that the file is one flat map.
class NamedArchive : public Archive {
 public:
  void enter(std::string_view name) override { path_.push_back(full(name)); }
  void leave() override { path_.pop_back(); }

 protected:
  [[nodiscard]] std::string full(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_.back(), name);
  }

 private:
  std::vector<std::string> path_;
};

/// Selects the members of an object that go into a file.
enum class Saved { everything, rows, all_but_rows };

class SavingArchive final : public NamedArchive {
 public:
  /// `parts` lists the files with the rows of all processes, for Saved::all_but_rows; empty otherwise.
  explicit SavingArchive(Saved saved, std::span<CheckpointPart const> parts = {}) : saved_(saved), parts_(parts) {}

  [[nodiscard]] checkpoint::Members& members() { return members_; }
  /// Lengths of the lists of rows, in the order in which they were visited.
  [[nodiscard]] std::vector<std::uint64_t> const& lengths() const { return lengths_; }
  [[nodiscard]] bool is_restoring() const override { return false; }
  void visit(std::string_view name, bool& value) override { save(name, value); }
  /// Saves the 64 bits of a number, since CBOR keeps only one kind of NaN.
  void visit(std::string_view name, double& value) override { save(name, std::bit_cast<std::uint64_t>(value)); }
  void visit(std::string_view name, std::uint64_t& value) override { save(name, value); }
  void visit(std::string_view name, std::string& value) override { save(name, value); }
  void visit(std::string_view name, std::vector<double>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::int32_t>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::uint32_t>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::uint64_t>& values) override { save_list(name, values); }
  void visit_rows(std::string_view name, std::vector<double>& values) override { save_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::int32_t>& values) override { save_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::uint32_t>& values) override { save_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::uint64_t>& values) override { save_rows(name, values); }

 private:
  template <class Value>
  void save(std::string_view name, Value const& value) {
    if (saved_ != Saved::rows) members_.add(full(name), value);
  }
  template <class Number>
  void save_list(std::string_view name, std::vector<Number> const& values) {
    if (saved_ != Saved::rows) members_.add_list(full(name), values);
  }
  template <class Number>
  void save_rows(std::string_view name, std::vector<Number> const& values) {
    lengths_.push_back(values.size());
    if (saved_ == Saved::all_but_rows) {
      std::vector<std::uint64_t> of_parts;
      for (CheckpointPart const& part : parts_) {
        of_parts.push_back(part.lengths.at(lengths_.size() - 1));
      }
      members_.add_bytes(full(name), in_parts(checkpoint::letter_of<Number>()), std::as_bytes(std::span(of_parts)));
    } else {
      members_.add_list(full(name), values);
    }
  }

  Saved saved_;
  std::span<CheckpointPart const> parts_;
  std::vector<std::uint64_t> lengths_;
  checkpoint::Members members_;
};

/// Returns the parts that a checkpoint lists, in their order; none if the checkpoint file contains the rows.
std::vector<CheckpointPart> parts_of(checkpoint::File const& file) {
  if (file.version() == checkpoint::whole_version) return {};
  std::vector<CheckpointPart> parts;
  try {
    checkpoint::File::Place const& list = file.at(parts_member, FileKind::list);
    std::vector<std::uint64_t> numbers(file.count<std::uint64_t>(list));
    file.read(list, 0, std::span(numbers));
    for (std::size_t k = 0; k + numbers_per_part <= numbers.size(); k += numbers_per_part) {
      parts.push_back({.checksum = {numbers[k], numbers[k + 1]}});
    }
  } catch (Error const& error) {
    checkpoint::refuse(file.name(), error.problems().front().what, error.problems().front().hint);
  }
  return parts;
}

/// Returns the range of rows, first and end, that belongs to one process, of a list with `rows` rows.
std::pair<std::uint64_t, std::uint64_t> rows_of(CheckpointShare const& share, std::uint64_t rows) {
  RowDivision const even = RowDivision::even(rows, share.count);
  return {even.first(share.part), even.end(share.part)};
}

checkpoint::File opened_part(fs::path const& path, CheckpointPart const& part) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) checkpoint::refuse(path.string(), "it is missing", checkpoint::again_hint);
  checkpoint::File file(checkpoint::bytes_of_file(path));
  if (file.checksum() != part.checksum) {
    checkpoint::refuse(path.string(), "it is a part of another checkpoint", checkpoint::again_hint);
  }
  return file;
}

/// The parts that a checkpoint lists; a part is opened at its first use.
class Parts {
 public:
  Parts() = default;
  Parts(checkpoint::File const& file, fs::path directory)
      : directory_(std::move(directory)), parts_(parts_of(file)), files_(parts_.size()) {}

  [[nodiscard]] std::size_t size() const { return parts_.size(); }
  /// Errors: Error naming the file that is missing or damaged.
  [[nodiscard]] checkpoint::File const& file(std::size_t part) const {
    std::optional<checkpoint::File>& file = files_[part];
    if (!file) file.emplace(opened_part(directory_ / name_of_part(part, parts_[part]), parts_[part]));
    return *file;
  }

 private:
  fs::path directory_;
  std::vector<CheckpointPart> parts_;
  mutable std::vector<std::optional<checkpoint::File>> files_;
};

/// A range of rows within one part; `first` counts from the beginning of the part.
struct Piece {
  std::size_t part;
  std::uint64_t first;
  std::uint64_t count;
};

/// Returns the ranges within parts that together are rows first … end − 1; part k has rows_of_part(k) rows.
template <class RowsOf>
std::vector<Piece> pieces_between(std::uint64_t first, std::uint64_t end, std::size_t parts, RowsOf rows_of_part) {
  std::vector<Piece> pieces;
  std::uint64_t begin = 0;
  for (std::size_t part = 0; part < parts; ++part) {
    std::uint64_t const end_of_part = begin + rows_of_part(part);
    std::uint64_t const from = std::max(begin, first);
    std::uint64_t const to = std::min(end_of_part, end);
    if (from < to) pieces.push_back({.part = part, .first = from - begin, .count = to - from});
    begin = end_of_part;
  }
  return pieces;
}

class RestoringArchive final : public NamedArchive {
 public:
  RestoringArchive(checkpoint::File const& file, Parts const& parts, CheckpointShare const& share)
      : file_(file), parts_(parts), share_(share) {}

  [[nodiscard]] bool is_restoring() const override { return true; }
  [[nodiscard]] bool has(std::string_view name) const override { return file_.has(full(name)); }
  void visit(std::string_view name, bool& value) override { value = file_.at(full(name), FileKind::truth).number != 0; }
  void visit(std::string_view name, double& value) override { value = std::bit_cast<double>(number(name)); }
  void visit(std::string_view name, std::uint64_t& value) override { value = number(name); }
  void visit(std::string_view name, std::string& value) override {
    value = file_.text(file_.at(full(name), FileKind::text));
  }
  void visit(std::string_view name, std::vector<double>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::int32_t>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::uint32_t>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::uint64_t>& values) override { restore(name, values); }
  void visit_rows(std::string_view name, std::vector<double>& values) override { restore_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::int32_t>& values) override { restore_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::uint32_t>& values) override { restore_rows(name, values); }
  void visit_rows(std::string_view name, std::vector<std::uint64_t>& values) override { restore_rows(name, values); }

 private:
  [[nodiscard]] std::uint64_t number(std::string_view name) const {
    return file_.at(full(name), FileKind::number).number;
  }

  template <class Number>
  void restore(std::string_view name, std::vector<Number>& values) const {
    checkpoint::File::Place const& list = file_.at(full(name), FileKind::list);
    values.resize(file_.count<Number>(list));
    file_.read(list, 0, std::span(values));
  }

  template <class Number>
  void restore_rows(std::string_view name, std::vector<Number>& values) const {
    checkpoint::File::Place const& list = file_.at(full(name), FileKind::list);
    bool const is_in_parts = file_.version() == checkpoint::version_of_parts;
    if (is_in_parts && file_.letter(list) == in_parts(checkpoint::letter_of<Number>())) {
      return restore_from_lists(name, file_.rest_of<std::uint64_t>(list), values);
    }
    auto const [first, end] = rows_of(share_, file_.count<Number>(list));
    values.resize(end - first);
    file_.read(list, first, std::span(values));
  }

  /// A list of which each part contains some rows; `lengths` are the rows of each part.
  template <class Number>
  void restore_from_lists(std::string_view name, std::vector<std::uint64_t> const& lengths,
                          std::vector<Number>& values) const {
    std::string const member = full(name);
    require(lengths.size() == parts_.size(), "a list has not as many parts as the checkpoint");
    std::uint64_t const rows = std::reduce(lengths.begin(), lengths.end());
    auto const [first, end] = rows_of(share_, rows);
    values.clear();
    for (Piece const& piece :
         pieces_between(first, end, lengths.size(), [&](std::size_t part) { return lengths[part]; })) {
      require_length(piece.part, member, count_in_part<Number>(piece.part, member), lengths[piece.part]);
      append<Number>(piece, member, values);
    }
  }

  template <class Number>
  [[nodiscard]] std::uint64_t count_in_part(std::size_t part, std::string const& member) const {
    checkpoint::File const& file = parts_.file(part);
    return file.count<Number>(file.at(member, FileKind::list));
  }
  void require_length(std::size_t part, std::string const& member, std::uint64_t count, std::uint64_t rows) const {
    if (count == rows) return;
    throw Error({.what = fmt::format("its part {} has {} values of \"{}\" for {} rows", parts_.file(part).name(), count,
                                     member, rows),
                 .hint = checkpoint::again_hint});
  }
  template <class Number>
  void append(Piece const& piece, std::string const& member, std::vector<Number>& values) const {
    checkpoint::File const& file = parts_.file(piece.part);
    std::size_t const had = values.size();
    values.resize(had + piece.count);
    file.read(file.at(member, FileKind::list), piece.first, std::span(values).subspan(had));
  }

  checkpoint::File const& file_;
  Parts const& parts_;
  CheckpointShare const& share_;
};

void restore_from(checkpoint::File const& file, Parts const& parts, CheckpointShare const& share,
                  SerializeAll const& serialize) {
  RestoringArchive archive(file, parts, share);
  try {
    serialize(archive);
  } catch (Error const& error) {
    Problem const& problem = error.problems().front();
    // The error of a damaged part already names its file.
    if (!problem.file.empty()) throw;
    checkpoint::refuse(file.name(), problem.what, problem.hint);
  }
}

/// Returns whether a path exists, also as a link to nothing or as an entry that cannot be examined.
bool is_name_taken(fs::path const& path) {
  std::error_code ignored;
  return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

/// Throws in all processes if a path is not a regular file in one of them. No older checkpoint is restored instead,
/// since the next checkpoint could not be written over such a path.
void require_file(fs::path const& path, bool is_newest, AgreeOnRefusal const& of_all) {
  Problem problem;
  try {
    require_regular_file(path);
  } catch (Error const& refusal) {
    problem = refusal.problems().front();
  }
  std::string const reason = of_all(problem.what);
  if (reason.empty()) return;
  bool const has_previous = is_newest && is_name_taken(path.parent_path() / previous_name);
  throw Error(
      {.what = reason,
       .hint = has_previous ? fmt::format("remove it, and the run continues from {}", previous_name) : "remove it",
       .file = path.string()});
}

void append_to(AtomicFile& file, std::uint32_t version, checkpoint::Members const& members) {
  members.write(version, [&](std::string_view piece) { file.append(piece); });
}

std::vector<fs::path> part_files(fs::path const& directory) {
  std::vector<fs::path> files;
  std::error_code error;
  fs::directory_iterator entry(directory, error);
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    bool const is_file = entry->symlink_status(ignored).type() == fs::file_type::regular;
    if (is_file && is_name_of_part(entry->path().filename().string())) files.push_back(entry->path());
  }
  return files;
}

}  // namespace

void remove_unneeded_parts(fs::path const& directory) {
  std::vector<fs::path> const files = part_files(directory);
  if (files.empty()) return;
  std::set<std::string> needed;
  std::error_code ignored;
  try {
    for (char const* name : {newest_name, previous_name}) {
      if (!fs::exists(directory / name, ignored)) continue;
      std::vector<CheckpointPart> const parts = parts_of(checkpoint::File(checkpoint::bytes_of_file(directory / name)));
      for (std::size_t part = 0; part < parts.size(); ++part) needed.insert(name_of_part(part, parts[part]));
    }
  } catch (Error const&) {
    return;
  }
  for (fs::path const& file : files) {
    if (!needed.contains(file.filename().string())) fs::remove(file, ignored);
  }
}

std::string to_checkpoint(SerializeAll const& serialize) {
  SavingArchive archive(Saved::everything);
  serialize(archive);
  std::string bytes;
  archive.members().write(checkpoint::whole_version, [&](std::string_view piece) { bytes += piece; });
  return bytes;
}

void from_checkpoint(std::string_view bytes, std::string const& name, SerializeAll const& serialize) {
  checkpoint::File const file(checkpoint::bytes_of_text(bytes, name));
  if (file.version() != checkpoint::whole_version) {
    checkpoint::refuse(name, "its rows are in other files", "restore it from its directory");
  }
  restore_from(file, {}, {}, serialize);
}

CheckpointPart write_checkpoint_part(fs::path const& directory, CheckpointShare const& share,
                                     SerializeAll const& serialize) {
  SavingArchive archive(Saved::rows);
  serialize(archive);
  CheckpointPart part{.checksum = archive.members().checksum(), .lengths = archive.lengths()};
  AtomicFile file(directory / name_of_part(share.part, part));
  append_to(file, checkpoint::whole_version, archive.members());
  file.commit();
  return part;
}

void write_checkpoint(fs::path const& directory, SerializeAll const& serialize,
                      std::vector<CheckpointPart> const& parts) {
  {
    SavingArchive archive(parts.empty() ? Saved::everything : Saved::all_but_rows, parts);
    serialize(archive);
    if (!parts.empty()) {
      std::vector<std::uint64_t> numbers;
      for (CheckpointPart const& part : parts) {
        numbers.insert(numbers.end(), part.checksum.begin(), part.checksum.end());
      }
      archive.members().add_list(parts_member, numbers);
    }
    AtomicFile file(directory / newest_name);
    append_to(file, parts.empty() ? checkpoint::whole_version : checkpoint::version_of_parts, archive.members());
    file.commit(directory / previous_name);
  }
  remove_unneeded_parts(directory);
}

std::optional<Restored> restore_checkpoint(fs::path const& directory, SerializeAll const& serialize,
                                           CheckpointShare const& share, AgreeOnRefusal const& agree) {
  AgreeOnRefusal const of_all = agree ? agree : [](std::string const& own) { return own; };
  std::string note;
  std::optional<Error> error;
  for (char const* name : {newest_name, previous_name}) {
    fs::path const path = directory / name;
    if (of_all(is_name_taken(path) ? "it is there" : "").empty()) continue;
    require_file(path, name == newest_name, of_all);
    Problem problem;
    try {
      checkpoint::File const file(checkpoint::bytes_of_file(path));
      restore_from(file, Parts(file, directory), share, serialize);
    } catch (Error const& refusal) {
      problem = refusal.problems().front();
    }
    std::string const reason = of_all(problem.what);
    if (reason.empty()) return Restored{path, note};
    if (problem.what.empty()) problem = {.what = reason, .hint = checkpoint::again_hint, .file = path.string()};
    if (!error) error = Error(problem);
    note = reason;
  }
  if (error) throw *error;
  return std::nullopt;
}

bool has_checkpoint(fs::path const& directory) {
  return is_name_taken(directory / newest_name) || is_name_taken(directory / previous_name);
}

void remove_previous_checkpoint(fs::path const& directory) {
  std::error_code ignored;
  if (!fs::exists(directory / newest_name, ignored)) return;
  fs::remove(directory / previous_name, ignored);
  remove_unneeded_parts(directory);
}

void remove_checkpoints(fs::path const& directory) {
  std::error_code ignored;
  fs::remove(directory / newest_name, ignored);
  fs::remove(directory / previous_name, ignored);
  for (fs::path const& file : part_files(directory)) fs::remove(file, ignored);
}

}  // namespace gridlock
