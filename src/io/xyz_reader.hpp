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

/// One disk as its line gives it.
struct Row {
  Id id = 0;
  Vector position;
  Vector velocity;
  double radius = 0.0;
  double mass = 1.0;
  std::int32_t image_x = 0;
  std::int32_t image_y = 0;
  std::uint64_t number = 0;  ///< from 0, as it is in the file
};

/// Which frame of a file is read, and how the user says so.
struct FrameChoice {
  std::optional<std::int64_t> frame = {};  ///< from 0, or from −1 for the last; left out: the only one
  std::string setting = "frame";           ///< in hints: "--frame", "disks.frame"
};

/// Some rows of a file, one after the other.
struct Rows {
  std::vector<Row> disks;
  std::vector<double> others;  ///< row after row, those of Header::others
};

/// An Id and the row of the file that gives it.
struct IdOfRow {
  Id id;
  std::uint64_t row;
};

/// Why disks cannot have the Ids of a file: one slot of a population is given twice, or one is out of proportion.
struct WrongId {
  Id id;
  std::uint64_t row;
  std::optional<std::uint64_t> first_row;  ///< that has the same slot
};

/// The place of an Id in a population, which two disks cannot share.
inline std::uint64_t slot_of(Id id) { return id & 0xFFFFFFFFU; }

/// The problem of some of the Ids of a file of `count` rows, that of the lowest slot that cannot be. Those with one
/// slot are given together. Changes their order.
std::optional<WrongId> find_wrong_id(std::vector<IdOfRow>& ids, std::uint64_t count);

/// Whether Ids in this order ascend and cannot be wrong.
bool are_plain(Id first, Id last, std::uint64_t count);

/// Reads a frame of extended XYZ: its head, then its rows in pieces. Positions come inside the box: counted from its
/// corner, and through periodic edges, which the images count. Where a packed text is damaged, that is the error,
/// whatever else its bytes say.
class Reader {
 public:
  /// Errors: Error for the first two lines.
  explicit Reader(TextReader text, FrameChoice choice = {});

  /// Rows of the frame, as its first line says.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Header const& header() const { return header_; }
  [[nodiscard]] Columns const& columns() const { return *header_.columns; }
  /// Names in the file that disks do not have.
  [[nodiscard]] std::vector<std::string> unused() const;
  [[nodiscard]] Box const& box() const { return box_; }
  /// How many rows so far were outside the box, and have come through its edges.
  [[nodiscard]] std::uint64_t folded() const { return folded_; }
  /// For how many rows there should be room, whatever the first line says.
  [[nodiscard]] std::uint64_t likely_count() const;

  /// Appends further rows, at most `most`; false where there were none left, and nothing else is in the file. Errors:
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
  int first_row_line_ = 3;  ///< the head takes two lines
  Header header_;
  Box box_;
  std::uint64_t folded_ = 0;
  std::uint64_t next_row_ = 0;
  std::vector<Word> words_;
};

/// The frame of a file of which nothing but the head has been read. Errors: those of read_xyz().
XyzFrame read_all(Reader& reader);

/// Goes to the next line that is not empty, and reads the number of rows there. Errors: Error where it has none.
std::uint64_t read_count(Lines& lines);

/// How many frames a text has. Errors: Error where one is cut off, or something else stands between them.
std::uint64_t count_frames(Lines& lines);

}  // namespace gridlock::xyz
