#include <string>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/agreement.hpp"
#include "gridlock/parallel/detail/collectives.hpp"
#include "io/checkpoint.hpp"

namespace gridlock {

namespace {

Message message_of_part(CheckpointPart const& part) {
  MessageWriter message;
  message.add(part.checksum);
  message.add_all(std::span<std::uint64_t const>(part.lengths));
  return message.take();
}

CheckpointPart part_in(Message const& bytes) {
  MessageReader message(bytes);
  CheckpointPart part;
  part.checksum = message.next<std::array<std::uint64_t, 2>>();
  part.lengths = message.rest<std::uint64_t>();
  return part;
}

CheckpointShare share_of(AllProcesses processes) { return {.part = processes.rank(), .count = processes.count()}; }

}  // namespace

void write_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                             AllProcesses processes) {
  std::vector<CheckpointPart> parts;
  if (processes.count() > 1) {
    CheckpointPart own;
    processes.agree([&] { own = write_checkpoint_part(directory, share_of(processes), serialize); });
    for (Message const& part : gather(processes.communicator(), message_of_part(own))) parts.push_back(part_in(part));
  }
  processes.on_root([&] { write_checkpoint(directory, serialize, parts); });
}

std::optional<Restored> restore_checkpoint_of_all(std::filesystem::path const& directory, SerializeAll const& serialize,
                                                  AllProcesses processes) {
  std::optional<Restored> restored;
  processes.agree([&] {
    restored = restore_checkpoint(directory, serialize, share_of(processes), [&](std::string const& text) {
      return first_text_of_all(processes.communicator(), text);
    });
  });
  return restored;
}

}  // namespace gridlock
