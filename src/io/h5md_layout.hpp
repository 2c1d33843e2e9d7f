#pragma once

#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/frame.hpp"

namespace gridlock::h5md {

inline constexpr std::uint64_t absent_id = std::numeric_limits<std::uint64_t>::max();
/// Agents in one chunk at most: 1 MiB of numbers of 64 bits.
inline constexpr std::size_t max_rows_per_chunk = std::size_t{1} << 17;
/// Numbers in a chunk of an array with one number for each frame.
inline constexpr std::size_t frames_per_chunk = 64;
inline constexpr std::size_t dimensions = 3;
/// The attribute of a column with what its numbers 0, 1, 2 … are called.
inline constexpr char const* value_names = "value_names";

/// XXH3 of 64 bits over numbers that come one after the other.
class Checksum {
 public:
  Checksum() { XXH3_64bits_reset(state_.get()); }
  void add(auto numbers) { XXH3_64bits_update(state_.get(), numbers.data(), numbers.size_bytes()); }
  [[nodiscard]] std::uint64_t digest() const { return XXH3_64bits_digest(state_.get()); }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_{XXH3_createState(), &XXH3_freeState};
};

/// A quantity of H5MD: one column of a frame, or the two columns of a vector in the plane.
struct Element {
  std::string name;                  ///< below /particles/<agents>
  std::vector<std::size_t> columns;  ///< their places among the columns of the frame
  std::string unit;                  ///< empty where it is not known

  [[nodiscard]] bool is_vector() const { return columns.size() == 2; }
};

/// The elements of columns: x and y are the position, and every "<name>_x" followed by "<name>_y" of the same type is
/// the vector <name>. Only names and types are looked at.
std::vector<Element> elements_of(std::vector<FrameColumn> const& columns);

/// The names of the columns that become an element of that name.
std::vector<std::string> column_names(std::string const& element, bool is_vector);

/// The bytes of the numbers of a column.
std::span<std::byte const> bytes_of(FrameValues const& values);
std::size_t width_of(FrameValues const& values);

/// Begins the hash over all of a frame, by which the reader knows that nothing was damaged. All Ids follow, one after
/// the other, then the name and all values of each column, and the observables last.
Checksum begun_checksum(Box const& box, Clock const& clock, std::uint64_t seed, std::size_t agents,
                        std::uint64_t state_hash);
/// The hash of a frame in memory.
std::uint64_t checksum(Frame const& frame, std::span<double const> observables, std::uint64_t state_hash);

/// The same over contacts.
std::uint64_t checksum(FrameContacts const& contacts);

}  // namespace gridlock::h5md
