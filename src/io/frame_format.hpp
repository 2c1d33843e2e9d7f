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

/// Writes the frames of a trajectory one after the other: those of a run as they come, or those of a trajectory that is
/// turned into another format.
class FrameWriter {
 public:
  FrameWriter() = default;
  FrameWriter(FrameWriter const&) = delete;
  FrameWriter& operator=(FrameWriter const&) = delete;
  virtual ~FrameWriter() = default;

  /// Adds a frame with what H5mdFrame has beside it; a format leaves out what it has no place for.
  /// Errors: RunFailure where the file cannot be written.
  virtual void write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash) = 0;
  /// Makes the file whole after the last frame, where it is not whole after each.
  virtual void finish() {}

  // These are asked where FrameFormat::append exists.

  /// The step of the last frame.
  [[nodiscard]] virtual std::optional<std::uint64_t> last_step() const { return std::nullopt; }
  /// The state hash of the frame at that step, where there is one.
  [[nodiscard]] virtual std::optional<std::uint64_t> state_hash_at(std::uint64_t /*step*/) const {
    return std::nullopt;
  }
};

/// The record of a format of trajectories: nothing outside its own file compares its name.
struct FrameFormat {
  std::string_view name;          ///< "vtk", for `gridlock export --to`
  std::string_view extension;     ///< ".pvd"
  std::string_view readers = {};  ///< programs that read it, for the help
  bool is_exported = true;        ///< whether `gridlock export` offers it
  /// The file of one frame, where each has its own beside the one that lists them; null where one file has them all.
  std::filesystem::path (*file_of_step)(std::filesystem::path const& file, std::uint64_t step) = nullptr;
  std::unique_ptr<FrameWriter> (*create)(std::filesystem::path const& file, H5mdSettings const& header) = nullptr;
  /// Continues a file with frames of these columns. Null where a run cannot write the format: it has to continue after
  /// a kill. Errors: Error for a file that it cannot continue.
  std::unique_ptr<FrameWriter> (*append)(std::filesystem::path const& file, FrameSource const& first) = nullptr;
  /// The settings of the run that a file belongs to, as TOML; null as append().
  std::string (*configuration_of)(std::filesystem::path const& file) = nullptr;
};

/// Those of all formats.
std::span<FrameFormat const> frame_formats();
/// The one of that name. Errors: Error where there is none.
FrameFormat const& frame_format(std::string_view name);
/// The one that a run writes into a file of that name. Errors: Error where runs write no such files.
FrameFormat const& frame_format_of_run(std::filesystem::path const& file);

}  // namespace gridlock
