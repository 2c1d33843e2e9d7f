#include "gridlock/core/error.hpp"

#include <utility>

namespace gridlock {

namespace {

std::string to_text(std::vector<Problem> const& problems) {
  std::string text;
  for (Problem const& problem : problems) {
    if (!text.empty()) text += '\n';
    text += gridlock::to_text(problem);
  }
  return text;
}

}  // namespace

std::string to_text(Problem const& problem) {
  std::string text = problem.what;
  if (!problem.file.empty()) {
    text += "\n  --> " + problem.file;
    if (problem.line > 0) text += ":" + std::to_string(problem.line);
    if (problem.line > 0 && problem.column > 0) text += ":" + std::to_string(problem.column);
    if (!problem.source_line.empty()) text += "   " + problem.source_line;
  }
  if (!problem.hint.empty()) text += "\n  hint: " + problem.hint;
  return text;
}

Error::Error(Problem problem) : Error(std::vector<Problem>{std::move(problem)}) {}

Error::Error(std::vector<Problem> problems) : std::runtime_error(to_text(problems)), problems_(std::move(problems)) {}

}  // namespace gridlock
