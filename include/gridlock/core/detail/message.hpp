#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace gridlock {

/// Bytes that one process sends to another. Both run the same program on the same kind of processor, so that values are
/// copied byte by byte.
using Message = std::vector<std::byte>;

/// Writes values into a message.
class MessageWriter {
 public:
  template <class Value>
  void add(Value const& value) {
    add_all(std::span(&value, 1));
  }
  template <class Value, std::size_t extent>
  void add_all(std::span<Value, extent> values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (values.empty()) return;
    std::size_t const begin = bytes_.size();
    bytes_.resize(begin + values.size_bytes());
    std::memcpy(bytes_.data() + begin, values.data(), values.size_bytes());
  }
  void add_text(std::string_view text) {
    add(std::uint64_t{text.size()});
    add_all(std::span<char const>(text));
  }
  /// Adds the values at the indices `places` of an array.
  template <class Value>
  void add_chosen(Value const* values, std::span<std::uint32_t const> places) {
    static_assert(std::is_trivially_copyable_v<Value>);
    std::size_t at = bytes_.size();
    bytes_.resize(at + places.size() * sizeof(Value));
    for (std::uint32_t const place : places) {
      std::memcpy(bytes_.data() + at, values + place, sizeof(Value));
      at += sizeof(Value);
    }
  }
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  [[nodiscard]] Message take() { return std::move(bytes_); }

 private:
  Message bytes_;
};

/// Reads values in the order in which they were written.
class MessageReader {
 public:
  explicit MessageReader(Message const& bytes) : bytes_(bytes) {}

  template <class Value>
  [[nodiscard]] Value next() {
    Value value;
    read_into(std::span(&value, 1));
    return value;
  }
  template <class Value>
  void read_into(std::span<Value> values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    assert(at_ + values.size_bytes() <= bytes_.size());
    if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes_.data() + at_, values.size_bytes());
    at_ += values.size_bytes();
  }
  [[nodiscard]] bool is_at_end() const { return at_ == bytes_.size(); }
  [[nodiscard]] std::string next_text() {
    std::string text(next<std::uint64_t>(), '\0');
    read_into(std::span<char>(text));
    return text;
  }
  template <class Value>
  [[nodiscard]] std::vector<Value> next_values(std::size_t count) {
    std::vector<Value> values(count);
    read_into(std::span(values));
    return values;
  }
  /// Reads all remaining values of the message.
  template <class Value>
  [[nodiscard]] std::vector<Value> rest() {
    std::vector<Value> values((bytes_.size() - at_) / sizeof(Value));
    read_into(std::span(values));
    return values;
  }

 private:
  Message const& bytes_;
  std::size_t at_ = 0;
};

template <class Value>
Message message_of(Value const& value) {
  MessageWriter message;
  message.add(value);
  return message.take();
}

template <class Value>
Message message_of_all(std::span<Value const> values) {
  MessageWriter message;
  message.add_all(values);
  return message.take();
}

}  // namespace gridlock
