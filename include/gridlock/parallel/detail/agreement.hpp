#pragma once

#include <functional>
#include <string>

#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// Does some work on all ranks, which call it together. Contract: where they send messages in between, what keeps one
/// from its next message keeps all (not checked), or others wait for it for ever.
/// Errors: where there is an Error or a RunFailure on some rank, or not enough memory, that of the first such rank on
/// all of them.
void agree(Communicator& ranks, std::function<void()> const& work);

/// The same with work of the root alone. All call it.
void on_root(Communicator& ranks, std::function<void()> const& work);

/// The first text of any rank that is not empty, for all.
std::string first_text_of_all(Communicator& ranks, std::string const& text);

/// Does work in which ranks exchange messages. Others wait for a rank that fails here, so all end with it.
void do_or_abandon(Communicator& ranks, std::function<void()> const& work);

}  // namespace gridlock
