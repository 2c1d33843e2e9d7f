#include "io/checkpoint_file.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"

namespace gridlock::checkpoint {

namespace {

using Json = nlohmann::json;

constexpr std::string_view magic = "GRIDLOCK";
constexpr std::size_t version_offset = 8;
constexpr std::size_t checksum_offset = 16;
constexpr std::size_t header_size = 32;
constexpr std::size_t piece_size = std::size_t{1} << 20;
/// Largest checkpoint, in bytes; a million disks need about 80 MB.
constexpr std::uint64_t largest_checkpoint = std::uint64_t{1} << 36;

static_assert(std::endian::native == std::endian::little,
              "the lists of a checkpoint are written as they lie in memory");

/// The major types of CBOR that a checkpoint contains (RFC 8949).
enum CborKind : unsigned { whole_number = 0, byte_string = 2, text_string = 3, map = 5, simple = 7 };
constexpr std::uint64_t simple_false = 20;
constexpr std::uint64_t simple_true = 21;

std::string in_cbor(Json const& value) {
  std::string bytes;
  Json::to_cbor(value, bytes);
  return bytes;
}

/// Returns the bytes that CBOR puts before `length` bytes or members: type and length, in as few bytes as possible.
std::string head_of(CborKind kind, std::uint64_t length) {
  // Json writes a whole number with this length; the types differ only in the first three bits.
  std::string head = in_cbor(Json(length));
  head[0] = static_cast<char>(static_cast<unsigned char>(head[0]) | (kind << 5));
  return head;
}

/// Computes XXH3 of 128 bits over text that arrives in pieces.
class Sum {
 public:
  Sum() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(std::string_view text) { XXH3_128bits_update(state_.get(), text.data(), text.size()); }
  [[nodiscard]] Checksum digest() const {
    XXH128_hash_t const hash = XXH3_128bits_digest(state_.get());
    return {hash.low64, hash.high64};
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

std::string canonical(Checksum const& checksum) {
  XXH128_canonical_t bytes;
  XXH128_canonicalFromHash(&bytes, {.low64 = checksum[0], .high64 = checksum[1]});
  return {reinterpret_cast<char const*>(bytes.digest), sizeof bytes.digest};
}

/// Reads bytes one after the other through a buffer, so that most bytes need no system call.
class Cursor {
 public:
  Cursor(Bytes const& bytes, std::uint64_t at) : bytes_(bytes), at_(at) {}

  [[nodiscard]] std::uint64_t place() const { return at_; }
  [[nodiscard]] std::uint64_t left() const { return bytes_.size - at_; }
  void skip(std::uint64_t count) { at_ += count; }

  /// Returns the next byte. Requires left() > 0.
  unsigned char next() {
    if (at_ < first_ || at_ >= first_ + window_.size()) {
      window_.resize(std::min<std::uint64_t>(left(), 4096));
      first_ = at_;
      bytes_.read(first_, window_);
    }
    return static_cast<unsigned char>(window_[at_++ - first_]);
  }

  struct Head {
    unsigned kind;
    std::uint64_t argument;
  };
  /// Returns the type and the number or length at the start of a CBOR item; nothing if the bytes are not valid.
  std::optional<Head> head() {
    if (left() == 0) return std::nullopt;
    unsigned const first = next();
    unsigned const info = first & 31U;
    if (info < 24) return Head{first >> 5, info};
    if (info > 27) return std::nullopt;
    std::uint64_t const length = std::uint64_t{1} << (info - 24);
    if (left() < length) return std::nullopt;
    std::uint64_t argument = 0;
    for (std::uint64_t k = 0; k < length; ++k) argument = argument << 8 | next();
    return Head{first >> 5, argument};
  }

  std::optional<std::string> name() {
    constexpr std::uint64_t longest = 1 << 16;
    auto const found = head();
    if (!found || found->kind != text_string || found->argument > std::min(left(), longest)) return std::nullopt;
    std::string name;
    for (std::uint64_t k = 0; k < found->argument; ++k) name += static_cast<char>(next());
    return name;
  }

 private:
  Bytes const& bytes_;
  std::uint64_t at_;
  std::uint64_t first_ = 0;
  std::vector<char> window_;
};

/// Returns the type and position of the value that begins here; nothing if checkpoints have no such value.
std::optional<File::Place> place_at(Cursor& cursor) {
  using enum File::Kind;
  auto const head = cursor.head();
  if (!head) return std::nullopt;
  if (head->kind == whole_number) return File::Place{.kind = number, .number = head->argument};
  if (head->kind == simple && (head->argument == simple_false || head->argument == simple_true)) {
    return File::Place{.kind = truth, .number = head->argument == simple_true ? 1U : 0U};
  }
  if ((head->kind != byte_string && head->kind != text_string) || head->argument > cursor.left()) return std::nullopt;
  File::Place const place{
      .kind = head->kind == text_string ? text : list, .offset = cursor.place(), .length = head->argument};
  cursor.skip(head->argument);
  return place;
}

}  // namespace

void refuse(std::string const& name, std::string const& why, std::string hint) {
  throw Error(
      {.what = fmt::format("cannot use the checkpoint {}: {}", name, why), .hint = std::move(hint), .file = name});
}

void Members::add(std::string const& name, bool value) { values_[name] = in_cbor(value); }
void Members::add(std::string const& name, std::uint64_t value) { values_[name] = in_cbor(value); }
void Members::add(std::string const& name, std::string const& value) { values_[name] = in_cbor(value); }

void Members::add_bytes(std::string const& name, char letter, std::span<std::byte const> bytes) {
  std::string& value = values_[name];
  value = head_of(byte_string, 1 + bytes.size());
  value.reserve(value.size() + 1 + bytes.size());
  value += letter;
  value.append(reinterpret_cast<char const*>(bytes.data()), bytes.size());
}

Checksum Members::checksum() const {
  Sum sum;
  for_each_piece([&](std::string_view piece) { sum.add(piece); });
  return sum.digest();
}

void Members::write(std::uint32_t version, std::function<void(std::string_view)> const& take) const {
  std::string header(magic);
  header.resize(checksum_offset, '\0');
  std::memcpy(header.data() + version_offset, &version, sizeof version);
  take(header + canonical(checksum()));
  for_each_piece(take);
}

void Members::for_each_piece(std::function<void(std::string_view)> const& take) const {
  take(head_of(map, values_.size()));
  for (auto const& [name, value] : values_) {
    take(in_cbor(name));
    take(value);
  }
}

Bytes bytes_of_file(std::filesystem::path const& path) {
  require_regular_file(path);
  return {.name = path.string(),
          .size = size_of_file(path, largest_checkpoint),
          .read = [path](std::uint64_t offset, std::span<char> into) { read_piece(path, offset, into); }};
}

Bytes bytes_of_text(std::string_view text, std::string name) {
  return {.name = std::move(name), .size = text.size(), .read = [text](std::uint64_t offset, std::span<char> into) {
            std::ranges::copy(text.substr(offset, into.size()), into.begin());
          }};
}

File::File(Bytes bytes) : bytes_(std::move(bytes)) {
  read_head();
  require_checksum();
  if (!find_members()) refuse(name(), "its content cannot be read", "it was written by another version");
}

void File::read_head() {
  std::string header(std::min<std::uint64_t>(bytes_.size, header_size), '\0');
  bytes_.read(0, header);
  if (header.size() < header_size || !header.starts_with(magic)) {
    refuse(name(), "it is not a checkpoint, or only the beginning of one", again_hint);
  }
  std::memcpy(&version_, header.data() + version_offset, sizeof version_);
  if (version_ != whole_version && version_ != version_of_parts) {
    refuse(name(),
           fmt::format("it has format {}, and this version of gridlock reads formats {} and {}", version_,
                       whole_version, version_of_parts),
           "resume with the version that wrote it, or start the run again");
  }
  if (header.find_first_not_of('\0', version_offset + sizeof version_) < checksum_offset) {
    refuse(name(), "it is damaged: its first bytes are wrong", again_hint);
  }
  XXH128_canonical_t canonical;
  std::memcpy(canonical.digest, header.data() + checksum_offset, sizeof canonical.digest);
  XXH128_hash_t const hash = XXH128_hashFromCanonical(&canonical);
  checksum_ = {hash.low64, hash.high64};
}

void File::require_checksum() const {
  Sum sum;
  std::vector<char> piece;
  for (std::uint64_t at = header_size; at < bytes_.size; at += piece.size()) {
    piece.resize(std::min<std::uint64_t>(piece_size, bytes_.size - at));
    bytes_.read(at, piece);
    sum.add({piece.data(), piece.size()});
  }
  if (sum.digest() != checksum_) refuse(name(), "it is damaged: its checksum is wrong", again_hint);
}

/// Finds all members. Returns whether the file is one flat map to numbers, truths, strings and bytes of known length.
bool File::find_members() {
  Cursor cursor(bytes_, header_size);
  auto const outer = cursor.head();
  if (!outer || outer->kind != map) return false;
  for (std::uint64_t n = 0; n < outer->argument; ++n) {
    auto const member = cursor.name();
    auto const place = member ? place_at(cursor) : std::nullopt;
    if (!place || !members_.try_emplace(*member, *place).second) return false;
  }
  return cursor.left() == 0;
}

File::Place const& File::at(std::string const& member, Kind kind) const {
  auto const found = members_.find(member);
  if (found == members_.end() || found->second.kind != kind) {
    throw Error({.what = fmt::format("it does not hold \"{}\"", member),
                 .hint = "it was written by another version, or for another configuration"});
  }
  return found->second;
}

std::string File::text(Place const& place) const {
  std::string text(place.length, '\0');
  bytes_.read(place.offset, text);
  return text;
}

char File::letter(Place const& list) const {
  char letter = '\0';
  if (list.length > 0) bytes_.read(list.offset, {&letter, 1});
  return letter;
}

void File::require_kind(Place const& list, char letter, std::size_t width) const {
  if (this->letter(list) == letter) return require_width(list, width);
  throw Error(Problem{.what = "what was saved cannot be restored: a list holds numbers of another kind",
                      .hint = "it was saved by another version, or for another configuration"});
}

void File::require_width(Place const& list, std::size_t width) const {
  if (list.length > 0 && (list.length - 1) % width == 0) return;
  throw Error(Problem{.what = "what was saved cannot be restored: a list ends within a number",
                      .hint = "it was saved by another version, or for another configuration"});
}

}  // namespace gridlock::checkpoint
