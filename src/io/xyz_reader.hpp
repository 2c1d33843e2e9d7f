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

/// What is wrong with some of the Ids of a file of `count` rows, of the lowest slot that cannot be. Those with one slot are given
/// together. Changes their order.
std::optional<WrongId> find_wrong_id(std::vector<IdOfRow>& ids, std::uint64_t count);

/// Whether Ids in this order ascend and cannot be wrong.
bool are_plain(Id first, Id last, std::uint64_t count);

/// Reads extended XYZ with one frame: its head, then its rows in pieces. Where a packed text is damaged, that is the error,
/// whatever else its bytes say.
class Reader {
 public:
  /// Errors: Error for the first two lines.
  explicit Reader(TextReader text);

  /// Rows of the file, as its first line says.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Header const& header() const { return header_; }
  /// For how many rows there should be room, whatever the first line says.
  [[nodiscard]] std::uint64_t likely_count() const;

  /// Appends further rows, at most `most`; false where there were none left, and nothing else is in the file. Errors: Error.
  bool read(std::size_t most, Rows& rows);

  [[noreturn]] void refuse(WrongId const& wrong);

 private:
  void undamaged(std::function<void()> const& read);
  void read_row(Rows& rows);
  [[nodiscard]] Row row_of(std::vector<Word> const& words) const;
  [[noreturn]] void refuse_word(Word const& word, Role role, std::string_view expected) const;
  [[nodiscard]] double real(Word const& word, Role role) const;
  [[nodiscard]] double positive(Word const& word, Role role) const;
  [[nodiscard]] Id id(Word const& word) const;
  [[nodiscard]] std::int32_t image(Word const& word, Role role) const;
  void refuse_height(Word const& word, Role role) const;

  Lines lines_;
  std::uint64_t count_ = 0;
  Header header_;
  std::uint64_t next_row_ = 0;
  std::vector<Word> words_;
};

/// The frame of a file of which nothing but the head has been read. Errors: those of read_xyz().
XyzFrame read_all(Reader& reader);

}  // namespace gridlock::xyz
