#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "gridlock/core/population.hpp"
#include "gridlock/core/vector.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/text_reader.hpp"
#include "io/xyz_header.hpp"
#include "io/xyz_lines.hpp"

namespace gridlock::xyz {

/// A disk as its line in the file describes it.
struct Row {
  Id id = 0;
  Vector position;
  Vector velocity;
  double radius = 0.0;
  double mass = 1.0;
  std::int32_t image_x = 0;
  std::int32_t image_y = 0;
  std::uint64_t number = 0;  ///< index of the row in the file
};

/// The frame of a file to be read, and the name of the setting for it.
struct FrameChoice {
  std::optional<std::int64_t> frame = {};  ///< from 0, or from −1 backwards; nothing for a file with one frame
  std::string setting = "frame";           ///< name in hints: "--frame", "disks.frame"
};

/// Consecutive rows of a file.
struct Rows {
  std::vector<Row> disks;
  std::vector<double> others;  ///< values of Columns::others, row after row
};

/// An Id and the row of the file that gives it.
struct IdOfRow {
  Id id;
  std::uint64_t row;
};

/// An Id that a population cannot have, since its slot is used twice or is too large for the number of disks.
struct WrongId {
  Id id;
  std::uint64_t row;
  std::optional<std::uint64_t> first_row;  ///< earlier row with the same slot; none if the slot is too large
};

/// Returns the slot of an Id in a population, its lower 32 bits. Two disks must not share a slot.
inline std::uint64_t slot_of(Id id) { return id & 0xFFFFFFFFU; }

/// Returns the wrong Id with the lowest slot in a file of `count` rows; nothing if all Ids are valid. Ids with the same
/// slot must be in the same call. Sorts `ids`.
std::optional<WrongId> find_wrong_id(std::vector<IdOfRow>& ids, std::uint64_t count);

/// Returns whether ascending Ids from `first` to `last` are certain to be valid.
bool are_plain(Id first, Id last, std::uint64_t count);

/// Reads a frame of extended XYZ: two header lines, then the rows in pieces. Positions are relative to the lower left
/// corner, and folded through periodic edges with their images. Damage of a packed file is reported before any other
/// error.
class Reader {
 public:
  /// Errors: Error if the first two lines are malformed.
  explicit Reader(TextReader text, FrameChoice choice = {});

  /// Returns the number of rows by the first line of the frame.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Header const& header() const { return header_; }
  [[nodiscard]] Columns const& columns() const { return *header_.columns; }
  /// Returns the names in the file that disks do not use.
  [[nodiscard]] std::vector<std::string> unused() const;
  [[nodiscard]] Box const& box() const { return box_; }
  /// Returns the tilt of the Lattice, which may lean farther than the box.
  [[nodiscard]] double given_tilt() const { return header_.sides->shift / header_.sides->height; }
  /// Returns how many rows so far were outside the box and have been folded into it.
  [[nodiscard]] std::uint64_t folded() const { return folded_; }
  /// Returns for how many rows to reserve memory; less than count() if the file is too small for its first line.
  [[nodiscard]] std::uint64_t likely_count() const;

  /// Appends the next rows, at most `most`. Returns false if there were none left; then the file must end. Errors:
  /// Error.
  bool read(std::size_t most, Rows& rows);

  [[noreturn]] void refuse(WrongId const& wrong);

 private:
  void undamaged(std::function<void()> const& read);
  void go_to(std::int64_t frame);
  void refuse_further_lines();
  [[nodiscard]] int line_of(std::uint64_t row) const { return first_row_line_ + static_cast<int>(row); }
  void read_row(Rows& rows);
  [[nodiscard]] Row row_of(std::vector<Word> const& words) const;
  void take(Word const& word, Role role, Row& row) const;
  void put_inside(Row& row);
  [[nodiscard]] std::int32_t folded(double& place, double side, std::int32_t image) const;
  [[nodiscard]] double positive(Word const& word, Role role) const;
  [[nodiscard]] Id id(Word const& word) const;
  [[nodiscard]] std::int32_t image(Word const& word, Role role) const;
  void refuse_height(Word const& word, Role role) const;

  Lines lines_;
  FrameChoice choice_;
  std::uint64_t count_ = 0;
  int first_row_line_ = 3;  ///< line number of the first row
  Header header_;
  Box box_;
  double widths_ = 0.0;  ///< by which the Lattice leans farther than the box that stands for it
  std::uint64_t folded_ = 0;
  std::uint64_t next_row_ = 0;
  std::vector<Word> words_;
};

/// Reads the rows after the header. Errors: those of read_xyz().
XyzFrame read_all(Reader& reader);

/// Goes to the next line that is not empty, and returns the number of rows in it. Errors: Error if it has none.
std::uint64_t read_count(Lines& lines);

/// Returns the number of frames in a text. Errors: Error if a frame is cut off, or other text follows a frame.
std::uint64_t count_frames(Lines& lines);

}  // namespace gridlock::xyz
