#include "io/hdf5.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <functional>
#include <numeric>
#include <system_error>
#include <utility>

namespace gridlock::hdf5 {

namespace {

/// Turns off HDF5's error messages on stderr, in every thread.
void keep_quiet() {
  // A file that a full disk kept from closing would be closed again by HDF5 at exit, which crashes. Gridlock closes all
  // handles itself, so this step is switched off.
  [[maybe_unused]] static herr_t const once = H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Handle access_list() {
  keep_quiet();
  Handle list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare the access to a file");
  require(H5Pset_libver_bounds(list.id(), H5F_LIBVER_V110, H5F_LIBVER_V110), "choose the format");
  require(H5Pset_fclose_degree(list.id(), H5F_CLOSE_STRONG), "choose how a file is closed");
  // A reader that locks the file would keep its writer out. The order of writing protects readers without locks.
  require(H5Pset_file_locking(list.id(), false, true), "leave the file unlocked");
  return list;
}

/// Alignments of metadata in bytes. A kill may cut a write where it crosses a page of memory, so metadata that HDF5
/// overwrites must not cross a page, or their checksum is lost.
constexpr hsize_t max_header_bytes = 512;     ///< for the metadata at the start of a file
constexpr hsize_t max_metadata_bytes = 2048;  ///< for the metadata of a frame: nodes of its chunk indices
Handle writer_access_list(hsize_t alignment) {
  Handle list = access_list();
  require(H5Pset_alignment(list.id(), 1, alignment), "choose the alignment");
  // There is no second writer whose half-written page would be whole on another attempt. By default HDF5 tries 100
  // times, with long pauses.
  require(H5Pset_metadata_read_attempts(list.id(), 1), "choose how often to read again");
  return list;
}

/// Stores the name of the file that a link leads to, and keeps HDF5 from following the link.
herr_t stay_in_file(char const*, char const*, char const* file, char const*, unsigned*, hid_t, void* other_file) {
  *static_cast<std::string*>(other_file) = file;
  return -1;
}

/// Calls open(access list) for an object, with an access list of class `list_class`. Throws if the path contains a link
/// to another file, since a file of unknown origin must not give access to other files of this machine.
template <class Open>
Handle opened_in_file(hid_t list_class, std::string const& path, Handle::Close close, Open open) {
  keep_quiet();
  Handle const list(H5Pcreate(list_class), H5Pclose, "prepare to look for " + path);
  std::string other_file;
  require(H5Pset_elink_cb(list.id(), stay_in_file, &other_file), "prepare to look for " + path);
  hid_t const id = open(list.id());
  if (!other_file.empty()) throw Failure(fmt::format("{} is a link to another file, {}", path, other_file));
  return {id, close, "find " + path};
}

/// Throws if a dataset has its numbers in other files, or is packed by filters that Gridlock never uses, since HDF5
/// would search for libraries with these filters.
void require_own_numbers(Handle const& dataset, std::string const& path) {
  Handle const list(H5Dget_create_plist(dataset.id()), H5Pclose, "look at " + path);
  if (H5Pget_layout(list.id()) == H5D_VIRTUAL || H5Pget_external_count(list.id()) != 0) {
    throw Failure(path + " has its numbers in other files");
  }
  int const filters = require(H5Pget_nfilters(list.id()), "look at " + path);
  for (int k = 0; k < filters; ++k) {
    unsigned flags = 0;
    std::size_t no_parameters = 0;
    H5Z_filter_t const filter =
        H5Pget_filter2(list.id(), static_cast<unsigned>(k), &flags, &no_parameters, nullptr, 0, nullptr, nullptr);
    // These filters are part of HDF5 itself and load no library.
    constexpr std::array own{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32, H5Z_FILTER_NBIT,
                             H5Z_FILTER_SCALEOFFSET};
    if (std::ranges::find(own, filter) != own.end()) continue;
    throw Failure(fmt::format("{} is packed by a filter of HDF5 (number {}) that gridlock does not use", path, filter));
  }
}

Handle selection(Handle const& dataset, Part const& part) {
  Handle space(H5Dget_space(dataset.id()), H5Sclose, "look at a dataset");
  if (H5Sget_simple_extent_ndims(space.id()) != static_cast<int>(part.start.size())) {
    throw Failure("a dataset has another number of dimensions than it should");
  }
  require(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, part.start.data(), nullptr, part.count.data(), nullptr),
          "choose a part of a dataset");
  return space;
}

Handle memory_of(Part const& part) {
  return {H5Screate_simple(static_cast<int>(part.count.size()), part.count.data(), nullptr), H5Sclose,
          "describe the memory of a dataset"};
}

std::size_t size_of(Part const& part) {
  return std::accumulate(part.count.begin(), part.count.end(), std::size_t{1}, std::multiplies<>());
}

}  // namespace

void fail(std::string const& what) {
  std::string reason;
  // The entry at depth 0 of the error stack is the cause.
  auto const take_first = [](unsigned depth, H5E_error2_t const* error, void* text) -> herr_t {
    if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_first, &reason);
  throw Failure(fmt::format("cannot {}{}{}", what, reason.empty() ? "" : ": ", reason));
}

void reserve(std::filesystem::path const& path, std::size_t bytes) {
  auto const fail_for = [](int error) {
    throw Failure("cannot write to the file: " + std::generic_category().message(error));
  };
  int const file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file < 0) fail_for(errno);
  struct stat status {};
  int error = ::fstat(file, &status) == 0 ? 0 : errno;
  if (error == 0 && ::fallocate(file, 0, status.st_size, static_cast<off_t>(bytes)) != 0 && errno != EOPNOTSUPP) {
    error = errno;
    // A failed fallocate() may have lengthened the file.
    if (::ftruncate(file, status.st_size) != 0) error = errno;
  }
  ::close(file);
  if (error != 0) fail_for(error);
}

std::uint64_t size_of_file(std::filesystem::path const& path) {
  std::error_code error;
  std::filesystem::file_type const type = std::filesystem::status(path, error).type();
  if (type == std::filesystem::file_type::directory) throw Failure("it is a directory");
  std::uintmax_t const bytes = std::filesystem::file_size(path, error);
  if (!error && bytes > 0) return bytes;
  if (!error) throw Failure("it is empty");
  bool const is_there = type != std::filesystem::file_type::none && type != std::filesystem::file_type::not_found;
  bool const is_regular = type == std::filesystem::file_type::regular;
  throw Failure(is_there && !is_regular ? "it is not a regular file" : error.message());
}

std::string shortness_of(std::filesystem::path const& path) {
  try {
    std::uint64_t const bytes = size_of_file(path);
    Handle const file = open_file(path, Access::read);
    haddr_t end = 0;
    require(H5Fget_eoa(file.id(), &end), "find the end of the file");
    if (bytes >= end) return "";
    return fmt::format("it is cut off: {} of its {} bytes are there", bytes, end);
  } catch (Failure const&) {
    return "";
  }
}

Handle create_file(std::filesystem::path const& path) {
  constexpr std::size_t min_bytes = 32768;
  reserve(path, min_bytes);
  Handle const list = writer_access_list(max_header_bytes);
  return {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, list.id()), H5Fclose, "create the file"};
}

Handle open_file(std::filesystem::path const& path, Access access) {
  if (access == Access::append) {
    Handle const list = writer_access_list(max_metadata_bytes);
    return {H5Fopen(path.c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, list.id()), H5Fclose, "open the file"};
  }
  Handle const list = access_list();
  // A torn read of a page that is being written is tried again after a pause that doubles each time, 1 ms in all. The
  // default of 100 attempts would take for ever on a damaged file.
  require(H5Pset_metadata_read_attempts(list.id(), 20), "choose how often to read again");
  // After a full disk the file may be shorter than its header declares; the data before the end are complete.
  bool const yes = true;
  require(H5Pset(list.id(), "skip_eof_check", &yes), "open the file");
  // SWMR read mode allows a writer, living or killed. Older files of other programs allow only plain read mode.
  hid_t const beside_writer = H5Fopen(path.c_str(), H5F_ACC_RDONLY | H5F_ACC_SWMR_READ, list.id());
  if (beside_writer >= 0) return {beside_writer, H5Fclose, "open the file"};
  if (H5Fis_hdf5(path.c_str()) == 0) throw Failure("it is no HDF5 file");
  return {H5Fopen(path.c_str(), H5F_ACC_RDONLY, list.id()), H5Fclose, "open the file"};
}

void repair_file(std::filesystem::path const& path) {
  Handle const list = writer_access_list(max_metadata_bytes);
  // Clears the mark of the killed writer and puts new data behind all old data, as h5clear does. SWMR mode keeps the
  // file readable if this process is killed too.
  bool const yes = true;
  require(H5Pset(list.id(), "clear_status_flags", &yes), "repair the file");
  require(H5Pset(list.id(), "skip_eof_check", &yes), "repair the file");
  Handle file(H5Fopen(path.c_str(), H5F_ACC_RDWR | H5F_ACC_SWMR_WRITE, list.id()), H5Fclose, "repair the file");
  require(H5Fincrement_filesize(file.id(), 0), "repair the file");
  file.close("repair the file");
}

void flush(Handle const& file) { require(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "write to the file"); }

Handle create_group(Handle const& parent, std::string const& path) {
  Handle const list(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "prepare a group");
  require(H5Pset_link_creation_order(list.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED), "prepare a group");
  return {H5Gcreate2(parent.id(), path.c_str(), H5P_DEFAULT, list.id(), H5P_DEFAULT), H5Gclose, "create " + path};
}

Handle open_group(Handle const& parent, std::string const& path) {
  return opened_in_file(H5P_GROUP_ACCESS, path, H5Gclose,
                        [&](hid_t access) { return H5Gopen2(parent.id(), path.c_str(), access); });
}

std::vector<std::string> names_in(Handle const& group) {
  H5G_info_t info{};
  require(H5Gget_info(group.id(), &info), "look into a group");
  Handle const list(H5Gget_create_plist(group.id()), H5Pclose, "look into a group");
  unsigned order = 0;
  require(H5Pget_link_creation_order(list.id(), &order), "look into a group");
  H5_index_t const index = (order & H5P_CRT_ORDER_TRACKED) != 0U ? H5_INDEX_CRT_ORDER : H5_INDEX_NAME;
  std::vector<std::string> names;
  for (hsize_t k = 0; k < info.nlinks; ++k) {
    auto const name_into = [&](char* text, std::size_t size) {
      return require(H5Lget_name_by_idx(group.id(), ".", index, H5_ITER_INC, k, text, size, H5P_DEFAULT),
                     "read the names in a group");
    };
    std::string name(static_cast<std::size_t>(name_into(nullptr, 0)), '\0');
    name_into(name.data(), name.size() + 1);
    names.push_back(std::move(name));
  }
  return names;
}

namespace {

/// Returns whether an absolute path exists. HDF5 requires a check for each part of the path.
bool is_there(Handle const& file, std::string const& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    std::string const part = path.substr(0, end);
    if (H5Lexists(file.id(), part.c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
    // find_group() refuses links to other files, which H5Lexists() would follow.
    if (!find_group(file, part)) return false;
  }
}

H5I_type_t kind_at(Handle const& file, std::string const& path) {
  if (!is_there(file, path)) return H5I_BADID;
  Handle const object = opened_in_file(H5P_LINK_ACCESS, path, H5Oclose,
                                       [&](hid_t access) { return H5Oopen(file.id(), path.c_str(), access); });
  return H5Iget_type(object.id());
}

}  // namespace

std::optional<Handle> find_group(Handle const& file, std::string const& path) {
  if (kind_at(file, path) != H5I_GROUP) return std::nullopt;
  return open_group(file, path);
}

std::optional<Handle> find_dataset(Handle const& file, std::string const& path) {
  if (kind_at(file, path) != H5I_DATASET) return std::nullopt;
  return open_dataset(file, path);
}

bool has(Handle const& parent, std::string const& path) {
  return require(H5Lexists(parent.id(), path.c_str(), H5P_DEFAULT), "look for " + path) > 0;
}

void link(Handle const& file, std::string const& from, std::string const& to) {
  require(H5Lcreate_hard(file.id(), from.c_str(), file.id(), to.c_str(), H5P_DEFAULT, H5P_DEFAULT), "create " + to);
}

Handle open_dataset(Handle const& parent, std::string const& path) {
  Handle dataset = opened_in_file(H5P_DATASET_ACCESS, path, H5Dclose,
                                  [&](hid_t access) { return H5Dopen2(parent.id(), path.c_str(), access); });
  require_own_numbers(dataset, path);
  return dataset;
}

std::vector<hsize_t> extent_of(Handle const& dataset) {
  Handle const space(H5Dget_space(dataset.id()), H5Sclose, "look at a dataset");
  int const dimensions = require(H5Sget_simple_extent_ndims(space.id()), "look at a dataset");
  std::vector<hsize_t> extent(static_cast<std::size_t>(dimensions));
  require(H5Sget_simple_extent_dims(space.id(), extent.data(), nullptr), "look at a dataset");
  return extent;
}

template <class Number>
bool holds(Handle const& dataset) {
  Handle const type(H5Dget_type(dataset.id()), H5Tclose, "look at a dataset");
  return H5Tequal(type.id(), native<Number>()) > 0;
}

NumberKind kind_of_numbers(Handle const& dataset) {
  Handle const type(H5Dget_type(dataset.id()), H5Tclose, "look at a dataset");
  H5T_class_t const kind = H5Tget_class(type.id());
  if (kind == H5T_FLOAT) return NumberKind::real;
  if (kind != H5T_INTEGER && kind != H5T_ENUM) return NumberKind::other;
  Handle const number(kind == H5T_ENUM ? H5Tget_super(type.id()) : H5Tcopy(type.id()), H5Tclose, "look at a dataset");
  return H5Tget_sign(number.id()) == H5T_SGN_NONE ? NumberKind::positive_whole : NumberKind::whole;
}

std::size_t width_of_numbers(Handle const& dataset) {
  Handle const type(H5Dget_type(dataset.id()), H5Tclose, "look at a dataset");
  return H5Tget_size(type.id());
}

template <class Number>
std::vector<Number> read(Handle const& dataset, Part const& part) {
  if (!holds<Number>(dataset)) throw Failure("a dataset holds numbers of another type than it should");
  return read_as<Number>(dataset, part);
}

template <class Number>
std::vector<Number> read_as(Handle const& dataset, Part const& part) {
  if (part.start.empty()) {
    if (!extent_of(dataset).empty()) throw Failure("a dataset is no single number, as it should be");
    Number number{};
    require(H5Dread(dataset.id(), native<Number>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &number), "read a number");
    return {number};
  }
  Handle const file_part = selection(dataset, part);
  Handle const memory = memory_of(part);
  std::vector<Number> numbers(size_of(part));
  require(H5Dread(dataset.id(), native<Number>(), memory.id(), file_part.id(), H5P_DEFAULT, numbers.data()),
          "read a dataset");
  return numbers;
}

template <class Number>
void write(Handle const& dataset, Part const& part, std::span<Number const> numbers) {
  Handle const file_part = selection(dataset, part);
  Handle const memory = memory_of(part);
  require(H5Dwrite(dataset.id(), native<Number>(), memory.id(), file_part.id(), H5P_DEFAULT, numbers.data()),
          "write a dataset");
}

template bool holds<double>(Handle const&);
template bool holds<std::int32_t>(Handle const&);
template bool holds<std::uint32_t>(Handle const&);
template bool holds<std::uint64_t>(Handle const&);
template std::vector<double> read(Handle const&, Part const&);
template std::vector<std::int32_t> read(Handle const&, Part const&);
template std::vector<std::uint32_t> read(Handle const&, Part const&);
template std::vector<std::uint64_t> read(Handle const&, Part const&);
template std::vector<double> read_as(Handle const&, Part const&);
template std::vector<std::int32_t> read_as(Handle const&, Part const&);
template std::vector<std::int64_t> read_as(Handle const&, Part const&);
template std::vector<std::uint32_t> read_as(Handle const&, Part const&);
template std::vector<std::uint64_t> read_as(Handle const&, Part const&);
template void write(Handle const&, Part const&, std::span<double const>);
template void write(Handle const&, Part const&, std::span<std::uint64_t const>);

}  // namespace gridlock::hdf5
