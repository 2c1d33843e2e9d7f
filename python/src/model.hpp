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

/// The type of models in Python for the templates World and EngineFor.
struct TableModel {
  using Agents = AgentTable;
};

using SettingValue = std::variant<bool, std::uint64_t, double, std::string, std::vector<double>>;

/// A setting of a model in Python; see SettingInfo.
struct SettingDefinition {
  std::string key;
  std::string unit;
  std::string documentation;
  double min = 0.0;
  double max = 0.0;
  std::vector<std::string> choices;  ///< allowed words; empty if any text is allowed
  SettingValue value;
};

/// A Python object that threads may hold and release without the GIL, even after the interpreter ends.
class SharedObject {
 public:
  SharedObject() = default;
  explicit SharedObject(nb::object object);
  [[nodiscard]] nb::handle get() const { return handle_ ? *handle_ : nb::handle(); }

 private:
  std::shared_ptr<nb::handle> handle_;
};

/// The agents and settings that a class of Python declares.
struct ModelDefinition {
  SharedObject type;
  std::string name;
  std::string documentation;
  std::vector<TableColumn> columns;  ///< columns besides x and y, without values; see AgentTable
  std::size_t kinds = 1;             ///< number of kinds of agents
  std::vector<std::string> events;
  std::map<std::string, std::vector<std::string>> value_names;  ///< meanings of values 0, 1, 2 … by column
  std::vector<SettingDefinition> settings;
};

/// Calls a function of Python with the GIL held. Errors: an Error of Gridlock becomes the C++ Error; other exceptions
/// stay as they are.
nb::object call_python(std::function<nb::object()> const& call);

/// Converts an exception of a model into a RunFailure with the step, which keeps the exception for Python.
RunFailure failure_of(nb::python_error& error, std::string const& model, std::uint64_t step);

/// Returns an empty column of type "float64", "int32", "uint32" or "uint64". Errors: Error for another type.
ColumnValues empty_column(std::string const& type);

}  // namespace gridlock::python
