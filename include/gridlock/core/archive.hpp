#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock {

/// Writes the members of an object to a checkpoint, or reads them back into the object, each under a name.
///
/// A class lists its members once, in `void serialize(Archive&)` or `void serialize(Archive&, Thing&)`. That one
/// function both saves and restores, so that the two directions always agree. Errors while restoring: Error for a name
/// that is missing or whose value has another type. A file can hold any values: a serialize() that restores also checks
/// its members together (equal lengths, numbers in range) and throws Error.
///
/// ```cpp
/// struct Sum {
///   double value = 0.0;
///   std::vector<double> terms;
///   void serialize(Archive& archive) {
///     archive.visit("value", value);
///     archive.visit("terms", terms);
///   }
/// };
/// ```
class Archive {
 public:
  Archive() = default;
  Archive(Archive const&) = delete;
  Archive& operator=(Archive const&) = delete;
  virtual ~Archive() = default;

  /// Returns true if the archive writes values into the object, false if it reads them from the object.
  [[nodiscard]] virtual bool is_restoring() const = 0;

  /// Returns whether the archive has a member `name`, for members that not every object saves.
  /// Contract: is_restoring().
  [[nodiscard]] virtual bool has(std::string_view /*name*/) const { return false; }

  /// Opens the group `name`: all members visited until the matching leave() belong to it.
  virtual void enter(std::string_view name) = 0;
  virtual void leave() = 0;

  /// Saves or restores one member with every bit of its numbers, also −0, infinities and NaN.
  virtual void visit(std::string_view name, bool& value) = 0;
  virtual void visit(std::string_view name, double& value) = 0;
  virtual void visit(std::string_view name, std::uint64_t& value) = 0;
  virtual void visit(std::string_view name, std::string& value) = 0;
  virtual void visit(std::string_view name, std::vector<double>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::int32_t>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::uint32_t>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::uint64_t>& values) = 0;

  /// Saves or restores one value for each row of the agents, or an empty array. Where several processes share the
  /// agents, each has the values of its own rows, and the archive may put the rows of all processes together.
  virtual void visit_rows(std::string_view name, std::vector<double>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::int32_t>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::uint32_t>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::uint64_t>& values) { visit(name, values); }

  /// Throws Error with the text `what` unless `holds`: for restored values that cannot be right.
  void require(bool holds, char const* what) const;
};

/// Calls serialize_members() inside the group `name`.
template <class SerializeMembers>
void serialize_inside(Archive& archive, std::string_view name, SerializeMembers serialize_members) {
  archive.enter(name);
  serialize_members();
  archive.leave();
}

/// Serializes an unsigned integer of any width as an integer of 64 bits.
template <std::unsigned_integral Number>
void serialize_number(Archive& archive, std::string_view name, Number& number) {
  std::uint64_t wide = number;
  archive.visit(name, wide);
  archive.require(wide <= std::numeric_limits<Number>::max(), "a number is too large");
  number = static_cast<Number>(wide);
}

}  // namespace gridlock
