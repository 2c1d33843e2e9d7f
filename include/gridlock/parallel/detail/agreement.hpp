#pragma once

#include <functional>
#include <string>

#include "gridlock/parallel/communicator.hpp"

namespace gridlock {

/// Does some work on all ranks, which call it together. Contract: where they send messages in between, what keeps one
/// from its next message keeps all (not checked), or others wait for it for ever.
/// Errors: Error on all of them where there is one on any, that of the first.
void agree_on_errors(Communicator& ranks, std::function<void()> const& work);

/// The first text of any rank that is not empty, for all.
std::string first_text_of_all(Communicator& ranks, std::string const& text);

}  // namespace gridlock
