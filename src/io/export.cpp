#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/frame_format.hpp"

namespace gridlock {

namespace fs = std::filesystem;

FrameFormat xyz_frames();
FrameFormat vtk_frames();
FrameFormat csv_frames();
FrameFormat h5md_frames();

/// Lists all formats of trajectories. A new format needs an entry here, a declaration above and a file of its own.
std::span<FrameFormat const> frame_formats() {
  static std::array const formats{xyz_frames(), vtk_frames(), csv_frames(), h5md_frames()};
  return formats;
}

FrameFormat const& frame_format(std::string_view name) {
  auto const found = std::ranges::find(frame_formats(), name, &FrameFormat::name);
  if (found != frame_formats().end()) return *found;
  std::vector<std::string_view> names;
  std::ranges::transform(frame_formats(), std::back_inserter(names), &FrameFormat::name);
  throw Error({.what = fmt::format("there is no format \"{}\" of trajectories", name),
               .hint = fmt::format("a format is one of: {}", fmt::join(names, ", "))});
}

FrameFormat const& frame_format_of_run(fs::path const& file) {
  auto const found = std::ranges::find_if(frame_formats(), [&](FrameFormat const& format) {
    return format.append != nullptr && file.extension() == format.extension;
  });
  if (found != frame_formats().end()) return *found;
  throw Error({.what = fmt::format("a run cannot write its frames into {}", file.string()),
               .hint = "name a file of H5MD, such as trajectory.h5"});
}

std::vector<fs::path> exported_files(H5mdReader const& trajectory, ExportSettings const& settings) {
  std::vector<fs::path> files{settings.file};
  auto const file_of_step = frame_format(settings.format).file_of_step;
  if (file_of_step == nullptr) return files;
  for (std::size_t k = 0; k < trajectory.frame_count(); k += settings.every)
    files.push_back(file_of_step(settings.file, trajectory.clocks()[k].step));
  return files;
}

std::vector<fs::path> export_trajectory(H5mdReader const& trajectory, ExportSettings const& settings) {
  auto const writer = frame_format(settings.format).create(settings.file, trajectory.settings());
  for (std::size_t k = 0; k < trajectory.frame_count(); k += settings.every) {
    H5mdFrame const frame = trajectory.frame(k);
    writer->write(*frame_source_of(frame.frame), frame.observables, frame.state_hash);
  }
  writer->finish();
  return exported_files(trajectory, settings);
}

}  // namespace gridlock
