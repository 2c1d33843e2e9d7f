#pragma once

#include <functional>
#include <string>

#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// Does work on all ranks, which call it together. Contract: if ranks exchange messages in `work`, an error before a
/// message occurs on all ranks (not checked), since the others would wait for ever.
/// Errors: if `work` throws an Error, a RunFailure or std::bad_alloc on some rank, all ranks throw the error of the
/// first such rank.
void agree(Communicator& ranks, std::function<void()> const& work);

/// Does work on the root only; an error of the root is thrown on all ranks. All ranks call it.
void on_root(Communicator& ranks, std::function<void()> const& work);

/// Returns, on all ranks, the text of the first rank whose text is not empty.
std::string first_text_of_all(Communicator& ranks, std::string const& text);

/// Does work in which ranks exchange messages. An error on one rank ends all ranks, since the others wait for its
/// messages.
void do_or_abandon(Communicator& ranks, std::function<void()> const& work);

}  // namespace gridlock
