#pragma once

/// \file
/// Trajectories in H5MD: read them, export them.
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
  std::string agents = "disks";  ///< name of the group below /particles
  std::string configuration;     ///< the run it belongs to, TOML
  std::string version;           ///< of the program that writes it
  std::string author;            ///< empty: "N/A"
  std::vector<H5mdObservable> observables;
  /// Names of the numbers 0, 1, 2 … of a column, by the name of the column.
  std::map<std::string, std::vector<std::string>> value_names = {};
  std::uint64_t compression = 1;  ///< 0: none, 1: fastest … 9: smallest
  /// The contacts of the start, where it is a packing; not read back, see H5mdReader::contacts().
  std::optional<FrameContacts> contacts = {};
  std::string creator = "gridlock";        ///< the program that has written it; empty where it does not say
  std::vector<std::string> left_out = {};  ///< of another program's file: groups and quantities that are not read
};

/// The agents at one time of a trajectory.
struct H5mdFrame {
  Frame frame;
  std::vector<double> observables;  ///< one for each of H5mdSettings::observables; nan where none was measured then
  std::uint64_t state_hash = 0;     ///< of the whole state, even where the frame holds only some of its columns
};

/// Writes a trajectory in H5MD 1.1, the open standard on top of HDF5, a frame at a time.
///
///     /h5md                                version, author, creator
///     /particles/<agents>/box              dimension 3, boundary, edges; the agents lie at z = 0 in a box of height 1
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
/// Between two frames the file is closed and whole: every reader of HDF5 may open it while the run continues. A frame
/// is written in the single-writer-multiple-reader mode of HDF5, whose order keeps the file readable in that mode even
/// where the process is killed in the middle of it; append() then continues after the last whole frame. What the
/// operating system had not brought to the disk when the power failed is not covered.
/// Errors: RunFailure where the file cannot be written. Cost: docs/reference/trajectories.md; of the rows of a frame,
/// some 10 MB for each core in memory at most, whatever the size of the frame.
class H5mdWriter {
 public:
  /// Begins a trajectory with the columns of `first`, which is not written yet. The file appears under its name whole;
  /// one that was there before is replaced.
  static H5mdWriter create(std::filesystem::path const& path, H5mdSettings const& settings, FrameSource const& first);
  static H5mdWriter create(std::filesystem::path const& path, H5mdSettings const& settings, Frame const& first) {
    return create(path, settings, *frame_source_of(first));
  }

  /// Continues a trajectory, repairing it where its writer was killed.
  /// Errors: Error where it is no trajectory of these columns, or where its last frame is damaged or cut off; then the
  /// file stays as it is.
  static H5mdWriter append(std::filesystem::path const& path, FrameSource const& first);
  static H5mdWriter append(std::filesystem::path const& path, Frame const& first) {
    return append(path, *frame_source_of(first));
  }

  ~H5mdWriter();
  H5mdWriter(H5mdWriter&& other) noexcept;
  H5mdWriter& operator=(H5mdWriter&& other) noexcept;

  [[nodiscard]] std::size_t frame_count() const;
  /// The step of the last frame.
  [[nodiscard]] std::optional<std::uint64_t> last_step() const;
  /// The state hash of the frame at that step, where there is one.
  [[nodiscard]] std::optional<std::uint64_t> state_hash_at(std::uint64_t step) const;

  /// Adds a frame, with what H5mdFrame has beside it; when it returns, no end of the process can lose it.
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

/// Reads trajectories in H5MD: those that H5mdWriter writes, also while another process writes them and after a kill,
/// and those of other programs.
///
/// A checksum over every frame of H5mdWriter finds damage that the checks of HDF5 do not see. Of other programs it
/// reads the first group of particles that has positions, in the plane or of one z, in a rectangular box that is
/// periodic in both directions or in none; what docs/reference/trajectories.md says of them holds here. They have no
/// state hash.
/// Errors: Error naming the file for anything missing, damaged or of another shape.
class H5mdReader {
 public:
  explicit H5mdReader(std::filesystem::path path);
  ~H5mdReader();
  H5mdReader(H5mdReader&& other) noexcept;
  H5mdReader& operator=(H5mdReader&& other) noexcept;

  [[nodiscard]] std::size_t frame_count() const;
  /// The description that the trajectory was created with; the compression is not read back.
  [[nodiscard]] H5mdSettings const& settings() const;
  /// The clock of each frame.
  [[nodiscard]] std::span<Clock const> clocks() const;
  /// The columns of every frame.
  [[nodiscard]] std::vector<std::string> column_names() const;
  /// Observable number k of the settings at each frame. Cheaper than frame() for each: no agents are read, so no
  /// checksum is compared. Requires k < settings().observables.size().
  [[nodiscard]] std::vector<double> observable(std::size_t k) const;
  /// Requires k < frame_count().
  [[nodiscard]] H5mdFrame frame(std::size_t k) const;
  /// Those of the start, where the trajectory has them.
  [[nodiscard]] std::optional<FrameContacts> contacts() const;

 private:
  std::unique_ptr<h5md::Source> source_;
};

/// A note on what H5mdReader leaves out of the trajectory of another program, by name, and how to come to another group
/// of agents; empty where it reads all.
std::string note_on_left_out(std::filesystem::path const& path, H5mdSettings const& settings);

/// How a trajectory is turned into another format:
///
///     "xyz"   extended XYZ, all frames in one file: OVITO, ASE
///     "vtk"   a .pvd file that lists a .vtp file for each frame, in a directory beside it: ParaView
///     "csv"   one row for each agent of each frame: step, time, id and the columns
struct ExportSettings {
  std::string format = "xyz";
  std::filesystem::path file;  ///< with the extension .xyz, .pvd or .csv
  std::size_t every = 1;       ///< every how many frames one is taken
};

/// The files that export_trajectory() writes, the one to open first.
std::vector<std::filesystem::path> exported_files(H5mdReader const& trajectory, ExportSettings const& settings);

/// Writes the frames of a trajectory in another format; returns exported_files().
/// Errors: Error for damage or an unknown format, RunFailure where a file cannot be written. Cost: a frame in memory.
///
/// ```cpp
/// H5mdReader const trajectory("trajectory.h5");
/// export_trajectory(trajectory, {.format = "vtk", .file = "frames.pvd", .every = 10});
/// ```
std::vector<std::filesystem::path> export_trajectory(H5mdReader const& trajectory, ExportSettings const& settings);

}  // namespace gridlock
