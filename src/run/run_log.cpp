#include "run/run_log.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <utility>

namespace gridlock {

RunLog::RunLog(std::filesystem::path const& directory, std::function<void(std::string const&)> on_note)
    : file_(directory / "run.log", std::ios::app), on_note_(std::move(on_note)) {}

void RunLog::note(std::string const& text) {
  file_ << fmt::format("{:%Y-%m-%dT%H:%M:%SZ}  {}\n", fmt::gmtime(std::time(nullptr)), text) << std::flush;
  if (on_note_) on_note_(text);
}

}  // namespace gridlock
