#include <algorithm>
#include <cstddef>

#include "io/hdf5.hpp"

namespace gridlock::hdf5 {

namespace {

Handle text_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "describe a text");
  require(H5Tset_size(type.id(), std::max<std::size_t>(length, 1)), "describe a text");
  require(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "describe a text");
  require(H5Tset_cset(type.id(), H5T_CSET_UTF8), "describe a text");
  return type;
}

Handle scalar() { return {H5Screate(H5S_SCALAR), H5Sclose, "describe a single value"}; }

void trim_padding(std::string& text) {
  while (!text.empty() && text.back() == '\0') text.pop_back();
}

constexpr std::size_t longest_text = std::size_t{1} << 28;

std::size_t text_length(Handle const& type, std::string const& name) {
  bool const is_text = H5Tget_class(type.id()) == H5T_STRING && H5Tis_variable_str(type.id()) == 0;
  std::size_t const length = is_text ? H5Tget_size(type.id()) : 0;
  if (length == 0 || length > longest_text) throw Failure(name + " is not the text it should be");
  return length;
}

}  // namespace

void write_text(Handle const& file, std::string const& path, std::string const& text) {
  Handle const type = text_type(text.size());
  Handle const space = scalar();
  Handle const dataset(
      H5Dcreate2(file.id(), path.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
      "create " + path);
  char const nothing = '\0';
  char const* const bytes = text.empty() ? &nothing : text.data();
  require(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes), "write " + path);
}

std::string read_text(Handle const& file, std::string const& path) {
  Handle const dataset = open_dataset(file, path);
  Handle const type(H5Dget_type(dataset.id()), H5Tclose, "look at " + path);
  if (!extent_of(dataset).empty()) throw Failure(path + " is not a single text");
  std::string text(text_length(type, path), '\0');
  require(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()), "read " + path);
  trim_padding(text);
  return text;
}

void set_attribute(Handle const& object, std::string const& name, std::string const& text) {
  Handle const type = text_type(text.size());
  Handle const space = scalar();
  Handle const attribute(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create the attribute " + name);
  char const nothing = '\0';
  char const* const bytes = text.empty() ? &nothing : text.data();
  require(H5Awrite(attribute.id(), type.id(), bytes), "write the attribute " + name);
}

void set_attribute(Handle const& object, std::string const& name, std::vector<std::string> const& texts) {
  std::size_t length = 1;
  for (std::string const& text : texts) length = std::max(length, text.size());
  std::string bytes;
  for (std::string text : texts) {
    text.resize(length, '\0');
    bytes += text;
  }
  Handle const type = text_type(length);
  hsize_t const count = texts.size();
  Handle const space(H5Screate_simple(1, &count, nullptr), H5Sclose, "describe the attribute " + name);
  Handle const attribute(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create the attribute " + name);
  require(H5Awrite(attribute.id(), type.id(), bytes.data()), "write the attribute " + name);
}

void set_attribute(Handle const& object, std::string const& name, std::span<int const> numbers) {
  hsize_t const count = numbers.size();
  Handle const space =
      count == 1 ? scalar() : Handle(H5Screate_simple(1, &count, nullptr), H5Sclose, "describe the attribute " + name);
  Handle const attribute(H5Acreate2(object.id(), name.c_str(), H5T_NATIVE_INT32, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create the attribute " + name);
  require(H5Awrite(attribute.id(), H5T_NATIVE_INT, numbers.data()), "write the attribute " + name);
}

void set_reference(Handle const& object, std::string const& name, Handle const& file, std::string const& path) {
  hobj_ref_t reference{};
  require(H5Rcreate(&reference, file.id(), path.c_str(), H5R_OBJECT, -1), "refer to " + path);
  Handle const space = scalar();
  Handle const attribute(H5Acreate2(object.id(), name.c_str(), H5T_STD_REF_OBJ, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose, "create the attribute " + name);
  require(H5Awrite(attribute.id(), H5T_STD_REF_OBJ, &reference), "write the attribute " + name);
}

bool has_attribute(Handle const& object, std::string const& name) { return H5Aexists(object.id(), name.c_str()) > 0; }

namespace {

/// Reads texts of variable length, as h5py writes them. HDF5 allocates the memory of such texts, so it is freed here.
std::vector<std::string> read_texts_of_any_length(Handle const& attribute, Handle const& type, Handle const& space,
                                                  std::string const& name) {
  hssize_t const count = H5Sget_simple_extent_npoints(space.id());
  if (count < 1 || count > 64) throw Failure("the attribute " + name + " has another size than it should");
  std::vector<char*> pointers(static_cast<std::size_t>(count), nullptr);
  require(H5Aread(attribute.id(), type.id(), pointers.data()), "read the attribute " + name);
  std::vector<std::string> texts;
  for (char const* pointer : pointers) texts.emplace_back(pointer == nullptr ? "" : pointer);
  H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, pointers.data());
  return texts;
}

}  // namespace

std::vector<double> read_numbers(Handle const& object, std::string const& name) {
  if (H5Aexists(object.id(), name.c_str()) <= 0) return {};
  Handle const attribute(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), H5Aclose, "find the attribute " + name);
  Handle const type(H5Aget_type(attribute.id()), H5Tclose, "look at the attribute " + name);
  Handle const space(H5Aget_space(attribute.id()), H5Sclose, "look at the attribute " + name);
  H5T_class_t const kind = H5Tget_class(type.id());
  hssize_t const count = H5Sget_simple_extent_npoints(space.id());
  if ((kind != H5T_FLOAT && kind != H5T_INTEGER) || count < 1 || count > 64) return {};
  std::vector<double> numbers(static_cast<std::size_t>(count));
  require(H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, numbers.data()), "read the attribute " + name);
  return numbers;
}

std::vector<std::string> read_texts(Handle const& object, std::string const& name) {
  Handle const attribute(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), H5Aclose, "find the attribute " + name);
  Handle const type(H5Aget_type(attribute.id()), H5Tclose, "look at the attribute " + name);
  Handle const space(H5Aget_space(attribute.id()), H5Sclose, "look at the attribute " + name);
  if (H5Tis_variable_str(type.id()) > 0) return read_texts_of_any_length(attribute, type, space, name);
  std::size_t const length = text_length(type, "the attribute " + name);
  hssize_t const count = H5Sget_simple_extent_npoints(space.id());
  if (count < 1 || count > 64) throw Failure("the attribute " + name + " has another size than it should");
  std::string bytes(length * static_cast<std::size_t>(count), '\0');
  require(H5Aread(attribute.id(), type.id(), bytes.data()), "read the attribute " + name);
  std::vector<std::string> texts;
  for (std::size_t at = 0; at < bytes.size(); at += length) {
    texts.push_back(bytes.substr(at, length));
    trim_padding(texts.back());
  }
  return texts;
}

std::string read_text_attribute(Handle const& object, std::string const& name) {
  return has_attribute(object, name) ? read_texts(object, name).front() : "";
}

}  // namespace gridlock::hdf5
