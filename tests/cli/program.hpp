#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace gridlock::test {

namespace fs = std::filesystem;

inline std::string text_of(fs::path const& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

inline void write(fs::path const& file, std::string const& text) { std::ofstream(file, std::ios::binary) << text; }

/// A fresh directory, gone with the test.
class Workplace {
 public:
  Workplace() {
    std::string name = (fs::temp_directory_path() / "gridlock-cli-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~Workplace() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Workplace(Workplace const&) = delete;
  Workplace& operator=(Workplace const&) = delete;

  [[nodiscard]] fs::path const& path() const { return path_; }
  [[nodiscard]] fs::path operator/(std::string const& name) const { return path_ / name; }

 private:
  fs::path path_;
};

struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// The program at work: started in a directory, its output in files there.
class Process {
 public:
  Process(std::string const& program, std::vector<std::string> arguments, fs::path directory)
      : directory_(std::move(directory)) {
    arguments.insert(arguments.begin(), program);
    id_ = fork();
    if (id_ != 0) return;
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    if (chdir(directory_.c_str()) != 0) _exit(126);
    redirect("/dev/null", O_RDONLY, STDIN_FILENO);
    redirect(".stdout", O_WRONLY | O_CREAT | O_TRUNC, STDOUT_FILENO);
    redirect(".stderr", O_WRONLY | O_CREAT | O_TRUNC, STDERR_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }

  [[nodiscard]] pid_t id() const { return id_; }
  void signal(int number) const { kill(id_, number); }

  /// Waits for the end; what the process used goes to `usage` where that is given.
  Outcome wait(rusage* usage = nullptr) const {
    int status = 0;
    wait4(id_, &status, 0, usage);
    return {.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            .out = text_of(directory_ / ".stdout"),
            .err = text_of(directory_ / ".stderr")};
  }

 private:
  static void redirect(char const* file, int flags, int descriptor) {
    int const opened = open(file, flags, 0644);
    dup2(opened, descriptor);
    close(opened);
  }

  fs::path directory_;
  pid_t id_ = -1;
};

inline Outcome gridlock(std::vector<std::string> arguments, fs::path const& directory) {
  return Process(GRIDLOCK_PROGRAM, std::move(arguments), directory).wait();
}

inline Outcome in(Workplace const& workplace, std::vector<std::string> arguments) {
  return gridlock(std::move(arguments), workplace.path());
}

/// Whether this build has the Python package, and with it the commands that are programs in Python.
inline bool has_python_commands() { return fs::exists(fs::path(GRIDLOCK_PROGRAM).parent_path() / "gridlock-plot"); }

inline void expect_good(Outcome const& outcome) { EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err; }

/// A settings file that takes a moment.
inline constexpr char const* small_run =
    "[disks]\ncount = 100\npacking_fraction = 0.6\n[engine]\ncells = 5\n[run]\nsteps = 400\n[observe]\nevery = 20\n";

/// Waits for a file that a process makes while it works.
inline void wait_for(fs::path const& file) {
  auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!fs::exists(file) && std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(fs::exists(file)) << file;
}

/// What is in a directory, without the output the tests redirect.
inline std::vector<std::string> contents(fs::path const& directory) {
  std::vector<std::string> names;
  for (auto const& entry : fs::directory_iterator(directory)) {
    std::string const name = entry.path().filename().string();
    if (name != ".stdout" && name != ".stderr") names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace gridlock::test
