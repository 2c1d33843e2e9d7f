#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/domain.hpp"

namespace gridlock {

/// Cells that processes lend to another process, which takes turns of late agents while all others wait. `Cells` has
/// add_cells(message, cells), which writes cells to a message, and take_cells(message), which replaces cells by those
/// of a message.
template <class Cells>
class LentCells {
 public:
  LentCells(Domain const& domain, Cells& cells) : domain_(domain), cells_(cells) {}

  /// Fetches cells from the processes that own them.
  void borrow(std::span<int const> cells) {
    std::vector<std::vector<int>> const asked = by_owner(cells);
    for (std::size_t owner = 0; owner < asked.size(); ++owner) {
      if (asked[owner].empty()) continue;
      MessageWriter message;
      message.add(Word::send_cells);
      message.add_all(std::span<int const>(asked[owner]));
      processes().send(owner, message.take());
    }
    for (std::size_t owner = 0; owner < asked.size(); ++owner) {
      if (asked[owner].empty()) continue;
      Message const bytes = processes().receive(owner);
      MessageReader message(bytes);
      cells_.take_cells(message);
    }
  }

  /// Sends the cells back to their owners, and tells all processes that the turns are over.
  void give_back(std::span<int const> cells, bool have_failed) {
    std::vector<std::vector<int>> const borrowed = by_owner(cells);
    for (std::size_t owner = 0; owner < borrowed.size(); ++owner) {
      if (owner == processes().rank()) continue;
      MessageWriter message;
      message.add(Word::turns_are_over);
      message.add(have_failed ? std::uint64_t{1} : 0);
      cells_.add_cells(message, borrowed[owner]);
      processes().send(owner, message.take());
    }
  }

  /// Lends cells to `process` until it has taken its turns. Returns whether one of the turns has failed.
  bool lend_to(std::size_t process) {
    while (true) {
      Message const bytes = processes().receive(process);
      MessageReader message(bytes);
      if (message.next<Word>() == Word::send_cells) {
        MessageWriter answer;
        cells_.add_cells(answer, message.rest<int>());
        processes().send(process, answer.take());
        continue;
      }
      bool const have_failed = message.next<std::uint64_t>() != 0;
      cells_.take_cells(message);
      return have_failed;
    }
  }

 private:
  enum class Word : std::uint64_t { send_cells, turns_are_over };

  [[nodiscard]] Communicator& processes() const { return domain_.processes(); }
  [[nodiscard]] std::vector<std::vector<int>> by_owner(std::span<int const> cells) const {
    std::vector<std::vector<int>> of_owner(processes().count());
    for (int const cell : cells) of_owner[domain_.owner_of_cell(cell)].push_back(cell);
    return of_owner;
  }

  Domain const& domain_;
  Cells& cells_;
};

}  // namespace gridlock
