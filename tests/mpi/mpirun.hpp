#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <cstdlib>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"

namespace gridlock::test {

inline std::vector<std::string> operator+(std::vector<std::string> words, std::vector<std::string> const& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// mpirun, whoever starts it, on more ranks than cores.
inline Process mpirun(Workplace const& workplace, std::vector<std::string> const& arguments) {
  setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
  setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
  // With the address sanitizer: what Open MPI itself leaks at its end.
  setenv("ASAN_OPTIONS", "detect_leaks=0", 1);
  return {GRIDLOCK_MPIEXEC, std::vector<std::string>{"--oversubscribe"} + arguments, workplace.path()};
}

inline Process start(Workplace const& workplace, int ranks, std::vector<std::string> const& arguments) {
  return mpirun(workplace, std::vector<std::string>{"-n", std::to_string(ranks), GRIDLOCK_MPI_PROGRAM} + arguments);
}

inline Outcome on_ranks(Workplace const& workplace, int ranks, std::vector<std::string> const& arguments) {
  return start(workplace, ranks, arguments).wait();
}

inline std::size_t occurrences(std::string const& text, std::string const& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

/// The processes that another one has started.
inline std::vector<pid_t> children_of(pid_t process) {
  std::string const id = std::to_string(process);
  std::istringstream names(text_of("/proc/" + id + "/task/" + id + "/children"));
  std::vector<pid_t> children;
  for (pid_t child = 0; names >> child;) children.push_back(child);
  return children;
}

/// The ranks, as soon as they are all there.
inline std::vector<pid_t> ranks_of(Process const& process, std::size_t count) {
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  std::vector<pid_t> ranks;
  while (ranks.size() < count && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ranks = children_of(process.id());
  }
  return ranks;
}

}  // namespace gridlock::test
