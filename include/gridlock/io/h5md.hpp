#pragma once

/// \file
/// Trajectories in H5MD: writing, reading and export.
///
/// ```cpp
/// H5mdReader const trajectory("trajectory.h5");
/// for (std::size_t k = 0; k < trajectory.frame_count(); ++k) {
///   Frame const frame = trajectory.frame(k).frame;
///   auto const& x = std::get<std::vector<double>>(frame.find("x")->values);
/// }
/// ```

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gridlock/core/frame.hpp"
#include "gridlock/core/frame_source.hpp"

namespace gridlock {

/// An observable of a trajectory: one number for each frame.
struct H5mdObservable {
  std::string name;
  std::string unit;  ///< empty for pure numbers
};

/// The description of a trajectory, written once at its beginning.
struct H5mdSettings {
  std::string agents = "disks";  ///< name of the group in /particles
  std::string configuration;     ///< resolved configuration of the run, TOML
  std::string version;           ///< version of the program that writes it
  std::string author;            ///< author of the run; empty: "N/A"
  std::vector<H5mdObservable> observables;
  /// Names of the values 0, 1, 2 … of a column, by the name of the column.
  std::map<std::string, std::vector<std::string>> value_names = {};
  std::uint64_t compression = 1;  ///< of values, 0: none, 1: fastest … 9: smallest
  /// The contacts of a start that is a packing; only for writing, see H5mdReader::contacts().
  std::optional<FrameContacts> contacts = {};
  std::string creator = "gridlock";        ///< the program that wrote it; empty if unknown
  std::vector<std::string> left_out = {};  ///< groups and quantities of another program's file that are not read
};

/// One frame of a trajectory, with observables and state hash.
struct H5mdFrame {
  Frame frame;
  std::vector<double> observables;  ///< one for each of H5mdSettings::observables; nan if not measured at this step
  std::uint64_t state_hash = 0;     ///< state hash of the whole state, even if the frame has only some columns
  double given_tilt = 0.0;          ///< of the edges; the box has the one below half a width with the same images
};

/// Writes a trajectory in H5MD 1.1, the open standard on top of HDF5, a frame at a time.
///
///     /h5md                                version, author, creator
///     /particles/<agents>/box              dimension 3, boundary, edges; agents are at z = 0 in a box of height 1
///     /particles/<agents>/position/value   [frame][agent][x y z]; velocity, image and every other pair of columns
///                                          "<name>_x", "<name>_y" alike
///     /particles/<agents>/radius/value     [frame][agent]; mass and every other column alike; value_names are an attribute
///     /particles/<agents>/id/value         agents in the order of the ids; absent ones have the fill value
///     …/step, …/time                       one pair of arrays, hard links everywhere
///     /observables/<name>/value            [frame]
///     /connectivity/contacts/value         [1][contact][two ids], at one step and time; force, [1][contact], beside it
///     /parameters                          configuration, version, seed, and for each frame state_hash and checksum
///
/// The number of agents may change from frame to frame, the columns may not. Values are chunked by frame and component,
/// shuffled and deflated, so that a column of zeros costs nothing. Reduced units stand in the attribute `reduced_unit`.
///
/// Between two frames the file is closed and complete: every reader of HDF5 may open it while the run continues. A
/// frame is written in the single-writer-multiple-reader mode of HDF5, so that the file stays readable in this mode
/// even if the process is killed while writing; append() then continues after the last complete frame. A power failure
/// can lose data that the operating system had not written to the disk.
/// Errors: RunFailure if the file cannot be written. Cost: docs/reference/trajectories.md; at most 10 MB of memory for
/// each core, for frames of any size.
class H5mdWriter {
 public:
  /// Creates a trajectory with the columns of `first`, without a frame. The file appears only when it is complete, and
  /// replaces an existing file.
  static H5mdWriter create(std::filesystem::path const& path, H5mdSettings const& settings, FrameSource const& first);
  static H5mdWriter create(std::filesystem::path const& path, H5mdSettings const& settings, Frame const& first) {
    return create(path, settings, *frame_source_of(first));
  }

  /// Continues a trajectory, and repairs it if its writer was killed. Errors: Error for a file that is no trajectory
  /// with these columns, or whose last frame is damaged or cut off; the file is then unchanged.
  static H5mdWriter append(std::filesystem::path const& path, FrameSource const& first);
  static H5mdWriter append(std::filesystem::path const& path, Frame const& first) {
    return append(path, *frame_source_of(first));
  }

  ~H5mdWriter();
  H5mdWriter(H5mdWriter&& other) noexcept;
  H5mdWriter& operator=(H5mdWriter&& other) noexcept;

  [[nodiscard]] std::size_t frame_count() const;
  /// Returns the step of the last frame.
  [[nodiscard]] std::optional<std::uint64_t> last_step() const;
  /// Returns the state hash of the frame at a step, if there is one.
  [[nodiscard]] std::optional<std::uint64_t> state_hash_at(std::uint64_t step) const;

  /// Adds a frame with its observables and state hash. Once it returns, a kill of the process cannot lose the frame.
  void write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash);
  void write(H5mdFrame const& frame) { write(*frame_source_of(frame.frame), frame.observables, frame.state_hash); }

 private:
  class Trajectory;
  explicit H5mdWriter(std::unique_ptr<Trajectory> trajectory);
  std::unique_ptr<Trajectory> trajectory_;
};

namespace h5md {
class Source;
}  // namespace h5md

/// Reads trajectories in H5MD: files of H5mdWriter, also while another process writes them or after a kill, and files
/// of other programs.
///
/// A checksum of every frame of H5mdWriter finds damage that the checks of HDF5 miss. In files of other programs it
/// reads the first group of particles with positions, in the plane or at one z, in a box whose first edge lies
/// along x; see docs/reference/trajectories.md. Such files have no state hash.
/// Errors: Error with the name of the file for data that are missing, damaged or of another shape.
class H5mdReader {
 public:
  explicit H5mdReader(std::filesystem::path path);
  ~H5mdReader();
  H5mdReader(H5mdReader&& other) noexcept;
  H5mdReader& operator=(H5mdReader&& other) noexcept;

  [[nodiscard]] std::size_t frame_count() const;
  /// Returns the settings with which the trajectory was created, except compression and contacts.
  [[nodiscard]] H5mdSettings const& settings() const;
  /// Returns the clock of each frame.
  [[nodiscard]] std::span<Clock const> clocks() const;
  /// Returns the names of the columns, the same in every frame.
  [[nodiscard]] std::vector<std::string> column_names() const;
  /// Returns observable k of settings().observables at each frame. Faster than frame(), since it reads no agents and
  /// compares no checksums. Contract: k < settings().observables.size().
  [[nodiscard]] std::vector<double> observable(std::size_t k) const;
  /// Returns frame k. Contract: k < frame_count().
  [[nodiscard]] H5mdFrame frame(std::size_t k) const;
  /// Returns the contacts of the start, if the trajectory has them.
  [[nodiscard]] std::optional<FrameContacts> contacts() const;

 private:
  std::unique_ptr<h5md::Source> source_;
};

/// Returns a note with the names of the quantities that H5mdReader leaves out of a trajectory of another program, and
/// on how to read another group of agents; empty if it reads all.
std::string note_on_left_out(std::filesystem::path const& path, H5mdSettings const& settings);

/// The format and file for an export of a trajectory:
///
///     "xyz"   extended XYZ, all frames in one file: OVITO, ASE
///     "vtk"   a .pvd file that lists a .vtp file for each frame, in a directory beside it: ParaView
///     "csv"   one row for each agent of each frame: step, time, id and the columns
struct ExportSettings {
  std::string format = "xyz";
  std::filesystem::path file;  ///< file to write, with the extension .xyz, .pvd or .csv
  std::size_t every = 1;       ///< exports one of so many frames
};

/// Returns the files that export_trajectory() writes; the first is the file to open.
std::vector<std::filesystem::path> exported_files(H5mdReader const& trajectory, ExportSettings const& settings);

/// Writes the frames of a trajectory in another format; returns exported_files().
/// Errors: Error for damage or an unknown format, RunFailure if a file cannot be written. Cost: memory for one frame.
///
/// ```cpp
/// H5mdReader const trajectory("trajectory.h5");
/// export_trajectory(trajectory, {.format = "vtk", .file = "frames.pvd", .every = 10});
/// ```
std::vector<std::filesystem::path> export_trajectory(H5mdReader const& trajectory, ExportSettings const& settings);

}  // namespace gridlock
