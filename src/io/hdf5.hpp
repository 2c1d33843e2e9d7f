#pragma once

#include <hdf5.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

/// Functions of the C library HDF5 that Gridlock uses, with owners for handles and exceptions for errors.
namespace gridlock::hdf5 {

/// A failed call of HDF5, with the message of HDF5.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws Failure("cannot <what>: <reason given by HDF5>").
[[noreturn]] void fail(std::string const& what);

/// Returns a result of HDF5; throws Failure if it is negative, which means that the call failed.
template <class Result>
Result require(Result result, std::string const& what) {
  if (result < 0) fail(what);
  return result;
}

/// Owns an id of HDF5.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close closing, std::string const& what) : id_(require(id, what)), close_(closing) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(other.id_), close_(other.close_) { other.id_ = -1; }
  Handle& operator=(Handle&& other) noexcept {
    if (this == &other) return *this;
    reset();
    id_ = other.id_;
    close_ = other.close_;
    other.id_ = -1;
    return *this;
  }

  [[nodiscard]] hid_t id() const { return id_; }
  /// Closes the id now, and throws if HDF5 cannot write the data that it still holds.
  void close(std::string const& what) {
    hid_t const id = id_;
    id_ = -1;
    require(close_(id), what);
  }

 private:
  void reset() noexcept {
    if (id_ >= 0) close_(id_);
    id_ = -1;
  }

  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Returns the HDF5 type of a C++ number.
template <class Number>
hid_t native() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<Number, std::uint32_t>) return H5T_NATIVE_UINT32;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<Number, std::int64_t>) return H5T_NATIVE_INT64;
}

/// The purpose for which a file is opened.
enum class Access {
  read,    ///< reading, also beside a writer or after a kill
  append,  ///< writing in an order that keeps the file readable at any moment
};

/// Reserves `bytes` behind the end of a file, which is created if missing; the next H5Fclose releases unused bytes. On
/// a full disk this throws before HDF5 begins to write, since HDF5 does not recover from a failed write.
void reserve(std::filesystem::path const& path, std::size_t bytes);
/// Returns the size of a file in bytes. Throws Failure if it is empty or not a regular file, for which HDF5 would wait.
std::uint64_t size_of_file(std::filesystem::path const& path);
/// Returns a sentence part about a file that is shorter than its header declares; empty otherwise. The file may be cut
/// off, or a writer is at work or was stopped by a full disk; then all frames may be complete.
std::string shortness_of(std::filesystem::path const& path);
Handle create_file(std::filesystem::path const& path);
Handle open_file(std::filesystem::path const& path, Access access);
/// Makes a file of a killed writer ready to be opened again. Check for damage first, since this function writes.
void repair_file(std::filesystem::path const& path);
void flush(Handle const& file);

Handle create_group(Handle const& parent, std::string const& path);
/// Opens a group. Errors: Failure if a link leads to another file.
Handle open_group(Handle const& parent, std::string const& path);
/// Returns the names in a group in order of creation, or in alphabetical order if the file does not store that order.
std::vector<std::string> names_in(Handle const& group);
/// Returns the group or dataset at a path; nothing if there is none or an object of another kind. Errors: Failure if a
/// link leads to another file.
std::optional<Handle> find_group(Handle const& file, std::string const& path);
std::optional<Handle> find_dataset(Handle const& file, std::string const& path);
bool has(Handle const& parent, std::string const& path);
/// Gives the object at `from` a second name, `to`.
void link(Handle const& file, std::string const& from, std::string const& to);

void write_text(Handle const& file, std::string const& path, std::string const& text);
std::string read_text(Handle const& file, std::string const& path);

void set_attribute(Handle const& object, std::string const& name, std::string const& text);
void set_attribute(Handle const& object, std::string const& name, std::vector<std::string> const& texts);
void set_attribute(Handle const& object, std::string const& name, std::span<int const> numbers);
/// Sets an attribute to a reference to an object of the file.
void set_reference(Handle const& object, std::string const& name, Handle const& file, std::string const& path);
bool has_attribute(Handle const& object, std::string const& name);
std::vector<std::string> read_texts(Handle const& object, std::string const& name);
/// Returns the numbers of an attribute of any numeric type; none if the attribute is missing or not numeric.
std::vector<double> read_numbers(Handle const& object, std::string const& name);
/// Returns the text of an attribute; empty if it is missing.
std::string read_text_attribute(Handle const& object, std::string const& name);

/// Opens a dataset. Errors: Failure for links to other files, numbers in other files, and filters Gridlock never uses.
Handle open_dataset(Handle const& parent, std::string const& path);
std::vector<hsize_t> extent_of(Handle const& dataset);

/// A rectangular part of a dataset.
struct Part {
  std::vector<hsize_t> start;
  std::vector<hsize_t> count;
};

/// Reads numbers of a dataset whose type is exactly Number.
template <class Number>
std::vector<Number> read(Handle const& dataset, Part const& part);

/// The kind of numbers in a dataset.
enum class NumberKind { real, whole, positive_whole, other };
/// Returns the kind of numbers; named values (enumerations) count as numbers.
NumberKind kind_of_numbers(Handle const& dataset);
/// Returns the bytes of each number.
std::size_t width_of_numbers(Handle const& dataset);
/// Reads numbers of any type and converts them; a value outside the range of Number becomes the nearest that fits. An
/// empty part reads a single number.
template <class Number>
std::vector<Number> read_as(Handle const& dataset, Part const& part);

/// Writes numbers into a part of an existing dataset.
template <class Number>
void write(Handle const& dataset, Part const& part, std::span<Number const> numbers);

/// Returns whether a dataset holds numbers of the type Number.
template <class Number>
bool holds(Handle const& dataset);

}  // namespace gridlock::hdf5
