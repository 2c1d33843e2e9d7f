#include <fmt/format.h>

#include <memory>

#include "gridlock/run/configuration.hpp"
#include "verbs.hpp"

namespace gridlock::cli {

void add_explain(CLI::App& app, ExitCode& exit_code) {
  struct ExplainOptions {
    std::string key;
    bool as_markdown = false;
  };
  CLI::App* const verb = app.add_subcommand("explain", "Explain a setting, a table of settings, or all of them");
  auto const options = std::make_shared<ExplainOptions>();
  verb->add_option("KEY", options->key, "A setting such as disks.packing_fraction, or a table such as disks");
  verb->add_flag("--markdown", options->as_markdown, "All settings as the reference page in docs/");
  verb->callback([options, &exit_code] {
    gridlock::Configuration configuration;
    auto const describe = gridlock::describing(configuration);
    fmt::print("{}", options->as_markdown
                         ? "# Settings\n\nEvery setting of a configuration, as `gridlock explain --markdown` "
                           "prints them.\n\n" +
                               gridlock::reference_markdown(describe)
                         : gridlock::explain(describe, options->key));
    exit_code = ExitCode::good;
  });
}

}  // namespace gridlock::cli
