#include "on_ranks.hpp"

#include <limits>

#include "terminal.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock::cli {

namespace {

/// Lets the others go, however the work ends.
class Lead {
 public:
  explicit Lead(SweepCrew& crew) : crew_(crew) {}
  ~Lead() { crew_.part(); }
  Lead(Lead const&) = delete;
  Lead& operator=(Lead const&) = delete;

 private:
  SweepCrew& crew_;
};

}  // namespace

ExitCode carry_out(CrewOptions const* options, std::function<ExitCode(AllProcesses)> const& work) {
  if (options == nullptr) return work({});
  options->set_ranks_of_run(std::numeric_limits<std::size_t>::max());
  SweepCrew& crew = options->crew;
  crew.meet(options->command_hash, "");
  if (crew.leads()) {
    Lead const lead(crew);
    return work(crew.processes());
  }
  // The leader answers a request to stop.
  StopSignals const signals;
  crew.help({});
  return ExitCode::good;
}

}  // namespace gridlock::cli
