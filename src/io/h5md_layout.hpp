#pragma once

#include <xxhash.h>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gridlock/core/frame.hpp"

namespace gridlock::h5md {

/// Returns the attribute `boundary` of a box: "periodic" or "none" along x, y and z.
std::vector<std::string> boundary_of(Box const& box);
/// Returns the edges along x and y. Values that a file of another program leaves out are those of x.
std::pair<Edge, Edge> edges_of(std::vector<std::string> const& boundary);
/// Moves x to the left by the shift of the box for each edge of y that folding takes a position across, and
/// counts the edges of x that images have crossed in `box`, which leans by whole widths less than `shift`.
void lean(Box const& box, double shift, std::vector<double>& x, std::vector<double> const& y,
          std::vector<std::int32_t>* images_x, std::vector<std::int32_t> const* images_y);
/// Returns the box with the edge vectors (width, 0) and (shift, height). Errors: Error where there is none.
Box box_of(double width, double height, double shift, std::pair<Edge, Edge> const& edges);

inline constexpr std::uint64_t absent_id = std::numeric_limits<std::uint64_t>::max();
/// Maximum number of agents in a chunk, so that a chunk of 64-bit numbers takes 1 MiB.
inline constexpr std::size_t max_rows_per_chunk = std::size_t{1} << 17;
/// Number of frames in a chunk of an array with one number per frame.
inline constexpr std::size_t frames_per_chunk = 64;
inline constexpr std::size_t dimensions = 3;
/// Name of the attribute that lists the meanings of a column's values 0, 1, 2 ….
inline constexpr char const* value_names = "value_names";

/// Computes XXH3 of 64 bits over arrays of numbers that arrive one after the other.
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
  std::string name;                  ///< name below /particles/<agents>
  std::vector<std::size_t> columns;  ///< indices of the columns in the frame
  std::string unit;                  ///< empty if unknown

  [[nodiscard]] bool is_vector() const { return columns.size() == 2; }
};

/// Returns the elements for columns: x and y become "position", and "<name>_x" followed by "<name>_y" of the same type
/// becomes the vector <name>. Uses names and types of the columns, not their values.
std::vector<Element> elements_of(std::vector<FrameColumn> const& columns);

/// Returns the names of the columns for one element, a vector or a scalar.
std::vector<std::string> column_names(std::string const& element, bool is_vector);

/// Returns the bytes of a column's values.
std::span<std::byte const> bytes_of(FrameValues const& values);
std::size_t width_of(FrameValues const& values);

/// Starts the checksum of a frame, by which the reader finds damage. The caller then adds all Ids, the name and the
/// values of each column, the fields, the networks, and last the observables.
Checksum begun_checksum(Box const& box, Clock const& clock, std::uint64_t seed, std::size_t agents,
                        std::uint64_t state_hash);
void add_fields(Checksum& sum, std::span<Field const> fields);
void add_networks(Checksum& sum, std::span<Network const> networks);
/// Returns the checksum of a frame in memory.
std::uint64_t checksum(Frame const& frame, std::span<double const> observables, std::uint64_t state_hash);

/// Returns the checksum of contacts.
std::uint64_t checksum(FrameContacts const& contacts);

}  // namespace gridlock::h5md
