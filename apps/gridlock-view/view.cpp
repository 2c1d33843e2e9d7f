#include "view.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <thread>

#include "browser.hpp"
#include "contents.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/other_program.hpp"
#include "server.hpp"
#include "site.hpp"

namespace gridlock::view {

namespace {

namespace fs = std::filesystem;
using cli::ExitCode;

/// The default port, so that the address is usually the same; a free port if another program uses it.
constexpr int usual_port = 8642;

struct Options {
  std::string path;
  std::string page;
  std::uint64_t port = 0;
  bool opens_no_browser = false;
};

bool has_page(fs::path const& directory) {
  std::error_code ignored;
  return fs::is_regular_file(directory / "index.html", ignored);
}

/// Returns the directory of the built page: `asked`, or else that of this installation or of the build directory.
fs::path find_page(std::string const& asked) {
  std::string const hint =
      "the packages and the wheel that ./dev makes have it; in the sources of Gridlock, ./dev build-web makes it alone";
  if (!asked.empty()) {
    if (has_page(asked)) return asked;
    throw Error({.what = fmt::format("there is no index.html in {}", asked), .hint = hint, .key = "--page"});
  }
  for (fs::path const& place :
       {cli::program_directory() / "../share/gridlock/web", cli::program_directory() / "../../../build-web/page"}) {
    if (has_page(place)) return place;
  }
  throw Error({.what = "the page that shows runs is not built", .hint = hint});
}

int bind(Server& server, std::uint64_t asked) {
  int port = server.bind(asked == 0 ? usual_port : static_cast<int>(asked));
  int const why = errno;
  if (port == 0 && asked == 0) port = server.bind(0);
  if (port != 0) return port;
  throw Error({.what = why == EACCES ? fmt::format("port {} may be taken by the administrator alone", asked)
                                     : fmt::format("port {} is in use", asked),
               .hint = "leave --port out, and a free one is found",
               .key = "--port"});
}

/// Blocks the signals that stop the server in this thread and those it starts, so that wait() receives them.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&signals_);
    for (int const number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals_, number);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
  }
  void wait() const {
    int number = 0;
    while (sigwait(&signals_, &number) != 0) {
    }
  }

 private:
  sigset_t signals_{};
};

/// Raises the limit of open files, since each connection counts as a file and the usual limit may be too low.
void raise_limit_of_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 && name[0] != '\0' ? name : "HOST";
}

std::string user_name() {
  char const* const name = std::getenv("USER");
  return name != nullptr && *name != '\0' ? name : "USER";
}

void print_address(std::string const& shown, int port) {
  fmt::print(
      "{} is shown at\n"
      "  http://127.0.0.1:{}/\n"
      "From another machine, first run there\n"
      "  ssh -N -L {}:127.0.0.1:{} {}@{}\n"
      "Ctrl-C stops.\n",
      shown, port, port, port, user_name(), host_name());
  std::fflush(stdout);
}

ExitCode view(Options const& options) {
  StopSignals const signals;
  Contents const contents(options.path);
  Site site(contents, find_page(options.page));
  Server server(
      [&site](httplib::Request const& request, httplib::Response& response) { site.answer(request, response); });
  raise_limit_of_files();
  int const port = bind(server, options.port);
  print_address(contents.name(), port);
  std::thread serving([&server] { server.serve(); });
  if (!options.opens_no_browser) open_browser(fmt::format("http://127.0.0.1:{}/", port));
  signals.wait();
  server.stop();
  serving.join();
  return ExitCode::good;
}

}  // namespace

void add_view(CLI::App& app, ExitCode& exit_code) {
  CLI::App* const verb =
      app.add_subcommand("view", "Show a run, a sweep or a file in the browser, also while it is written");
  auto const options = std::make_shared<Options>();
  verb->add_option("PATH", options->path, "Directory of a run or a sweep, an .h5 or .xyz file")->required();
  verb->add_option("--port", options->port,
                   fmt::format("Port of this machine; left out: {}, or a free one", usual_port))
      ->check(cli::whole_number(1, 65535));
  verb->add_flag("--no-open", options->opens_no_browser, "Print the address, and open no browser");
  verb->add_option("--page", options->page, "Directory of the page, where it is not the one built with this program")
      ->type_name("DIR");
  verb->callback([options, &exit_code] { exit_code = view(*options); });
}

}  // namespace gridlock::view
