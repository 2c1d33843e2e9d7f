#include "io/checkpoint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cctype>
#include <set>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/checkpoint_file.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;
using Kind = checkpoint::File::Kind;

constexpr char const* newest_name = "checkpoint.gridlock";
constexpr char const* previous_name = "checkpoint.previous.gridlock";
constexpr std::string_view part_prefix = "checkpoint.part.";
constexpr std::string_view part_suffix = ".gridlock";

/// The member that lists the parts of a checkpoint: rows and checksum of each.
constexpr char const* parts_member = "parts";
constexpr std::size_t numbers_per_part = 3;

char in_parts(char letter) { return static_cast<char>(std::toupper(static_cast<unsigned char>(letter))); }

std::string name_of_part(std::size_t rank, CheckpointPart const& part) {
  return fmt::format("{}{}.{:016x}{:016x}{}", part_prefix, rank, part.checksum[1], part.checksum[0], part_suffix);
}

/// checkpoint.part.RANK.CHECKSUM.gridlock with a number and 32 hexadecimal digits, and no other name: files of users stay.
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

/// Names members by the path to them, so that the file is a map without maps in it.
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

/// What goes into a file.
enum class Saved { everything, rows, all_but_rows };

class SavingArchive final : public NamedArchive {
 public:
  explicit SavingArchive(Saved saved) : saved_(saved) {}

  [[nodiscard]] checkpoint::Members& members() { return members_; }
  [[nodiscard]] bool is_restoring() const override { return false; }
  void visit(std::string_view name, bool& value) override { save(name, value); }
  /// As the bits it has, since CBOR keeps one kind of NaN only.
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
    if (saved_ == Saved::all_but_rows) {
      members_.add_bytes(full(name), in_parts(checkpoint::letter_of<Number>()), {});
    } else {
      members_.add_list(full(name), values);
    }
  }

  Saved saved_;
  checkpoint::Members members_;
};

/// The parts that a checkpoint names, in the order of the ranks; none where it has its rows itself.
std::vector<CheckpointPart> parts_of(checkpoint::File const& file) {
  if (file.version() == checkpoint::whole_version) return {};
  std::vector<CheckpointPart> parts;
  try {
    checkpoint::File::Place const& list = file.at(parts_member, Kind::list);
    std::vector<std::uint64_t> numbers(file.count<std::uint64_t>(list));
    file.read(list, 0, std::span(numbers));
    for (std::size_t k = 0; k + numbers_per_part <= numbers.size(); k += numbers_per_part) {
      parts.push_back({.rows = numbers[k], .checksum = {numbers[k + 1], numbers[k + 2]}});
    }
  } catch (Error const& error) {
    checkpoint::refuse(file.name(), error.problems().front().what, error.problems().front().hint);
  }
  return parts;
}

/// A file whose list of rows is a run of the rows of the whole, and what of it one process has.
struct Piece {
  checkpoint::File file;
  std::uint64_t rows;   ///< in the file
  std::uint64_t first;  ///< of these is the first that the process has
  std::uint64_t count;
};

checkpoint::File opened_part(fs::path const& path, CheckpointPart const& part) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) checkpoint::refuse(path.string(), "it is missing", checkpoint::again_hint);
  checkpoint::File file(checkpoint::bytes_of_file(path));
  if (file.checksum() != part.checksum) {
    checkpoint::refuse(path.string(), "it is a part of another checkpoint", checkpoint::again_hint);
  }
  return file;
}

/// The parts that have rows of the share. Errors: Error naming the file that is missing or damaged.
std::vector<Piece> pieces_of(checkpoint::File const& file, fs::path const& directory, CheckpointShare const& share) {
  std::vector<Piece> pieces;
  std::uint64_t begin = 0;
  std::vector<CheckpointPart> const parts = parts_of(file);
  for (std::size_t rank = 0; rank < parts.size(); ++rank) {
    std::uint64_t const end = begin + parts[rank].rows;
    std::uint64_t const first = std::max(begin, share.first_row);
    std::uint64_t const last = std::min(end, share.end_row);
    if (first < last) {
      pieces.push_back({.file = opened_part(directory / name_of_part(rank, parts[rank]), parts[rank]),
                        .rows = parts[rank].rows,
                        .first = first - begin,
                        .count = last - first});
    }
    begin = end;
  }
  bool const has_end = share.rank + 1 == share.count && share.end_row != CheckpointShare::all_rows;
  std::uint64_t const least = share.end_row == CheckpointShare::all_rows ? share.first_row : share.end_row;
  if (!parts.empty() && (begin < least || (has_end && begin > least))) {
    checkpoint::refuse(file.name(), fmt::format("its parts have {} rows, and this run has others", begin),
                       "it was written for another configuration");
  }
  return pieces;
}

class RestoringArchive final : public NamedArchive {
 public:
  RestoringArchive(checkpoint::File const& file, std::vector<Piece> const& pieces, CheckpointShare const& share)
      : file_(file), pieces_(pieces), share_(share) {}

  [[nodiscard]] bool is_restoring() const override { return true; }
  void visit(std::string_view name, bool& value) override { value = file_.at(full(name), Kind::truth).number != 0; }
  void visit(std::string_view name, double& value) override { value = std::bit_cast<double>(number(name)); }
  void visit(std::string_view name, std::uint64_t& value) override { value = number(name); }
  void visit(std::string_view name, std::string& value) override {
    value = file_.text(file_.at(full(name), Kind::text));
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
  [[nodiscard]] std::uint64_t number(std::string_view name) const { return file_.at(full(name), Kind::number).number; }

  template <class Number>
  void restore(std::string_view name, std::vector<Number>& values) const {
    checkpoint::File::Place const& list = file_.at(full(name), Kind::list);
    values.resize(file_.count<Number>(list));
    file_.read(list, 0, std::span(values));
  }

  template <class Number>
  void restore_rows(std::string_view name, std::vector<Number>& values) const {
    checkpoint::File::Place const& list = file_.at(full(name), Kind::list);
    bool const is_in_parts = file_.version() == checkpoint::version_of_parts;
    if (is_in_parts && file_.letter(list) == in_parts(checkpoint::letter_of<Number>())) {
      return restore_from_pieces(name, values);
    }
    std::uint64_t const count = file_.count<Number>(list);
    bool const is_empty = count == 0;
    std::uint64_t const first = is_empty ? 0 : share_.first_row;
    std::uint64_t const end = share_.end_row == CheckpointShare::all_rows || is_empty ? count : share_.end_row;
    bool const is_last = share_.rank + 1 == share_.count;
    require(first <= end && end <= count && (is_empty || !is_last || end == count),
            "a list has not a value for each agent");
    values.resize(end - first);
    file_.read(list, first, std::span(values));
  }

  /// A list that is empty in all parts was empty.
  template <class Number>
  void restore_from_pieces(std::string_view name, std::vector<Number>& values) const {
    std::string const member = full(name);
    values.clear();
    std::uint64_t rows = 0;
    for (Piece const& piece : pieces_) {
      checkpoint::File::Place const& list = piece.file.at(member, Kind::list);
      std::uint64_t const count = piece.file.count<Number>(list);
      if (count != piece.rows && count != 0) {
        throw Error({.what = fmt::format("its part {} has {} values of \"{}\" for {} rows", piece.file.name(), count,
                                         member, piece.rows),
                     .hint = checkpoint::again_hint});
      }
      rows += piece.count;
      if (count == 0) continue;
      std::size_t const had = values.size();
      values.resize(had + piece.count);
      piece.file.read(list, piece.first, std::span(values).subspan(had));
    }
    require(values.empty() || values.size() == rows, "a list has not a value for each agent");
  }

  checkpoint::File const& file_;
  std::vector<Piece> const& pieces_;
  CheckpointShare const& share_;
};

void restore_from(checkpoint::File const& file, std::vector<Piece> const& pieces, CheckpointShare const& share,
                  SerializeAll const& serialize) {
  RestoringArchive archive(file, pieces, share);
  try {
    serialize(archive);
  } catch (Error const& error) {
    checkpoint::refuse(file.name(), error.problems().front().what, error.problems().front().hint);
  }
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
      for (std::size_t rank = 0; rank < parts.size(); ++rank) needed.insert(name_of_part(rank, parts[rank]));
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
  assert(share.end_row != CheckpointShare::all_rows);
  SavingArchive archive(Saved::rows);
  serialize(archive);
  CheckpointPart const part{.rows = share.end_row - share.first_row, .checksum = archive.members().checksum()};
  AtomicFile file(directory / name_of_part(share.rank, part));
  append_to(file, checkpoint::whole_version, archive.members());
  file.commit();
  return part;
}

void write_checkpoint(fs::path const& directory, SerializeAll const& serialize,
                      std::vector<CheckpointPart> const& parts) {
  {
    SavingArchive archive(parts.empty() ? Saved::everything : Saved::all_but_rows);
    serialize(archive);
    if (!parts.empty()) {
      std::vector<std::uint64_t> numbers;
      for (CheckpointPart const& part : parts) {
        numbers.insert(numbers.end(), {part.rows, part.checksum[0], part.checksum[1]});
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
  std::string note;
  std::optional<Error> error;
  for (char const* name : {newest_name, previous_name}) {
    fs::path const path = directory / name;
    std::error_code ignored;
    if (!fs::exists(path, ignored)) continue;
    // Not among what a damaged one may be replaced for: the next checkpoint would go into it too.
    require_regular_file(path);
    Problem problem;
    try {
      checkpoint::File const file(checkpoint::bytes_of_file(path));
      restore_from(file, pieces_of(file, directory, share), share, serialize);
    } catch (Error const& refusal) {
      problem = refusal.problems().front();
    }
    std::string const reason = agree ? agree(problem.what) : problem.what;
    if (reason.empty()) return Restored{path, note};
    if (problem.what.empty()) problem = {.what = reason, .hint = checkpoint::again_hint, .file = path.string()};
    if (!error) error = Error(problem);
    note = reason;
  }
  if (error) throw *error;
  return std::nullopt;
}

bool has_checkpoint(fs::path const& directory) {
  std::error_code ignored;
  return fs::exists(directory / newest_name, ignored) || fs::exists(directory / previous_name, ignored);
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
