// The functions that gridlock.ts calls.

#include <emscripten/bind.h>
#include <emscripten/val.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "answer.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/version.hpp"
#include "session.hpp"

namespace gridlock::web {

namespace {

using emscripten::val;

/// A Session whose exceptions become results of answer().
class Binding {
 public:
  explicit Binding(SettingsFile const& file) : session_(file) {}

  val description() {
    return answer([&] { return text_of(session_.description()); });
  }
  val status() {
    return answer([&] { return text_of(session_.status()); });
  }
  val notes() {
    return answer([&] { return text_of(session_.notes()); });
  }
  val configuration() {
    return answer([&] { return session_.configuration(); });
  }
  val values() {
    return answer([&] { return text_of(session_.values()); });
  }
  val advance(double steps, double milliseconds) {
    return answer([&] {
      auto const whole = static_cast<std::uint64_t>(std::clamp(steps, 0.0, 9007199254740992.0));
      return static_cast<double>(session_.advance(whole, milliseconds));
    });
  }
  val lengthen() {
    return answer([&] {
      session_.lengthen();
      return true;
    });
  }
  val ids() {
    return answer([&] { return array_of(session_.ids()); });
  }
  val column(std::string const& name) {
    return answer(
        [&] { return std::visit([](auto const& values) { return array_of(values); }, session_.column(name)); });
  }
  val positions() {
    return answer([&] { return array_of(session_.positions()); });
  }
  val radii() {
    return answer([&] { return array_of(session_.radii()); });
  }
  val drawn_column(std::string const& name) {
    return answer([&] { return array_of(session_.drawn_column(name)); });
  }
  val series(double from_row) {
    return answer([&] { return array_of(session_.series(static_cast<std::size_t>(std::max(0.0, from_row)))); });
  }
  val results() {
    return answer([&] { return text_of(session_.results()); });
  }
  val protocol_tables() {
    return answer([&] { return text_of(session_.protocol_tables()); });
  }
  val state_hash() {
    return answer([&] { return session_.state_hash(); });
  }
  val neighbourhood(double id) {
    return answer([&] { return text_of(session_.neighbourhood(id)); });
  }
  val contact_ids() {
    return answer([&] { return array_of(session_.contact_ids()); });
  }
  val contact_forces() {
    return answer([&] { return array_of(session_.contact_forces()); });
  }
  val save() {
    return answer([&] { return array_of_bytes(session_.save()); });
  }
  val restore(val const& bytes) {
    return answer([&] {
      session_.restore(bytes_of(bytes));
      return true;
    });
  }

 private:
  Session session_;
};

val open(std::string const& toml, val const& overrides) {
  return answer([&] { return std::make_shared<Binding>(settings_of(toml, strings_of(overrides))); });
}

val read(std::string const& toml, val const& overrides) {
  return answer([&] {
    Configuration configuration = read_configuration(settings_of(toml, strings_of(overrides)));
    return text_of(values_of(configuration));
  });
}

val merge(std::string const& toml, val const& overrides) {
  return answer([&] { return given_settings(settings_of(toml, strings_of(overrides))); });
}

/// Simulates an internal error for tests; the engine cannot be used afterwards.
void trap() { __builtin_trap(); }

/// Simulates a stack overflow for tests.
int fill_stack(int depth) {
  int volatile const deeper = depth + 1;
  return fill_stack(deeper) + deeper;
}

val catalogue() {
  return answer([&] {
    return text_of({{"version", version()},
                    {"settings", describe_settings()},
                    {"models", describe_models()},
                    {"engines", describe_engines()}});
  });
}

}  // namespace

EMSCRIPTEN_BINDINGS(gridlock) {
  emscripten::function("catalogue", &catalogue);
  emscripten::function("open", &open);
  emscripten::function("read", &read);
  emscripten::function("merge", &merge);
  emscripten::function("trap", &trap);
  emscripten::function("fillStack", &fill_stack);
  emscripten::class_<Binding>("Session")
      .smart_ptr<std::shared_ptr<Binding>>("Session")
      .function("description", &Binding::description)
      .function("status", &Binding::status)
      .function("notes", &Binding::notes)
      .function("configuration", &Binding::configuration)
      .function("values", &Binding::values)
      .function("advance", &Binding::advance)
      .function("lengthen", &Binding::lengthen)
      .function("ids", &Binding::ids)
      .function("column", &Binding::column)
      .function("positions", &Binding::positions)
      .function("radii", &Binding::radii)
      .function("drawnColumn", &Binding::drawn_column)
      .function("series", &Binding::series)
      .function("results", &Binding::results)
      .function("protocolTables", &Binding::protocol_tables)
      .function("stateHash", &Binding::state_hash)
      .function("neighbourhood", &Binding::neighbourhood)
      .function("contactIds", &Binding::contact_ids)
      .function("contactForces", &Binding::contact_forces)
      .function("save", &Binding::save)
      .function("restore", &Binding::restore);
}

}  // namespace gridlock::web
