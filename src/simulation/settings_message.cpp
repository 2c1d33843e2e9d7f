#include "simulation/settings_message.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/detail/message.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/parallel/communicator.hpp"
#include "gridlock/parallel/detail/collectives.hpp"

namespace gridlock {

namespace {

/// Visits each setting in order with its key; exchange(value) writes the value to a message or reads it.
template <class Exchange>
class ValueVisitor : public SettingVisitor {
 public:
  void enter(std::string_view name, std::string_view /*documentation*/) override { self().key(name); }
  void leave() override {}
  void visit(SettingInfo const& info, double& value) override { put(info, value); }
  void visit(SettingInfo const& info, std::optional<double>& value) override { put(info, value); }
  void visit(SettingInfo const& info, std::uint64_t& value) override { put(info, value); }
  void visit(SettingInfo const& info, std::optional<std::uint64_t>& value) override { put(info, value); }
  void visit(SettingInfo const& info, bool& value) override { put(info, value); }
  void visit(SettingInfo const& info, std::string& value) override { put(info, value); }
  void visit(SettingInfo const& info, std::vector<double>& value) override { put(info, value); }
  void visit_choice(SettingInfo const& info, std::span<std::string_view const> /*choices*/,
                    std::size_t& value) override {
    put(info, value);
  }
  void visit_tables(SettingInfo const& info, std::size_t size, std::function<void(std::size_t)> const& resize,
                    std::function<void(std::size_t, SettingVisitor&)> const& describe_one) override {
    put(info, size);
    resize(size);
    for (std::size_t k = 0; k < size; ++k) describe_one(k, *this);
  }

 private:
  [[nodiscard]] Exchange& self() { return static_cast<Exchange&>(*this); }
  template <class Value>
  void put(SettingInfo const& info, Value& value) {
    self().key(info.key);
    self().value(value);
  }
};

class Sending final : public ValueVisitor<Sending> {
 public:
  void key(std::string_view name) { message_.add_text(name); }
  template <class Number>
  void value(Number const& number) {
    message_.add(number);
  }
  void value(std::string const& text) { message_.add_text(text); }
  void value(std::vector<double> const& numbers) {
    message_.add(numbers.size());
    message_.add_all(std::span(numbers));
  }
  [[nodiscard]] Message take() { return message_.take(); }

 private:
  MessageWriter message_;
};

class Receiving final : public ValueVisitor<Receiving> {
 public:
  explicit Receiving(MessageReader& message) : message_(message) {}

  void key(std::string_view name) {
    if (message_.is_at_end() || message_.next_text() != name) throw RunFailure("all ranks must be the same program");
  }
  template <class Number>
  void value(Number& number) {
    number = message_.next<Number>();
  }
  void value(std::string& text) { text = message_.next_text(); }
  void value(std::vector<double>& numbers) { numbers = message_.next_values<double>(message_.next<std::size_t>()); }

 private:
  MessageReader& message_;
};

}  // namespace

void broadcast_settings(AllProcesses processes, Describe const& describe) {
  if (processes.count() == 1) return;
  Sending own;
  if (processes.is_root()) describe(own);
  Message const of_root = broadcast(processes.communicator(), own.take());
  processes.agree([&] {
    if (processes.is_root()) return;
    MessageReader message(of_root);
    Receiving received(message);
    describe(received);
  });
}

}  // namespace gridlock
