#pragma once

// Converts values for JavaScript. A C++ exception cannot cross over, so answer() returns it as part of its result.

#include <emscripten/bind.h>
#include <emscripten/val.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <exception>
#include <new>
#include <string>
#include <vector>

#include "gridlock/core/error.hpp"

namespace gridlock::web {

using emscripten::val;
using Json = nlohmann::ordered_json;

inline Json json_of(Problem const& problem) {
  return {{"what", problem.what},    {"hint", problem.hint},     {"key", problem.key},
          {"line", problem.line},    {"column", problem.column}, {"sourceLine", problem.source_line},
          {"text", to_text(problem)}};
}

/// Returns JSON as text; invalid UTF-8 in texts of a user becomes U+FFFD.
inline std::string text_of(Json const& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

inline val failure(char const* kind, std::vector<Problem> const& problems) {
  Json all = Json::array();
  for (Problem const& problem : problems) all.push_back(json_of(problem));
  val result = val::object();
  result.set("error", text_of({{"kind", kind}, {"problems", all}}));
  return result;
}

/// Returns {value: …} or {error: …}; the error is the JSON text of a GridlockError with its kind and problems.
template <class Work>
val answer(Work work) {
  try {
    val result = val::object();
    result.set("value", work());
    return result;
  } catch (Error const& error) {
    return failure("input", error.problems());
  } catch (RunFailure const& error) {
    return failure("failure", {{.what = error.what()}});
  } catch (std::bad_alloc const&) {
    return failure("memory", {{.what = "there is not enough memory in the browser", .hint = "use fewer agents"}});
  } catch (std::exception const& error) {
    return failure("internal", {{.what = error.what()}});
  }
}

/// Returns a copy as a JavaScript array, since the memory of C++ may move when it grows.
template <class Number>
val array_of(std::vector<Number> const& values) {
  return val(emscripten::typed_memory_view(values.size(), values.data())).call<val>("slice");
}
/// Returns a copy of 64-bit numbers, made from their bytes, since embind 3.1.6 has no views of such numbers.
inline val array_of(std::vector<std::uint64_t> const& values) {
  auto const* const bytes = reinterpret_cast<std::uint8_t const*>(values.data());
  val const copy = val(emscripten::typed_memory_view(values.size() * sizeof(std::uint64_t), bytes)).call<val>("slice");
  return val::global("BigUint64Array").new_(copy["buffer"]);
}

inline std::vector<std::string> strings_of(val const& list) { return emscripten::vecFromJSArray<std::string>(list); }

inline std::string bytes_of(val const& array) {
  auto const bytes = emscripten::convertJSArrayToNumberVector<std::uint8_t>(array);
  return {bytes.begin(), bytes.end()};
}

inline val array_of_bytes(std::string const& bytes) {
  return val(emscripten::typed_memory_view(bytes.size(), reinterpret_cast<std::uint8_t const*>(bytes.data())))
      .call<val>("slice");
}

}  // namespace gridlock::web
