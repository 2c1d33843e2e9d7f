#include "on_ranks.hpp"

#include <limits>

#include "engine/ranks.hpp"
#include "engine/tiled/on_ranks.hpp"
#include "terminal.hpp"
#include "workspace/sweep_crew.hpp"

namespace gridlock::cli {

namespace {

/// Lets the others go, however the work ends.
class Lead {
 public:
  explicit Lead(SweepCrew& crew) : crew_(crew) {}
  ~Lead() {
    if (crew_.ranks() != nullptr) tiled::release_helpers(*crew_.ranks());
    crew_.part();
  }
  Lead(Lead const&) = delete;
  Lead& operator=(Lead const&) = delete;

 private:
  SweepCrew& crew_;
};

}  // namespace

ExitCode carry_out(CrewOptions const* options, std::function<ExitCode(Ranks*)> const& work) {
  if (options == nullptr) return work(nullptr);
  options->set_ranks_of_run(std::numeric_limits<std::size_t>::max());
  SweepCrew& crew = options->crew;
  crew.meet(0, "");
  if (crew.leads()) {
    Lead const lead(crew);
    return work(crew.ranks());
  }
  // A request to stop is the leader's to carry out.
  StopSignals const signals;
  tiled::help(*crew.ranks());
  crew.part();
  return ExitCode::good;
}

}  // namespace gridlock::cli
