// What a file of extended XYZ may hold, and what is looked at next in a state that was read.

#include "gridlock/io/xyz.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "gridlock/core/error.hpp"
#include "gridlock/grid/validate.hpp"
#include "io/xyz_reader.hpp"
#include "io/xyz_shown.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace gridlock;
  std::string_view const text(reinterpret_cast<char const*>(data), size);
  try {
    xyz::ShownFrame const shown = xyz::read_shown(TextReader(text, "shown.xyz"), 1);
    for (xyz::ShownColumn const& column : shown.columns) {
      if (column.values.size() != shown.ids.size()) std::abort();
    }
  } catch (Error const&) {
  }
  try {
    for (std::int64_t const number : {1, -1}) {
      xyz::Reader reader(TextReader(text, "frame.xyz"), {.frame = number});
      xyz::read_all(reader);
    }
  } catch (Error const&) {
  }
  try {
    XyzFrame const frame = parse_xyz(text, "fuzz.xyz");
    if (hash(parse_xyz(text, "again.xyz").state) != hash(frame.state)) std::abort();
    xyz::Reader reader(TextReader(text, "pieces.xyz"));
    xyz::Rows rows;
    while (reader.read(1 + size % 7, rows)) {
    }
    if (rows.disks.size() != frame.state.agents.size()) std::abort();
    validate(frame.state);
  } catch (Error const&) {
  }
  return 0;
}
