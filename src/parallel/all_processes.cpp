#include "gridlock/parallel/detail/all_processes.hpp"

#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

AllProcesses::AllProcesses() : AllProcesses(Communicator::alone()) {}

std::size_t AllProcesses::count() const { return communicator_->count(); }

void AllProcesses::sum(std::span<ExactSum> sums) const { all_sum(*communicator_, sums); }

void AllProcesses::sum(std::span<std::uint64_t> counts) const { all_sum(*communicator_, counts); }

double AllProcesses::min(double value) const { return all_min(*communicator_, value); }

}  // namespace gridlock
