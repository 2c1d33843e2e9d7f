#include "browser.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>

namespace gridlock::view {

namespace {

/// Returns whether a desktop is running. Without one, xdg-open would start a text browser within this program's output.
bool has_desktop() {
  return std::ranges::any_of(std::array{"DISPLAY", "WAYLAND_DISPLAY"}, [](char const* name) {
    char const* const value = std::getenv(name);
    return value != nullptr && *value != '\0';
  });
}

/// Forks again, so that the browser needs no waiting parent, and cuts it off from signals and output of this program.
[[noreturn]] void become_browser(char const* address) {
  setsid();
  if (fork() != 0) _exit(0);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  int const nowhere = open("/dev/null", O_RDWR);
  for (int const stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, stream);
  execlp("xdg-open", "xdg-open", address, nullptr);
  _exit(127);
}

}  // namespace

void open_browser(std::string const& address) {
  if (!has_desktop()) return;
  pid_t const child = fork();
  if (child == 0) become_browser(address.c_str());
  if (child > 0) waitpid(child, nullptr, 0);
}

}  // namespace gridlock::view
