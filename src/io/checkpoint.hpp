#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "gridlock/core/archive.hpp"

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
std::string to_checkpoint(SerializeAll const& serialize);

/// Restores what to_checkpoint() made. `name` names the file in errors.
/// Errors: Error if the bytes are not a checkpoint, have another format version, are corrupted, or lack a member.
void from_checkpoint(std::string_view bytes, std::string const& name, SerializeAll const& serialize);

/// Writes the checkpoint of a directory. The file appears under its name only when it is complete and on the disk, and
/// the one it replaces is kept as the previous one:
///
///     checkpoint.gridlock  →  checkpoint.previous.gridlock
///     (a temporary file)   →  checkpoint.gridlock
///
/// Errors: RunFailure with the reason of the operating system; the checkpoints that are there stay as they are.
/// Cost: about 0.3 s and the size of the file, 70 bytes a disk, in memory.
void write_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize);

/// Where a state came from.
struct Restored {
  std::filesystem::path file;
  std::string note;  ///< why the newest checkpoint was not used; empty where it was

  friend bool operator==(Restored const&, Restored const&) = default;
};

/// Restores the newest checkpoint of a directory that is whole; nothing where there is none.
/// Errors: Error where there are checkpoints and none can be used, or where one of them is not a regular file.
std::optional<Restored> restore_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize);

/// Whether there is anything to restore.
bool has_checkpoint(std::filesystem::path const& directory);

/// Removes the previous checkpoint of a directory where there is a newer one.
void remove_previous_checkpoint(std::filesystem::path const& directory);

/// Removes the checkpoints of a directory.
void remove_checkpoints(std::filesystem::path const& directory);

}  // namespace gridlock
