#include "gridlock/parallel/detail/agent_homes.hpp"

#include <algorithm>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/keys_at.hpp"

namespace gridlock {

namespace {

/// Rows of each process that leave at a time.
constexpr std::size_t rows_of_round = std::size_t{1} << 16;

void read_rows(std::span<std::byte const> bytes, RowsOfBytes const& rows) {
  for (; !bytes.empty(); bytes = bytes.subspan(rows.bytes_of_row)) rows.read(bytes.data());
}

}  // namespace

std::vector<Id> first_ids_of_blocks(AllProcesses processes, std::span<Id const> own) {
  Communicator& ranks = processes.communicator();
  std::size_t const blocks = processes.count();
  std::uint64_t const agents = processes.sum(own.size());
  std::vector<std::uint64_t> places(blocks);
  for (std::size_t b = 0; b < blocks; ++b) places[b] = (b * agents + blocks - 1) / blocks;
  return keys_at(
      places, highest_bit_of_all(ranks, own.empty() ? Id{0} : own.back()),
      [&](Id id) { return std::ranges::lower_bound(own, id) - own.begin(); },
      [&](std::span<std::uint64_t> counts) { processes.sum(counts); });
}

/// In rounds, so that messages stay short however much there is to send.
void exchange_rows(AllProcesses processes, RowsOfBytes const& rows) {
  Communicator& ranks = processes.communicator();
  std::size_t const self = ranks.rank();
  std::vector<std::uint64_t> arriving(ranks.count(), 0);
  for (std::size_t row = 0; row < rows.count; ++row) ++arriving[rows.process_of(row)];
  processes.sum(arriving);
  rows.reserve(arriving[self]);
  std::uint64_t const rounds = all_max(ranks, (std::uint64_t{rows.count} + rows_of_round - 1) / rows_of_round);
  std::vector<Message> leaving(ranks.count());
  for (std::uint64_t round = 0; round < rounds; ++round) {
    std::size_t const first = std::min<std::size_t>(round * rows_of_round, rows.count);
    std::size_t const end = std::min(first + rows_of_round, rows.count);
    for (std::size_t row = first; row < end; ++row) {
      Message& message = leaving[rows.process_of(row)];
      message.resize(message.size() + rows.bytes_of_row);
      rows.write(row, message.data() + message.size() - rows.bytes_of_row);
    }
    for (std::size_t rank = 0; rank < ranks.count(); ++rank) {
      if (rank != self) ranks.send(rank, std::exchange(leaving[rank], {}));
    }
    read_rows(std::exchange(leaving[self], {}), rows);
    for (std::size_t rank = 0; rank < ranks.count(); ++rank) {
      if (rank != self) read_rows(ranks.receive(rank), rows);
    }
  }
}

}  // namespace gridlock
