#include "gridlock/parallel/detail/agreement.hpp"

#include <fmt/format.h>

#include <exception>
#include <new>
#include <span>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

enum class Ending : std::uint64_t { good, error, failure };

/// The end of a rank's work, normal or by an exception, as a message to all ranks.
class EndOfWork {
 public:
  EndOfWork(Communicator const& ranks, std::function<void()> const& work) : rank_(ranks.rank()) {
    try {
      work();
    } catch (Error const& error) {
      note(Ending::error, error.problems());
    } catch (RunFailure const& failure) {
      note(Ending::failure, {{.what = failure.what()}});
    } catch (std::bad_alloc const&) {
      note(Ending::failure, {{.what = "not enough memory"}});
    }
  }

  [[nodiscard]] std::exception_ptr const& thrown() const { return thrown_; }
  [[nodiscard]] Message message() const {
    MessageWriter message;
    message.add(ending_);
    for (Problem const& problem : problems_) {
      for (std::string const* text : {&problem.what, &problem.hint, &problem.key, &problem.file, &problem.source_line})
        message.add_text(*text);
      message.add(problem.line);
      message.add(problem.column);
    }
    return message.take();
  }

  /// Throws the exception that another rank has thrown.
  static void rethrow(Message const& bytes) {
    MessageReader message(bytes);
    auto const ending = message.next<Ending>();
    std::vector<Problem> problems;
    while (!message.is_at_end()) {
      Problem& problem = problems.emplace_back();
      for (std::string* text : {&problem.what, &problem.hint, &problem.key, &problem.file, &problem.source_line})
        *text = message.next_text();
      problem.line = message.next<int>();
      problem.column = message.next<int>();
    }
    if (ending == Ending::error) throw Error(std::move(problems));
    if (ending == Ending::failure) throw RunFailure(problems.front().what);
  }

 private:
  void note(Ending ending, std::vector<Problem> problems) {
    ending_ = ending;
    problems_ = std::move(problems);
    thrown_ = std::current_exception();
    if (ending == Ending::failure && rank_ > 0)
      problems_[0].what = fmt::format("rank {}: {}", rank_, problems_[0].what);
  }

  std::size_t rank_;
  Ending ending_ = Ending::good;
  std::vector<Problem> problems_;
  std::exception_ptr thrown_;
};

/// Throws the exception of the first rank that has thrown one.
void fail_as(Communicator& ranks, std::vector<Message> const& ends, EndOfWork const& own) {
  ranks.note_agreement(false);
  for (std::size_t rank = 0; rank < ends.size(); ++rank) {
    if (MessageReader(ends[rank]).next<Ending>() == Ending::good) continue;
    ranks.note_agreement(true);
    // The root's own exception has more details than a message.
    if (rank == 0 && ranks.rank() == 0) std::rethrow_exception(own.thrown());
    EndOfWork::rethrow(ends[rank]);
  }
}

}  // namespace

void agree(Communicator& ranks, std::function<void()> const& work) {
  if (ranks.count() == 1) {
    work();
    return;
  }
  EndOfWork const own(ranks, work);
  fail_as(ranks, all_gather(ranks, own.message()), own);
}

void on_root(Communicator& ranks, std::function<void()> const& work) {
  if (ranks.count() == 1) {
    work();
    return;
  }
  bool const is_root = ranks.rank() == 0;
  EndOfWork const own(
      ranks, is_root ? work : [] {});
  std::vector<Message> of_root;
  of_root.push_back(broadcast(ranks, own.message()));
  fail_as(ranks, of_root, own);
}

std::string first_text_of_all(Communicator& ranks, std::string const& text) {
  for (Message const& bytes : all_gather(ranks, message_of_all(std::span<char const>(text)))) {
    if (!bytes.empty()) return {reinterpret_cast<char const*>(bytes.data()), bytes.size()};
  }
  return {};
}

void do_or_abandon(Communicator& ranks, std::function<void()> const& work) {
  try {
    work();
  } catch (std::bad_alloc const&) {
    ranks.abandon("not enough memory");
  } catch (std::exception const& error) {
    ranks.abandon(error.what());
  }
}

}  // namespace gridlock
