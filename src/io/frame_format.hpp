#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "gridlock/core/frame_source.hpp"
#include "gridlock/io/h5md.hpp"

namespace gridlock {

/// Writes the frames of a trajectory one after the other, from a run or from a trajectory that is converted.
class FrameWriter {
 public:
  FrameWriter() = default;
  FrameWriter(FrameWriter const&) = delete;
  FrameWriter& operator=(FrameWriter const&) = delete;
  virtual ~FrameWriter() = default;

  /// Adds a frame with its observables and state hash; a format may leave these out. Errors: RunFailure if writing
  /// fails.
  virtual void write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash) = 0;
  /// Completes the file after the last frame, for formats whose file is not complete after each frame.
  virtual void finish() {}

  // The next two functions are called only for formats with FrameFormat::append.

  /// Returns the step of the last frame.
  [[nodiscard]] virtual std::optional<std::uint64_t> last_step() const { return std::nullopt; }
  /// Returns the state hash of the frame at a step; nothing if there is no such frame.
  [[nodiscard]] virtual std::optional<std::uint64_t> state_hash_at(std::uint64_t /*step*/) const {
    return std::nullopt;
  }
};

/// A format of trajectories, found by name or extension. Only the format's own source file contains its name.
struct FrameFormat {
  std::string_view name;          ///< "vtk", for `gridlock export --to`
  std::string_view extension;     ///< ".pvd"
  std::string_view readers = {};  ///< programs that read the format, for the help
  bool is_exported = true;        ///< whether `gridlock export` offers it
  /// Returns the path of the file for one frame; null for formats with all frames in a single file.
  std::filesystem::path (*file_of_step)(std::filesystem::path const& file, std::uint64_t step) = nullptr;
  std::unique_ptr<FrameWriter> (*create)(std::filesystem::path const& file, H5mdSettings const& header) = nullptr;
  /// Continues a file with frames of these columns. Null for formats that a run cannot write, since a run must be able
  /// to continue after a kill. Errors: Error if the file cannot be continued.
  std::unique_ptr<FrameWriter> (*append)(std::filesystem::path const& file, FrameSource const& first) = nullptr;
  /// Returns the settings of the run that wrote a file, as TOML; null if `append` is null.
  std::string (*configuration_of)(std::filesystem::path const& file) = nullptr;
};

/// Returns all formats of trajectories.
std::span<FrameFormat const> frame_formats();
/// Returns the format with this name. Errors: Error if there is none.
FrameFormat const& frame_format(std::string_view name);
/// Returns the format of a run's trajectory, by the file's extension. Errors: Error if runs do not write it.
FrameFormat const& frame_format_of_run(std::filesystem::path const& file);

}  // namespace gridlock
