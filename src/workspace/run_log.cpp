#include "workspace/run_log.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <system_error>
#include <utility>

#include "io/file.hpp"

namespace gridlock {

RunLog::RunLog(std::filesystem::path const& directory, std::function<void(Event const&)> on_event,
               AllProcesses processes)
    : processes_(processes), path_(directory / "run.log"), on_event_(std::move(on_event)) {}

void RunLog::write(Event const& event) {
  if (!processes_.is_root()) return;
  if (!file_.is_open()) {
    // Opening a pipe would wait for a reader.
    std::error_code ignored;
    if (std::filesystem::exists(path_, ignored)) require_regular_file(path_);
    file_.open(path_, std::ios::app);
  }
  file_ << fmt::format("{:%Y-%m-%dT%H:%M:%SZ}  {}\n", fmt::gmtime(std::time(nullptr)), to_text(event)) << std::flush;
  if (on_event_) on_event_(event);
}

}  // namespace gridlock
