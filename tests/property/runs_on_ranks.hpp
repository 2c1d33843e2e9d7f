// Runs that ranks divide, here threads, and all that they write.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <variant>

#include "gridlock/io/h5md.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"
#include "thread_ranks.hpp"

namespace gridlock::test {

/// Carries out or continues a run, as one process or as some ranks; ends early at `stop_at`.
inline RunStatus carry_out(std::string const& text, std::filesystem::path const& directory, std::size_t ranks,
                           std::uint64_t stop_at = 0) {
  RunStatus status = RunStatus::failed;
  bool const is_there = std::filesystem::exists(directory / "config.resolved.toml");
  auto const work = [&](AllProcesses processes) {
    RunHooks hooks;
    hooks.processes = processes;
    hooks.threads = 1;
    if (stop_at > 0) hooks.on_progress = [&](Progress const& progress) { return progress.steps < stop_at; };
    if (is_there) {
      RunStatus const ended = resume_in(directory, hooks).status;
      if (processes.is_root()) status = ended;
    } else {
      Setup setup = set_up(SettingsFile::from_text(text, "run.toml"), {.threads = 1, .processes = processes});
      RunStatus const ended = run_in(directory, std::move(setup), hooks).status;
      if (processes.is_root()) status = ended;
    }
  };
  if (ranks == 0) {
    work({});
  } else {
    ThreadRanks(ranks).run([&](Communicator& root) { work(root); });
  }
  return status;
}

inline std::string without_timing(std::string const& summary) {
  std::string kept;
  bool is_timing = false;
  for (std::size_t at = 0; at < summary.size();) {
    std::size_t const end = std::min(summary.find('\n', at), summary.size());
    std::string const line = summary.substr(at, end - at);
    if (line.find("\"timing\"") != std::string::npos) is_timing = true;
    if (!is_timing) kept += line + '\n';
    if (line.starts_with("  }")) is_timing = false;
    at = end + 1;
  }
  return kept;
}

/// All results of a directory by their names; times are left out.
inline std::map<std::string, std::string> results_of(std::filesystem::path const& directory) {
  std::map<std::string, std::string> results;
  for (std::filesystem::directory_entry const& entry : std::filesystem::directory_iterator(directory)) {
    std::string const name = entry.path().filename().string();
    if (name.ends_with(".csv") || name.ends_with(".xyz")) results[name] = read_file(entry.path(), 1U << 28);
    if (name == "summary.json") results[name] = without_timing(read_file(entry.path(), 1U << 28));
  }
  H5mdReader const trajectory(directory / "trajectory.h5");
  for (std::size_t k = 0; k < trajectory.frame_count(); ++k) {
    H5mdFrame const frame = trajectory.frame(k);
    std::string text = std::to_string(frame.state_hash) + " " + std::to_string(frame.frame.clock.step);
    for (FrameColumn const& column : frame.frame.columns) {
      std::visit(
          [&](auto const& values) {
            text += column.name;
            text.append(reinterpret_cast<char const*>(values.data()), values.size() * sizeof(values[0]));
          },
          column.values);
    }
    results["frame " + std::to_string(k)] = text;
  }
  return results;
}

inline void expect_same_results(std::filesystem::path const& one, std::filesystem::path const& many,
                                std::string const& what) {
  auto const of_one = results_of(one);
  auto const of_many = results_of(many);
  ASSERT_EQ(of_one.size(), of_many.size()) << what;
  for (auto const& [name, content] : of_one) {
    ASSERT_TRUE(of_many.contains(name)) << what << ": " << name;
    ASSERT_TRUE(content == of_many.at(name)) << what << ": " << name << "\n"
                                             << content.substr(0, 2000) << "\n--\n"
                                             << of_many.at(name).substr(0, 2000);
  }
}

}  // namespace gridlock::test
