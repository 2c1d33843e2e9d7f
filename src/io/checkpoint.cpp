#include "io/checkpoint.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <xxhash.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"

namespace gridlock {

namespace {

using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

constexpr std::string_view magic = "GRIDLOCK";
constexpr std::uint32_t format_version = 4;
constexpr std::size_t checksum_offset = 16;
constexpr std::size_t header_size = 32;
/// A million disks need about 80 MB.
constexpr std::uint64_t largest_checkpoint = std::uint64_t{1} << 36;

constexpr char const* newest_name = "checkpoint.gridlock";
constexpr char const* previous_name = "checkpoint.previous.gridlock";

static_assert(std::endian::native == std::endian::little,
              "the lists of a checkpoint are written as they lie in memory");

/// What kind of numbers a list holds: the first byte of its value.
template <class Number>
constexpr std::uint8_t letter_of() {
  if constexpr (std::is_same_v<Number, double>) return 'd';
  if constexpr (std::is_same_v<Number, std::int32_t>) return 'i';
  if constexpr (std::is_same_v<Number, std::uint32_t>) return 'u';
  return 'q';
}

/// Names members by the path to them, so that the file is a map without maps in it.
class NamedArchive : public Archive {
 public:
  void enter(std::string_view name) override { path_.push_back(full(name)); }
  void leave() override { path_.pop_back(); }

 protected:
  [[nodiscard]] std::string full(std::string_view name) const {
    return path_.empty() ? std::string(name) : fmt::format("{}.{}", path_.back(), name);
  }

 private:
  std::vector<std::string> path_;
};

/// The members, each as its bytes in CBOR, in the order of their names.
class SavingArchive final : public NamedArchive {
 public:
  [[nodiscard]] bool is_restoring() const override { return false; }
  void visit(std::string_view name, bool& value) override { save(name, value); }
  /// As the bits it has, since CBOR keeps one kind of NaN only.
  void visit(std::string_view name, double& value) override { save(name, std::bit_cast<std::uint64_t>(value)); }
  void visit(std::string_view name, std::uint64_t& value) override { save(name, value); }
  void visit(std::string_view name, std::string& value) override { save(name, value); }
  void visit(std::string_view name, std::vector<double>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::int32_t>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::uint32_t>& values) override { save_list(name, values); }
  void visit(std::string_view name, std::vector<std::uint64_t>& values) override { save_list(name, values); }

  /// Calls take(text) for all parts of the checkpoint, in their order.
  template <class Take>
  void for_each_part(Take take) const {
    take(map_head(members_.size()));
    for (auto const& [name, value] : members_) {
      take(in_cbor(name));
      take(value);
    }
  }

 private:
  static std::string in_cbor(Json const& value) {
    std::string bytes;
    Json::to_cbor(value, bytes);
    return bytes;
  }

  /// What CBOR puts before that many pairs of a name and a value: the length in as few bytes as hold it.
  static std::string map_head(std::uint64_t pairs) {
    constexpr unsigned char map_of_length_0 = 0xA0;
    // A whole number differs from the head of a map only in the three bits that tell their kinds.
    std::string head = in_cbor(Json(pairs));
    head[0] = static_cast<char>(static_cast<unsigned char>(head[0]) | map_of_length_0);
    return head;
  }

  void save(std::string_view name, Json const& value) { members_[full(name)] = in_cbor(value); }

  template <class Number>
  void save_list(std::string_view name, std::vector<Number> const& values) {
    Bytes bytes(1 + values.size() * sizeof(Number));
    bytes[0] = letter_of<Number>();
    if (!values.empty()) std::memcpy(bytes.data() + 1, values.data(), values.size() * sizeof(Number));
    save(name, Json::binary(std::move(bytes)));
  }

  std::map<std::string, std::string> members_;
};

using Member = std::variant<bool, std::uint64_t, std::string, Bytes>;

/// Whether the bytes begin with one flat map as it is written here: names, numbers, truths, strings and bytes of known
/// lengths (RFC 8949). Anything deeper, pieces of strings inside pieces too, is followed by the library call by call, and
/// would exhaust the stack. Cost: one look at each member.
bool is_flat_map(std::string_view cbor) {
  enum Kind : unsigned { whole_number = 0, bytes = 2, text = 3, map = 5, simple = 7 };
  struct Head {
    unsigned kind;
    std::uint64_t argument;
  };
  std::size_t at = 0;
  auto const take_head = [&]() -> std::optional<Head> {
    if (at == cbor.size()) return std::nullopt;
    unsigned const first = static_cast<unsigned char>(cbor[at++]);
    unsigned const info = first & 31U;
    if (info < 24) return Head{first >> 5, info};
    if (info > 27) return std::nullopt;
    std::size_t const length = std::size_t{1} << (info - 24);
    if (cbor.size() - at < length) return std::nullopt;
    std::uint64_t argument = 0;
    for (std::size_t k = 0; k < length; ++k) argument = argument << 8 | static_cast<unsigned char>(cbor[at++]);
    return Head{first >> 5, argument};
  };
  auto const skip_item = [&] {
    auto const head = take_head();
    if (!head) return false;
    if (head->kind == whole_number || head->kind == simple) return true;
    if ((head->kind != bytes && head->kind != text) || cbor.size() - at < head->argument) return false;
    at += head->argument;
    return true;
  };
  auto const outer = take_head();
  if (!outer || outer->kind != map) return false;
  for (std::uint64_t n = 0; n < outer->argument; ++n) {
    bool const has_name = skip_item();
    bool const has_value = has_name && skip_item();
    if (!has_value) return false;
  }
  return true;
}

/// Reads a flat map of members.
class MemberReader final : public nlohmann::json_sax<Json> {
 public:
  std::map<std::string, Member> members;

  bool null() override { return false; }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t) override { return false; }
  bool number_unsigned(number_unsigned_t value) override { return add(std::uint64_t{value}); }
  bool number_float(number_float_t, string_t const&) override { return false; }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t& value) override { return add(Bytes(std::move(value))); }
  bool start_object(std::size_t) override { return !std::exchange(is_inside_, true); }
  bool key(string_t& name) override {
    key_ = std::move(name);
    return true;
  }
  bool end_object() override { return true; }
  bool start_array(std::size_t) override { return false; }
  bool end_array() override { return false; }
  bool parse_error(std::size_t, std::string const&, nlohmann::detail::exception const&) override { return false; }

 private:
  bool add(Member&& value) { return is_inside_ && members.try_emplace(key_, std::move(value)).second; }

  bool is_inside_ = false;
  std::string key_;
};

class RestoringArchive final : public NamedArchive {
 public:
  explicit RestoringArchive(std::map<std::string, Member> members) : members_(std::move(members)) {}

  [[nodiscard]] bool is_restoring() const override { return true; }
  void visit(std::string_view name, bool& value) override { value = get<bool>(name); }
  void visit(std::string_view name, double& value) override { value = std::bit_cast<double>(get<std::uint64_t>(name)); }
  void visit(std::string_view name, std::uint64_t& value) override { value = get<std::uint64_t>(name); }
  void visit(std::string_view name, std::string& value) override { value = get<std::string>(name); }
  void visit(std::string_view name, std::vector<double>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::int32_t>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::uint32_t>& values) override { restore(name, values); }
  void visit(std::string_view name, std::vector<std::uint64_t>& values) override { restore(name, values); }

 private:
  template <class Value>
  Value const& get(std::string_view name) const {
    auto const found = members_.find(full(name));
    Value const* const value = found == members_.end() ? nullptr : std::get_if<Value>(&found->second);
    if (value == nullptr) {
      throw Error({.what = fmt::format("it does not hold \"{}\"", full(name)),
                   .hint = "it was written by another version, or for another configuration"});
    }
    return *value;
  }

  template <class Number>
  void restore(std::string_view name, std::vector<Number>& values) const {
    Bytes const& bytes = get<Bytes>(name);
    require(!bytes.empty() && bytes[0] == letter_of<Number>() && (bytes.size() - 1) % sizeof(Number) == 0,
            "a list holds numbers of another kind");
    values.resize((bytes.size() - 1) / sizeof(Number));
    if (!values.empty()) std::memcpy(values.data(), bytes.data() + 1, bytes.size() - 1);
  }

  std::map<std::string, Member> members_;
};

/// XXH3 of 128 bits over text that comes in parts.
class Checksum {
 public:
  Checksum() : state_(XXH3_createState(), &XXH3_freeState) { XXH3_128bits_reset(state_.get()); }
  void add(std::string_view text) { XXH3_128bits_update(state_.get(), text.data(), text.size()); }
  [[nodiscard]] std::string bytes() const {
    XXH128_canonical_t canonical;
    XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(state_.get()));
    return {reinterpret_cast<char const*>(canonical.digest), sizeof canonical.digest};
  }

 private:
  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

std::string checksum_of(std::string_view payload) {
  Checksum checksum;
  checksum.add(payload);
  return checksum.bytes();
}

/// Calls take(text) for the parts of a checkpoint of everything `serialize` visits, one after the other.
template <class Take>
void save_in_parts(SerializeAll const& serialize, Take take) {
  SavingArchive archive;
  serialize(archive);
  Checksum checksum;
  archive.for_each_part([&](std::string_view part) { checksum.add(part); });
  std::string header(magic);
  header.resize(checksum_offset, '\0');
  std::memcpy(header.data() + magic.size(), &format_version, sizeof format_version);
  take(header + checksum.bytes());
  archive.for_each_part(take);
}

[[noreturn]] void refuse(std::string const& name, std::string const& why, std::string hint) {
  throw Error(
      {.what = fmt::format("cannot use the checkpoint {}: {}", name, why), .hint = std::move(hint), .file = name});
}

constexpr char const* again_hint = "put back a copy of the file, or start the run again with --overwrite";

/// What follows the header, once header and checksum have been found right.
std::string_view payload_of(std::string_view bytes, std::string const& name) {
  if (bytes.size() < header_size || !bytes.starts_with(magic)) {
    refuse(name, "it is not a checkpoint, or only the beginning of one", again_hint);
  }
  std::uint32_t version = 0;
  std::memcpy(&version, bytes.data() + magic.size(), sizeof version);
  if (version != format_version) {
    refuse(name, fmt::format("it has format {}, and this version of gridlock reads format {}", version, format_version),
           "resume with the version that wrote it, or start the run again");
  }
  std::string_view const payload = bytes.substr(header_size);
  if (checksum_of(payload) != bytes.substr(checksum_offset, header_size - checksum_offset)) {
    refuse(name, "it is damaged: its checksum is wrong", again_hint);
  }
  return payload;
}

}  // namespace

std::string to_checkpoint(SerializeAll const& serialize) {
  std::string bytes;
  save_in_parts(serialize, [&](std::string_view part) { bytes += part; });
  return bytes;
}

void from_checkpoint(std::string_view bytes, std::string const& name, SerializeAll const& serialize) {
  std::string_view const payload = payload_of(bytes, name);
  MemberReader reader;
  if (!is_flat_map(payload) || !Json::sax_parse(payload.begin(), payload.end(), &reader, Json::input_format_t::cbor)) {
    refuse(name, "its content cannot be read", "it was written by another version");
  }
  RestoringArchive archive(std::move(reader.members));
  try {
    serialize(archive);
  } catch (Error const& error) {
    refuse(name, error.problems().front().what, error.problems().front().hint);
  }
}

void write_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize) {
  AtomicFile file(directory / newest_name);
  save_in_parts(serialize, [&](std::string_view part) { file.append(part); });
  file.commit(directory / previous_name);
}

std::optional<Restored> restore_checkpoint(std::filesystem::path const& directory, SerializeAll const& serialize) {
  std::string note;
  std::optional<Error> error;
  for (char const* name : {newest_name, previous_name}) {
    std::filesystem::path const path = directory / name;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    // Not among what a damaged one may be replaced for: the next checkpoint would go into it too.
    require_regular_file(path);
    try {
      from_checkpoint(read_file(path, largest_checkpoint), path.string(), serialize);
      return Restored{path, note};
    } catch (Error const& refusal) {
      if (!error) error = refusal;
      note = refusal.problems().front().what;
    }
  }
  if (error) throw *error;
  return std::nullopt;
}

bool has_checkpoint(std::filesystem::path const& directory) {
  std::error_code ignored;
  return std::filesystem::exists(directory / newest_name, ignored) ||
         std::filesystem::exists(directory / previous_name, ignored);
}

void remove_previous_checkpoint(std::filesystem::path const& directory) {
  std::error_code ignored;
  if (std::filesystem::exists(directory / newest_name, ignored)) {
    std::filesystem::remove(directory / previous_name, ignored);
  }
}

void remove_checkpoints(std::filesystem::path const& directory) {
  std::error_code ignored;
  std::filesystem::remove(directory / newest_name, ignored);
  std::filesystem::remove(directory / previous_name, ignored);
}

}  // namespace gridlock
