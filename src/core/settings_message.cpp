#include "gridlock/core/detail/settings_message.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridlock {

namespace {

/// Visits each setting by `codec`, one of the two below, which knows how values of each type travel.
template <class Codec>
class SettingsInMessage final : public SettingVisitor {
 public:
  explicit SettingsInMessage(Codec codec) : codec_(codec) {}

  void enter(std::string_view /*name*/, std::string_view /*documentation*/) override {}
  void leave() override {}
  void visit(SettingInfo const& /*info*/, double& value) override { codec_.plain(value); }
  void visit(SettingInfo const& /*info*/, std::optional<double>& value) override { codec_.optional(value); }
  void visit(SettingInfo const& /*info*/, std::uint64_t& value) override { codec_.plain(value); }
  void visit(SettingInfo const& /*info*/, std::optional<std::uint64_t>& value) override { codec_.optional(value); }
  void visit(SettingInfo const& /*info*/, bool& value) override { codec_.plain(value); }
  void visit(SettingInfo const& /*info*/, std::string& value) override { codec_.list(value); }
  void visit(SettingInfo const& /*info*/, std::vector<double>& value) override { codec_.list(value); }
  void visit_choice(SettingInfo const& /*info*/, std::span<std::string_view const> /*choices*/,
                    std::size_t& value) override {
    codec_.plain(value);
  }
  void visit_tables(SettingInfo const& /*info*/, std::size_t size, std::function<void(std::size_t)> const& resize,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    std::size_t const before = size;
    codec_.plain(size);
    if (size != before) resize(size);
    for (std::size_t k = 0; k < size; ++k) describe_one(k, *this);
  }

 private:
  Codec codec_;
};

struct Write {
  MessageWriter& message;

  template <class Value>
  void plain(Value const& value) const {
    message.add(value);
  }
  template <class Value>
  void optional(std::optional<Value> const& value) const {
    message.add(value.has_value());
    message.add(value.value_or(Value()));
  }
  template <class List>
  void list(List const& values) const {
    message.add(values.size());
    message.add_all(std::span(values));
  }
};

struct Read {
  MessageReader& message;

  template <class Value>
  void plain(Value& value) const {
    value = message.next<Value>();
  }
  template <class Value>
  void optional(std::optional<Value>& value) const {
    bool const has_value = message.next<bool>();
    auto const number = message.next<Value>();
    value = has_value ? std::optional(number) : std::nullopt;
  }
  template <class List>
  void list(List& values) const {
    values.resize(message.next<std::size_t>());
    message.read_into(std::span(values));
  }
};

}  // namespace

void add_settings(MessageWriter& message, std::function<void(SettingVisitor&)> const& describe) {
  SettingsInMessage visitor(Write{message});
  describe(visitor);
}

void read_settings(MessageReader& message, std::function<void(SettingVisitor&)> const& describe) {
  SettingsInMessage visitor(Read{message});
  describe(visitor);
}

}  // namespace gridlock
