#pragma once

/// \file
/// States in files of extended XYZ.
///
/// ```cpp
/// State const state = read_xyz("final.xyz").state;
/// write_xyz(state, "copy.xyz");  // the same bits
/// ```

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/core/frame_source.hpp"

namespace gridlock {

/// Writes a frame of any model as extended XYZ, which ASE and OVITO read. The columns of disks get the names listed
/// below, all other columns keep their names.
///
/// The first column, `type`, is the kind of the agent: A, B, C … by the column "species", or else by radius and mass,
/// the smallest first; A for all agents without these columns, X for all if there are more than 20 kinds. It is not
/// called `species`, which ASE allows for chemical symbols only.
/// Contract: the frame has the columns x and y. Errors: RunFailure.
void write_xyz(FrameSource const& frame, std::filesystem::path const& path);
inline void write_xyz(Frame const& frame, std::filesystem::path const& path) {
  write_xyz(*frame_source_of(frame), path);
}

/// Writes a state as extended XYZ with every bit that hash() covers.
///
///     841
///     Lattice="1.0 0 0 0 1.0 0 0 0 1" pbc="F F F" Properties=columns Time=0.5 step=100 seed=1
///     A 0.017 0.017 0 0 0.31 -0.2 0 0.017 1 0 0
///
/// where `columns` is type:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:masses:R:1:image:I:2. Disks are at z = 0 in a box of
/// height 1, so that its volume is the area of the box. pbc is "T T F" for a periodic box. Positions are inside the
/// box; `image` counts the periodic edges that the disk crossed. Numbers have the fewest digits that read back to the
/// same bits. Errors: RunFailure. Cost: about 1 µs a disk, shared by all cores; at most 16 MB of memory.
void write_xyz(State const& state, std::filesystem::path const& path);

/// The contents of a file of extended XYZ.
struct XyzFrame {
  State state;
  bool has_velocities = false;  ///< false: all velocities are 0
  bool has_radii = false;       ///< false: all radii are 0, and the caller must set them
  bool has_masses = false;      ///< false: all masses are 1
  bool has_images = false;      ///< false: all images are 0
  double given_tilt = 0.0;      ///< of the Lattice; the box has the one below half a width with the same images
  /// The other columns with one number for each row, in the order of the Ids; nan for a missing number.
  std::vector<FrameColumn> others = {};
  std::vector<std::string> unused_columns = {};  ///< names of columns that disks do not have, except their kind
  std::vector<std::string> unused_entries = {};  ///< entries Time, step and seed of another format than Gridlock's:
                                                 ///< "step=-1"
};

/// Reads a frame of extended XYZ, plain or compressed by gzip, in every spelling of its specification,
/// https://github.com/libAtoms/extxyz.
///
/// Columns may be in any order, named by Properties: pos is needed; velo, radius, masses, image and id may be left out
/// (defaults: 0; 0; 1; 0; the number of the row from 0); disks do not use other columns. The names of other programs
/// are read too: momenta are divided by the masses, diameters halved. Time, step and seed default to 0, pbc to periodic
/// as the format demands. Rows are returned in the order of their Ids. Positions are relative to Origin; a position
/// outside a periodic box is replaced by its image inside, which `image` counts. `frame` counts from 0, or back from −1
/// for the last frame; without `frame`, the file must have only one. Hints in errors call it `setting`. Errors: Error
/// with line and column for input that is damaged, ambiguous, not finite, not in the plane or in a box whose first side
/// does not lie along x. It never crashes, and memory is at most a small multiple of the size of the file. It does not
/// check that disks are inside walls and do not overlap, see validate().
XyzFrame read_xyz(std::filesystem::path const& path, std::optional<std::int64_t> frame = {},
                  std::string const& setting = "frame");

/// Returns the number of frames of a file of extended or plain XYZ. Errors: Error if a frame is cut off.
std::uint64_t count_xyz_frames(std::filesystem::path const& path);

/// Returns whether the name of a file ends in .xyz, .extxyz or .exyz, or in one of these and .gz.
bool has_xyz_ending(std::filesystem::path const& path);

/// Reads a frame from a text, see read_xyz(); errors give `name` as the name of the file.
XyzFrame parse_xyz(std::string_view text, std::string const& name);

}  // namespace gridlock
