#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "gridlock/core/archive.hpp"
#include "gridlock/parallel/detail/all_processes.hpp"

namespace gridlock {

/// Visits every member of a checkpoint, to save or to restore it.
using SerializeAll = std::function<void(Archive&)>;

/// Returns the bytes of a checkpoint file with every member that `serialize` visits:
///
///     offset  0   "GRIDLOCK"
///             8   version of the format, 32 bits, the least byte first; 4 bytes of zero
///            16   XXH3 of all that follows, 128 bits
///            32   a map of CBOR: "name.of.member" → number, text, or the numbers of a list as bytes
///
/// The first byte of a list is the type of its numbers: d, i, u or q; or D, I, U or Q if the list has rows that are in
/// the parts. After a capital letter follow numbers of 64 bits: the rows of the list in each part.
std::string to_checkpoint(SerializeAll const& serialize);

/// Restores an object from the bytes of to_checkpoint(). `name` is the name of the file in error messages.
/// Errors: Error if the bytes are not a checkpoint, have another format version, are corrupted, or lack a member.
void from_checkpoint(std::string_view bytes, std::string const& name, SerializeAll const& serialize);

/// One of the processes that save or restore a checkpoint. Rows are the lists that Archive::visit_rows() visits: a
/// process saves lists of any length, and restores an equal share of each list, in the order of the processes.
struct CheckpointShare {
  std::size_t part = 0;   ///< index of this process
  std::size_t count = 1;  ///< number of processes
};

/// A file with the rows of one process, as listed in the checkpoint.
struct CheckpointPart {
  std::array<std::uint64_t, 2> checksum{};
  std::vector<std::uint64_t> lengths{};  ///< lengths of its lists of rows, in the order of the visits

  friend bool operator==(CheckpointPart const&, CheckpointPart const&) = default;
};

/// Writes only the rows of one process, into a file of its own beside the checkpoint, and syncs it to the disk. A part
/// counts only after write_checkpoint() has listed it, so first every process writes its part, then one process writes
/// the checkpoint.
///
/// The file name contains the number and the checksum of the part, so that a part never replaces a different part:
///
///     checkpoint.part.NUMBER.CHECKSUM.gridlock
///
/// Errors: RunFailure with the reason of the operating system.
CheckpointPart write_checkpoint_part(std::filesystem::path const& directory, CheckpointShare const& share,
                                     SerializeAll const& serialize);

/// Writes the checkpoint of a directory. The file gets its name only when it is complete and on the disk, and the
/// checkpoint before it is kept as the previous one:
///
///     checkpoint.gridlock  →  checkpoint.previous.gridlock
///     (a temporary file)   →  checkpoint.gridlock
///
/// With `parts`, those of all processes in their order, the file contains all members but the rows, and lists the
/// parts. Afterwards all parts are removed that neither this checkpoint nor the previous one lists.
///
/// Errors: RunFailure with the reason of the operating system; existing checkpoints stay unchanged.
/// Cost: about 0.3 s, and memory for the whole file, about 70 bytes a disk.
void write_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize,
                      std::vector<CheckpointPart> const& parts = {});

/// The result of restoring a checkpoint.
struct Restored {
  std::filesystem::path file;
  std::string note;  ///< why the newest checkpoint was not used; empty if it was

  friend bool operator==(Restored const&, Restored const&) = default;
};

/// Lets processes agree on a refusal. Each process passes its reason why a checkpoint cannot be used, empty if it has
/// none; all get the first reason that is not empty.
using AgreeOnRefusal = std::function<std::string(std::string const& reason)>;

/// Restores the newest undamaged checkpoint of a directory; returns nothing if the directory has no checkpoint.
///
/// Any number of processes restore a checkpoint of any number of processes. All call this function at once, each with
/// its own share; if one process finds a damaged file, `agree` makes all return to the previous checkpoint. A process
/// reads checkpoint.gridlock and the parts with rows of its share; only these rows are in its memory.
/// Errors: Error in all processes if checkpoints exist and none can be used, or if one is not a regular file.
std::optional<Restored> restore_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize,
                                           CheckpointShare const& share = {}, AgreeOnRefusal const& agree = {});

/// Writes the checkpoint of a run on several processes, which call this together: one file if there is one process,
/// otherwise one part for each. Errors: RunFailure in all processes.
void write_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                             AllProcesses processes);

/// Restores a checkpoint in any number of processes, which call this together. Each process gets an equal share of the
/// rows of each list.
/// Errors: those of restore_checkpoint().
std::optional<Restored> restore_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                                                  AllProcesses processes);

/// Removes the parts that no checkpoint of a directory lists, left by a checkpoint that could not be completed. Removes
/// nothing if a checkpoint is damaged and its list of parts unknown.
void remove_unneeded_parts(std::filesystem::path const& directory);

/// Returns whether a directory has a checkpoint, newest or previous.
bool has_checkpoint(std::filesystem::path const& directory);

/// Removes the previous checkpoint of a directory, with the parts that only it lists, if there is a newer checkpoint.
void remove_previous_checkpoint(std::filesystem::path const& directory);

/// Removes all checkpoints and parts of a directory.
void remove_checkpoints(std::filesystem::path const& directory);

}  // namespace gridlock
