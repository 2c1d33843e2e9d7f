// What a table of comma-separated values may hold. A table that is accepted reads back the same when it is written out.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "gridlock/core/error.hpp"
#include "gridlock/io/table.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* data, std::size_t size) {
  using namespace gridlock;
  std::string_view const text(reinterpret_cast<char const*>(data), size);
  try {
    std::string const written = to_csv(parse_csv(text, "fuzz.csv"));
    if (to_csv(parse_csv(written, "written.csv")) != written) std::abort();
  } catch (Error const&) {
  }
  return 0;
}
