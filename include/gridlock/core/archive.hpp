#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace gridlock {

/// Serializes by name everything that must outlive the process, out of an object or back into it.
///
/// An object names its members once, in `void serialize(Archive&)` or `void serialize(Archive&, Thing&)`, and that one
/// function serves both directions, so that what is saved and what is restored cannot drift apart. Errors while
/// restoring: Error for a name that is missing or of another type; a serialize() that restores checks what its members
/// must satisfy together (lengths that agree, numbers in range) and throws Error too, since a file can hold anything.
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

  /// Whether values come out of the archive into the object.
  [[nodiscard]] virtual bool is_restoring() const = 0;

  /// All members visited until the matching leave() are inside `name`.
  virtual void enter(std::string_view name) = 0;
  virtual void leave() = 0;

  /// Every bit of a number survives, also of −0, infinities and NaN.
  virtual void visit(std::string_view name, bool& value) = 0;
  virtual void visit(std::string_view name, double& value) = 0;
  virtual void visit(std::string_view name, std::uint64_t& value) = 0;
  virtual void visit(std::string_view name, std::string& value) = 0;
  virtual void visit(std::string_view name, std::vector<double>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::int32_t>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::uint32_t>& values) = 0;
  virtual void visit(std::string_view name, std::vector<std::uint64_t>& values) = 0;

  /// A value for each row of the agents, now or when they were noted down, or no values. Where processes divide the
  /// rows, each has those of its own rows, and an archive may put them together.
  virtual void visit_rows(std::string_view name, std::vector<double>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::int32_t>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::uint32_t>& values) { visit(name, values); }
  virtual void visit_rows(std::string_view name, std::vector<std::uint64_t>& values) { visit(name, values); }

  /// Throws Error where what was restored cannot be: `what` says what is wrong with it.
  void require(bool holds, char const* what) const;
};

/// Serializes what `serialize_members` visits inside `name`.
template <class SerializeMembers>
void serialize_inside(Archive& archive, std::string_view name, SerializeMembers serialize_members) {
  archive.enter(name);
  serialize_members();
  archive.leave();
}

/// Serializes a whole number of any type as one of 64 bits.
template <std::unsigned_integral Number>
void serialize_number(Archive& archive, std::string_view name, Number& number) {
  std::uint64_t wide = number;
  archive.visit(name, wide);
  archive.require(wide <= std::numeric_limits<Number>::max(), "a number is too large");
  number = static_cast<Number>(wide);
}

}  // namespace gridlock
