#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <string>

#include "arrays.hpp"
#include "gridlock/core/box.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/core/version.hpp"

namespace gridlock::python {

namespace {

/// Raises exception `type` of gridlock.errors with the problems as dicts, which give Python texts, positions and hints.
void raise_error(Error const& error) {
  nb::list problems;
  std::string text;
  for (Problem const& problem : error.problems()) {
    nb::dict entry;
    entry["what"] = problem.what;
    entry["hint"] = problem.hint;
    entry["key"] = problem.key;
    entry["file"] = problem.file;
    entry["line"] = problem.line;
    entry["column"] = problem.column;
    problems.append(entry);
    text += (text.empty() ? "" : "\n") + to_text(problem);
  }
  nb::object const type = nb::module_::import_("gridlock.errors").attr("Error");
  nb::object const exception = type(text, problems);
  PyErr_SetObject(type.ptr(), exception.ptr());
}

}  // namespace

NB_MODULE(_core, module) {
  nb::register_exception_translator([](std::exception_ptr const& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (Error const& error) {
      raise_error(error);
    } catch (RunFailure const& failure) {
      PyErr_SetString(nb::module_::import_("gridlock.errors").attr("RunFailure").ptr(), failure.what());
    }
  });
  module.attr("version") = version();
  bind_analysis(module);
  bind_files(module);
  bind_grid(module);
  bind_model(module);
  bind_packing(module);
  bind_simulation(module);
}

}  // namespace gridlock::python
