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

/// The functions of the C library HDF5 that Gridlock needs, with owners for its handles and exceptions for its errors.
namespace gridlock::hdf5 {

/// A call of HDF5 that failed, in its own words.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Throws Failure("cannot <what>: <reason of HDF5>").
[[noreturn]] void fail(std::string const& what);

/// A result of HDF5, negative where the call failed.
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
  /// Closes now, and throws where that fails, as it does where what was left to write cannot be.
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

/// The type of HDF5 that holds a number of C++.
template <class Number>
hid_t native() {
  if constexpr (std::is_same_v<Number, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<Number, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<Number, std::uint32_t>) return H5T_NATIVE_UINT32;
  if constexpr (std::is_same_v<Number, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<Number, std::int64_t>) return H5T_NATIVE_INT64;
}

/// How a file is opened.
enum class Access {
  read,    ///< while it is written or after a kill too
  append,  ///< in the order that keeps the file readable whenever the process ends
};

/// Makes room behind the end of a file, which begins to exist with it, for so many bytes, which the next H5Fclose gives
/// back where they are not used: on a full disk this fails before HDF5 has begun to write, which does not recover from
/// it.
void reserve(std::filesystem::path const& path, std::size_t bytes);
/// The bytes of a file. Throws Failure for what is no regular file, which HDF5 would wait for, and for an empty one.
std::uint64_t size_of_file(std::filesystem::path const& path);
/// How much of a file is left, in words, where it is shorter than its head says; nothing otherwise. A cut is the usual
/// reason, and not the only one: where a writer is at work or was stopped by a full disk, no frame has to be missing.
std::string shortness_of(std::filesystem::path const& path);
Handle create_file(std::filesystem::path const& path);
Handle open_file(std::filesystem::path const& path, Access access);
/// Makes a file whose writer was killed fit to be opened again. What is damaged must be refused before: this writes.
void repair_file(std::filesystem::path const& path);
void flush(Handle const& file);

Handle create_group(Handle const& parent, std::string const& path);
/// Refuses a link to another file.
Handle open_group(Handle const& parent, std::string const& path);
/// The names in a group, in the order they were created, or that of the alphabet where the file does not know it.
std::vector<std::string> names_in(Handle const& group);
/// The group or dataset at a path; nothing where there is none, or something of another kind. Refuses links to other
/// files.
std::optional<Handle> find_group(Handle const& file, std::string const& path);
std::optional<Handle> find_dataset(Handle const& file, std::string const& path);
bool has(Handle const& parent, std::string const& path);
/// A second name for the same thing.
void link(Handle const& file, std::string const& from, std::string const& to);

void write_text(Handle const& file, std::string const& path, std::string const& text);
std::string read_text(Handle const& file, std::string const& path);

void set_attribute(Handle const& object, std::string const& name, std::string const& text);
void set_attribute(Handle const& object, std::string const& name, std::vector<std::string> const& texts);
void set_attribute(Handle const& object, std::string const& name, std::span<int const> numbers);
/// An attribute that points to an object of the file.
void set_reference(Handle const& object, std::string const& name, Handle const& file, std::string const& path);
bool has_attribute(Handle const& object, std::string const& name);
std::vector<std::string> read_texts(Handle const& object, std::string const& name);
/// The numbers of an attribute, whatever their type; none where there is none, or no numbers.
std::vector<double> read_numbers(Handle const& object, std::string const& name);
/// The text of an attribute, empty where there is none.
std::string read_text_attribute(Handle const& object, std::string const& name);

/// Refuses a link to another file, numbers in other files and filters that are not written here.
Handle open_dataset(Handle const& parent, std::string const& path);
std::vector<hsize_t> extent_of(Handle const& dataset);

/// A rectangular part of a dataset.
struct Part {
  std::vector<hsize_t> start;
  std::vector<hsize_t> count;
};

/// Reads numbers of exactly the type stored.
template <class Number>
std::vector<Number> read(Handle const& dataset, Part const& part);

/// The kinds of numbers that a dataset may hold.
enum class NumberKind { real, whole, positive_whole, other };
/// Names of numbers are numbers too.
NumberKind kind_of_numbers(Handle const& dataset);
/// Bytes of each number.
std::size_t width_of_numbers(Handle const& dataset);
/// Reads numbers of any type as those asked for: HDF5 takes the nearest where one does not fit. An empty part is a
/// single number.
template <class Number>
std::vector<Number> read_as(Handle const& dataset, Part const& part);

/// Writes numbers into a part of a dataset that is there already.
template <class Number>
void write(Handle const& dataset, Part const& part, std::span<Number const> numbers);

/// Whether a dataset holds numbers of this type.
template <class Number>
bool holds(Handle const& dataset);

}  // namespace gridlock::hdf5
