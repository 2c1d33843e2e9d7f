#pragma once

/// \file
/// States in extended XYZ.
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

/// Writes a frame of any population as extended XYZ, which ASE and OVITO read: the names of the columns of disks are
/// listed below, all others keep their names.
///
/// The first column, `type`, names the kind of the agent: A, B, C … by the column "species", or else by radius and
/// mass, the smallest first; A for all agents without either, X for all where there are more than 20 kinds. It is not
/// called
/// `species`, which ASE allows for chemical symbols only.
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
/// where `columns` is type:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:masses:R:1:image:I:2. The disks lie at z = 0 in a box
/// of height 1, so that its volume is the area of the box. pbc is "T T F" for a periodic box. Positions are inside the
/// box; `image` counts the periodic edges that the disk crossed. Numbers are the shortest that read back the same.
/// Errors: RunFailure. Cost: about 1 µs a disk, shared by all cores; 16 MB of text in memory at most.
void write_xyz(State const& state, std::filesystem::path const& path);

/// The contents of a file of extended XYZ.
struct XyzFrame {
  State state;
  bool has_velocities = false;  ///< where not, all are 0
  bool has_radii = false;       ///< where not, all are 0 and the caller has to give them
  bool has_masses = false;      ///< where not, all are 1
  bool has_images = false;      ///< where not, all are 0
  /// The other columns that hold one number for each row, in the order of the ids; nan where there is none.
  std::vector<FrameColumn> others = {};
  std::vector<std::string> unused_columns = {};  ///< names of columns that disks do not have, except kinds
  std::vector<std::string> unused_entries = {};  ///< Time, step and seed that are of another kind than ours: "step=-1"
};

/// Reads a frame of extended XYZ, as it is or packed by gzip, piece by piece: every spelling of its specification,
/// https://github.com/libAtoms/extxyz.
///
/// Columns may stand in any order, Properties names them: pos is needed; velo, radius, masses, image and id are left
/// out at will (0; 0; 1; 0; the number of the row from 0), and others mean nothing to disks. The names of other
/// programs are read too: momenta are divided by the masses, diameters halved. Time, step and seed default to 0, pbc to
/// periodic as the format has it. Rows come back in the order of their ids. Positions count from Origin; those outside
/// a periodic box come in through its edges, and the images count that.
/// `frame` counts from 0, or from −1 for the last; left out, the file must have one. Hints call it `setting`.
/// Errors: Error with line and column for anything damaged, not orthogonal, not in the plane, not finite or ambiguous;
/// never a crash, and never more memory than a small multiple of the file's size.
/// Not checked: that disks lie inside walls and do not overlap; validate() does.
XyzFrame read_xyz(std::filesystem::path const& path, std::optional<std::int64_t> frame = {},
                  std::string const& setting = "frame");

/// How many frames a file of extended or plain XYZ has. Errors: Error where one is cut off.
std::uint64_t count_xyz_frames(std::filesystem::path const& path);

/// Whether a file is called as extended XYZ is: .xyz, .extxyz or .exyz, and .gz behind it where it is packed.
bool has_xyz_ending(std::filesystem::path const& path);

/// read_xyz() of a text; `name` names the file in errors.
XyzFrame parse_xyz(std::string_view text, std::string const& name);

}  // namespace gridlock
