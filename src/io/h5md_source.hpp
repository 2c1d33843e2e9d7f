#pragma once

#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "gridlock/io/h5md.hpp"
#include "io/hdf5.hpp"

namespace gridlock::h5md {

/// The interface by which H5mdReader reads frames that Gridlock or another program wrote.
class Source {
 public:
  Source() = default;
  virtual ~Source() = default;
  Source(Source const&) = delete;
  Source& operator=(Source const&) = delete;

  [[nodiscard]] virtual H5mdSettings const& settings() const = 0;
  [[nodiscard]] virtual std::vector<Clock> const& clocks() const = 0;
  [[nodiscard]] virtual std::vector<std::string> column_names() const = 0;
  [[nodiscard]] virtual H5mdFrame frame(std::size_t k) const = 0;
  [[nodiscard]] virtual std::vector<double> observable(std::size_t k) const = 0;
  [[nodiscard]] virtual std::optional<FrameContacts> contacts() const = 0;
};

/// Opens a trajectory of another program. Errors: Error naming the file.
std::unique_ptr<Source> open_other(std::filesystem::path const& path);

/// Largest ratio of unpacked to packed bytes for deflate. A size above it is damaged, and must not exhaust the memory.
inline constexpr std::uint64_t max_deflation = 1032;

inline constexpr char const* hint_for_trajectory = "is it a trajectory in H5MD, and whole?";

[[noreturn]] void refuse(std::filesystem::path const& path, std::string const& reason,
                         char const* hint = hint_for_trajectory);

/// Calls `work`, and turns a failure of HDF5 into an Error that names the file.
template <class Work>
auto guarded(std::filesystem::path const& path, Work const& work, char const* hint = hint_for_trajectory) {
  std::string reason;
  try {
    return work();
  } catch (hdf5::Failure const& failure) {
    reason = hdf5::shortness_of(path);
    if (reason.empty()) reason = failure.what();
  } catch (std::bad_alloc const&) {
    reason = "a frame of it does not fit into the memory";
  } catch (std::length_error const&) {
    reason = "a frame of it does not fit into the memory";
  }
  refuse(path, reason, hint);
}

}  // namespace gridlock::h5md
