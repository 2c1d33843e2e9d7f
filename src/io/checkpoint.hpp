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

/// Visits everything a checkpoint holds, in both directions.
using SerializeAll = std::function<void(Archive&)>;

/// Everything `serialize` visits as the bytes of a checkpoint file:
///
///     offset  0   "GRIDLOCK"
///             8   version of the format, 32 bits, the least byte first; 4 bytes of zero
///            16   XXH3 of all that follows, 128 bits
///            32   a map of CBOR: "name.of.member" → number, text, or the numbers of a list as bytes
///
/// The first byte of a list tells the kind of its numbers: d, i, u or q; D, I, U or Q where it is a list of rows, and
/// they are in the parts. Numbers of 64 bits follow there then, how many rows each part has of that list.
std::string to_checkpoint(SerializeAll const& serialize);

/// Restores what to_checkpoint() made. `name` names the file in errors.
/// Errors: Error if the bytes are not a checkpoint, have another format version, are corrupted, or lack a member.
void from_checkpoint(std::string_view bytes, std::string const& name, SerializeAll const& serialize);

/// Which of several processes has a part of a checkpoint. The rows are those that Archive::visit_rows() visits: each
/// process saves lists of any lengths, and gets as many rows of each list as the others, in the order of the processes.
struct CheckpointShare {
  std::size_t part = 0;   ///< of this process
  std::size_t count = 1;  ///< processes
};

/// A file with the rows of one process, as the others have to know it.
struct CheckpointPart {
  std::array<std::uint64_t, 2> checksum{};
  std::vector<std::uint64_t> lengths{};  ///< of its lists of rows, in the order in which they are visited

  friend bool operator==(CheckpointPart const&, CheckpointPart const&) = default;
};

/// Writes the rows of one of several processes, and nothing else that `serialize` visits, into a file of its own beside
/// the checkpoint. It is on the disk when this returns, and is nothing until write_checkpoint() names it: first every
/// process writes its part, then one of them the checkpoint.
///
/// The name has the number of the part and the checksum, so that a part replaces nothing but its own copy:
///
///     checkpoint.part.NUMBER.CHECKSUM.gridlock
///
/// Errors: RunFailure with the reason of the operating system.
CheckpointPart write_checkpoint_part(std::filesystem::path const& directory, CheckpointShare const& share,
                                     SerializeAll const& serialize);

/// Writes the checkpoint of a directory. The file appears under its name only when it is complete and on the disk, and
/// the one it replaces is kept as the previous one:
///
///     checkpoint.gridlock  →  checkpoint.previous.gridlock
///     (a temporary file)   →  checkpoint.gridlock
///
/// With parts, those of all processes in their order, the file has everything but the rows, and which parts have
/// them. Afterwards parts are removed that neither this checkpoint nor the previous one has.
///
/// Errors: RunFailure with the reason of the operating system; the checkpoints that are there stay as they are.
/// Cost: about 0.3 s and the size of the file, 70 bytes a disk, in memory.
void write_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize,
                      std::vector<CheckpointPart> const& parts = {});

/// Where a state came from.
struct Restored {
  std::filesystem::path file;
  std::string note;  ///< why the newest checkpoint was not used; empty where it was

  friend bool operator==(Restored const&, Restored const&) = default;
};

/// Exchanges among processes what each has to say of a checkpoint, such as why it cannot be used: takes the text of
/// this process, empty where there is none, and returns the first text that any process has, the same in all of them.
using AgreeOnRefusal = std::function<std::string(std::string const& reason)>;

/// Restores the newest checkpoint of a directory that is whole; nothing where there is none.
///
/// Any number of processes restore what any number has written: each gives its own share, all call this at once, and
/// where one finds a file damaged, `agree` has all of them go back to the previous checkpoint. A process reads all of
/// checkpoint.gridlock, and of the parts those with rows of its share, by pieces; it has its own rows in memory, and no
/// others.
/// Errors: Error, in all processes, where there are checkpoints and none can be used, or where one of them is not a
/// regular file.
std::optional<Restored> restore_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize,
                                           CheckpointShare const& share = {}, AgreeOnRefusal const& agree = {});

/// Writes the checkpoint of processes that share a run, which call this together: one that is alone writes all, several
/// a part each. Errors: RunFailure, in all of them.
void write_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                             AllProcesses processes);

/// Restores it in any number of processes, which call this together. Each gets as many rows of
/// each list.
/// Errors: those of restore_checkpoint().
std::optional<Restored> restore_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                                                  AllProcesses processes);

/// Removes the parts that no checkpoint of a directory has, as those of one that could not be written. While it cannot
/// be told which these are, all stay.
void remove_unneeded_parts(std::filesystem::path const& directory);

/// Whether there is anything to restore.
bool has_checkpoint(std::filesystem::path const& directory);

/// Removes the previous checkpoint of a directory where there is a newer one, with the parts that only it has.
void remove_previous_checkpoint(std::filesystem::path const& directory);

/// Removes the checkpoints of a directory, and all parts.
void remove_checkpoints(std::filesystem::path const& directory);

}  // namespace gridlock
