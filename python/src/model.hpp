#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "agent_table.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/engine/engine.hpp"

namespace gridlock::python {

namespace nb = nanobind;

/// A model of Python as World and EngineFor take it.
struct TableModel {
  using Agents = AgentTable;
};

using SettingValue = std::variant<bool, std::uint64_t, double, std::string, std::vector<double>>;

/// A setting of a model of Python; see SettingInfo.
struct SettingDefinition {
  std::string key;
  std::string unit;
  std::string documentation;
  double min = 0.0;
  double max = 0.0;
  std::vector<std::string> choices;  ///< the words it can be, where it is one of a list
  SettingValue value;
};

/// A Python object that may be held and let go by threads without the lock of the interpreter, and after its end.
class SharedObject {
 public:
  SharedObject() = default;
  explicit SharedObject(nb::object object);
  [[nodiscard]] nb::handle get() const { return handle_ ? *handle_ : nb::handle(); }

 private:
  std::shared_ptr<nb::handle> handle_;
};

/// What a class of Python says of its agents and settings.
struct ModelDefinition {
  SharedObject type;
  std::string name;
  std::string documentation;
  std::vector<TableColumn> columns;  ///< without values; besides x and y
  std::vector<std::string> events;
  std::map<std::string, std::vector<std::string>> value_names;  ///< of the numbers 0, 1, 2 … of a column
  std::vector<SettingDefinition> settings;
};

/// Calls a function of Python, for which the lock is held. Errors: an Error of Gridlock as one of C++; others as they
/// are.
nb::object call_python(std::function<nb::object()> const& call);

/// What an exception of a model becomes in a run: a RunFailure with the step, and the exception behind it for Python.
RunFailure failure_of(nb::python_error& error, std::string const& model, std::uint64_t step);

/// The column of that type without values: "float64", "int32", "uint32" or "uint64". Errors: Error.
ColumnValues empty_column(std::string const& type);

}  // namespace gridlock::python
