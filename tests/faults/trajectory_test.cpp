#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/random.hpp"
#include "gridlock/io/h5md.hpp"
#include "unit/io/temporary_directory.hpp"

namespace gridlock {
namespace {

/// Agents in frame k of a trajectory.
using AgentCount = std::size_t (*)(std::uint64_t k);

std::size_t hundreds(std::uint64_t k) { return 200 + k % 50; }
std::size_t few(std::uint64_t k) { return 3 + k % 2; }

H5mdFrame frame_at(std::uint64_t step, AgentCount agents_at = hundreds) {
  RandomStream random(3, step, 0, Purpose::start_position);
  std::size_t const agents = agents_at(step);
  H5mdFrame result{.frame = {.box = Box(1.0, 1.0, Edge::wall), .clock = {step, 0.1 * static_cast<double>(step)}},
                   .observables = {static_cast<double>(step)},
                   .state_hash = step};
  for (std::size_t i = 0; i < agents; ++i) result.frame.ids.push_back(i);
  for (char const* name : {"x", "y", "velocity_x", "velocity_y", "radius", "mass"}) {
    std::vector<double> values;
    for (std::size_t i = 0; i < agents; ++i) values.push_back(static_cast<double>(random.bits()));
    result.frame.columns.push_back({name, std::move(values)});
  }
  return result;
}

/// A process of its own that adds frames as fast as it can and tells the number of those that are there through a pipe.
class WriterProcess {
 public:
  struct Work {
    AgentCount agents_at = hundreds;
    std::uint64_t frames = std::numeric_limits<std::uint64_t>::max();  ///< after which it ends with code 0
  };

  WriterProcess(std::filesystem::path const& file, bool appends, std::function<void()> const& prepare = {})
      : WriterProcess(file, appends, Work{}, prepare) {}
  WriterProcess(std::filesystem::path const& file, bool appends, Work const& work,
                std::function<void()> const& prepare = {}) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    process_ = fork();
    if (process_ == 0) {
      close(ends[0]);
      if (prepare) prepare();
      _exit(write_frames(file, appends, work, ends[1]));
    }
    close(ends[1]);
    from_ = ends[0];
  }
  WriterProcess(WriterProcess const&) = delete;
  WriterProcess& operator=(WriterProcess const&) = delete;
  ~WriterProcess() { close(from_); }

  void kill() const { ::kill(process_, SIGKILL); }
  /// How it ended, after which every frame it told of is counted.
  int wait() {
    std::uint64_t count = 0;
    while (read(from_, &count, sizeof count) == sizeof count) frames_ = count;
    int status = 0;
    waitpid(process_, &status, 0);
    return status;
  }
  [[nodiscard]] std::uint64_t frames() const { return frames_; }
  /// Waits until it tells of a frame, and returns how many there are then; nothing once it has ended.
  std::optional<std::uint64_t> next_told() {
    std::uint64_t count = 0;
    if (read(from_, &count, sizeof count) != sizeof count) return std::nullopt;
    frames_ = count;
    return count;
  }

 private:
  static int write_frames(std::filesystem::path const& file, bool appends, Work const& work, int to) {
    try {
      H5mdFrame const first = frame_at(0, work.agents_at);
      H5mdWriter writer = appends ? H5mdWriter::append(file, first.frame)
                                  : H5mdWriter::create(file, {.observables = {{"step", ""}}}, first.frame);
      while (writer.frame_count() < work.frames) {
        std::uint64_t const count = writer.frame_count() + 1;
        writer.write(frame_at(count - 1, work.agents_at));
        if (::write(to, &count, sizeof count) != sizeof count) return 3;
      }
      return 0;
    } catch (RunFailure const&) {
      return 1;
    } catch (...) {
      return 2;
    }
  }

  pid_t process_ = 0;
  int from_ = -1;
  std::uint64_t frames_ = 0;
};

void expect_frames(std::filesystem::path const& file, std::uint64_t told) {
  H5mdReader const reader(file);
  ASSERT_GE(reader.frame_count(), told);
  for (std::size_t k = 0; k < reader.frame_count(); ++k) {
    H5mdFrame const read = reader.frame(k);
    ASSERT_EQ(read.frame, frame_at(k).frame) << "frame " << k;
    ASSERT_EQ(read.observables, frame_at(k).observables);
  }
}

int rounds(char const* name, int usual) {
  char const* const given = std::getenv(name);
  return given == nullptr ? usual : std::atoi(given);
}

// GRIDLOCK_KILLS=500 for more.
TEST(TrajectoryFaults, NoFrameIsLostByAKillAtAnyMomentAndTheNextWriterGoesOn) {
  int const kills = rounds("GRIDLOCK_KILLS", 40);
  RandomStream random(static_cast<std::uint64_t>(kills), 0, 0, Purpose::start_position);
  TemporaryDirectory const directory;
  std::uint64_t told = 0;
  for (int k = 0; k < kills; ++k) {
    // Begins anew from time to time, so that the files stay short, and where a writer was killed before there was a
    // file.
    bool const appends = k % 10 != 0 && std::filesystem::exists(directory / "t.h5");
    WriterProcess writer(directory / "t.h5", appends);
    std::this_thread::sleep_for(std::chrono::microseconds(5'000 + random.below(40'000)));
    writer.kill();
    ASSERT_TRUE(WIFSIGNALED(writer.wait()));
    told = appends ? std::max(told, writer.frames()) : writer.frames();
    if (!std::filesystem::exists(directory / "t.h5")) continue;
    if (!appends && told == 0) continue;  // the file of the round before may still stand there
    expect_frames(directory / "t.h5", told);
  }
}

TEST(TrajectoryFaults, EveryFrameToldOfIsReadWhileTheWriterGoesOn) {
  TemporaryDirectory const directory;
  WriterProcess writer(directory / "t.h5", false);
  std::size_t most = 0;
  for (int look = 0; look < 40; ++look) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!std::filesystem::exists(directory / "t.h5")) continue;
    H5mdReader const reader(directory / "t.h5");
    ASSERT_GE(reader.frame_count(), most);
    most = reader.frame_count();
    for (std::size_t k = most > 5 ? most - 5 : 0; k < most; ++k) ASSERT_EQ(reader.frame(k).frame, frame_at(k).frame);
  }
  EXPECT_GT(most, 10U);
  writer.kill();
  writer.wait();
}

// GRIDLOCK_FRAMES for another number.
TEST(TrajectoryFaults, AReaderThatNeverRestsSeesEveryFrameOfAWriterThatNeverRests) {
  auto const frames = static_cast<std::uint64_t>(rounds("GRIDLOCK_FRAMES", 4'000));
  TemporaryDirectory const directory;
  WriterProcess writer(directory / "t.h5", false, {.agents_at = few, .frames = frames});
  ASSERT_EQ(writer.next_told(), 1U);
  // Listens meanwhile: a pipe that nobody empties stops the writer.
  std::future<int> ending = std::async(std::launch::async, [&] { return writer.wait(); });
  std::size_t most = 0;
  std::size_t looks = 0;
  for (; most < frames; ++looks) {
    H5mdReader const reader(directory / "t.h5");
    ASSERT_GE(reader.frame_count(), std::max<std::size_t>(most, 1));
    most = reader.frame_count();
    ASSERT_EQ(reader.frame(most - 1).frame, frame_at(most - 1, few).frame);
  }
  EXPECT_EQ(ending.get(), 0);
  EXPECT_GT(looks, frames / 20) << "looks so rare hardly ever meet a write";
}

TEST(TrajectoryFaults, AFullDiskEndsTheWriterAndLosesNothing) {
  for (rlim_t const size : {60'000, 200'000, 333'333, 500'000}) {
    TemporaryDirectory const directory;
    WriterProcess writer(directory / "t.h5", false, [size] {
      rlimit const limit{size, size};
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_IGN);
    });
    int const status = writer.wait();
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 1) << status;
    if (writer.frames() > 0) expect_frames(directory / "t.h5", writer.frames());
  }
}

}  // namespace
}  // namespace gridlock
