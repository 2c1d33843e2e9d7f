#include "gridlock/parallel/detail/row_division.hpp"

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

RowDivision division_of(AllProcesses processes, std::size_t own) {
  std::vector<std::uint64_t> begins{0};
  for (Message const& bytes : all_gather(processes.communicator(), message_of(std::uint64_t{own}))) {
    begins.push_back(begins.back() + MessageReader(bytes).next<std::uint64_t>());
  }
  return RowDivision(std::move(begins));
}

}  // namespace gridlock
