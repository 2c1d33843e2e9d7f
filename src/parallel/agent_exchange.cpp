#include "gridlock/parallel/detail/agent_exchange.hpp"

#include <algorithm>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "parallel/exchange.hpp"

namespace gridlock {

namespace {

/// Number of rows that each process sends in a round.
constexpr std::size_t rows_of_round = std::size_t{1} << 16;

void read_rows(std::span<std::byte const> bytes, RowsOfBytes const& rows) {
  for (; !bytes.empty(); bytes = bytes.subspan(rows.bytes_of_row)) rows.read(bytes.data());
}

/// An agent that needs a value, or a value for an agent; then the bytes of the value follow.
struct Sought {
  Id id;
  std::uint64_t process;  ///< process that sends this record
  std::uint64_t has_value;
};

}  // namespace

std::vector<Id> ids_of_rows(AllProcesses processes, RowDivision const& division, std::span<Id const> own,
                            std::span<std::uint32_t const> rows) {
  struct Question {
    Id id;  ///< Id of the agent, for the answer
    std::uint64_t row;
    std::uint64_t asker;
    std::uint64_t place;  ///< index of the row in the process that asks
  };
  Communicator& ranks = processes.communicator();
  std::uint64_t const self = ranks.rank();
  std::uint64_t const first = division.first(ranks.rank());
  std::vector<Id> ids(rows.size());
  std::vector<Question> asked;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (division.rank_of(rows[k]) == ranks.rank()) {
      ids[k] = own[rows[k] - first];
    } else {
      asked.push_back({.id = 0, .row = rows[k], .asker = self, .place = k});
    }
  }
  std::vector<Question> answered;
  exchange_values<Question>(
      ranks, asked.size(), [&](std::size_t k, auto give) { give(division.rank_of(asked[k].row), asked[k]); },
      [&](Question question) {
        question.id = own[question.row - first];
        answered.push_back(question);
      });
  exchange_values<Question>(
      ranks, answered.size(),
      [&](std::size_t k, auto give) { give(static_cast<std::size_t>(answered[k].asker), answered[k]); },
      [&](Question const& question) { ids[question.place] = question.id; });
  return ids;
}

void send_to_owners(AllProcesses processes, std::span<Id const> wait, ValuesOfAgents& values) {
  std::size_t const bytes = values.bytes_of_value;
  std::uint64_t const self = processes.communicator().rank();
  std::vector<Sought> waiting, looking;
  std::vector<std::byte> of_looking;
  std::size_t const leaving = values.ids.size();
  auto const id_of = [&](std::size_t k) { return k < leaving ? values.ids[k] : wait[k - leaving]; };
  exchange_rows(processes, {.count = leaving + wait.size(),
                            .bytes_of_row = sizeof(Sought) + bytes,
                            .process_of = [&](std::size_t k) { return directory_of(id_of(k), processes.count()); },
                            .write =
                                [&](std::size_t k, std::byte* to) {
                                  bool const has_value = k < leaving;
                                  Sought const one{.id = id_of(k), .process = self, .has_value = has_value ? 1U : 0U};
                                  std::memcpy(to, &one, sizeof(one));
                                  if (has_value) std::memcpy(to + sizeof(one), &values.values[k * bytes], bytes);
                                },
                            .reserve = [](std::uint64_t) {},
                            .read =
                                [&](std::byte const* from) {
                                  Sought one{};
                                  std::memcpy(&one, from, sizeof(one));
                                  (one.has_value != 0 ? looking : waiting).push_back(one);
                                  if (one.has_value == 0) return;
                                  of_looking.insert(of_looking.end(), from + sizeof(one), from + sizeof(one) + bytes);
                                }});
  std::ranges::sort(waiting, {}, &Sought::id);
  auto const owner_of = [&](Sought const& value) {
    auto const found = std::ranges::lower_bound(waiting, value.id, {}, &Sought::id);
    bool const is_owned = found != waiting.end() && found->id == value.id;
    return static_cast<std::size_t>(is_owned ? found->process : value.process);
  };
  values.ids.clear();
  values.values.clear();
  exchange_rows(processes, {.count = looking.size(),
                            .bytes_of_row = sizeof(Id) + bytes,
                            .process_of = [&](std::size_t k) { return owner_of(looking[k]); },
                            .write =
                                [&](std::size_t k, std::byte* to) {
                                  std::memcpy(to, &looking[k].id, sizeof(Id));
                                  std::memcpy(to + sizeof(Id), &of_looking[k * bytes], bytes);
                                },
                            .reserve = [](std::uint64_t) {},
                            .read =
                                [&](std::byte const* from) {
                                  std::memcpy(&values.ids.emplace_back(), from, sizeof(Id));
                                  values.values.insert(values.values.end(), from + sizeof(Id),
                                                       from + sizeof(Id) + bytes);
                                }});
}

/// Exchanges rows in rounds, so that messages stay short.
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
