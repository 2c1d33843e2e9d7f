#include "io/text_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/file_format.hpp"
#include "io/h5md_text.hpp"

namespace gridlock {

namespace {

/// Returns a function that reads the bytes of a text one after the other.
ReadBytes bytes_of(std::string_view text) {
  return [text](std::span<char> into) mutable {
    std::size_t const count = text.copy(into.data(), into.size());
    text.remove_prefix(count);
    return count;
  };
}

}  // namespace

TextReader::TextReader(std::filesystem::path path) : name_(path.string()), path_(std::move(path)) { open_file(); }

TextReader::TextReader(std::string_view text, std::string name)
    : name_(std::move(name)), text_(text), likely_size_(text.size()), bytes_(bytes_of(text)) {}

void TextReader::open_file() {
  auto const file = std::make_shared<FileReader>(path_);
  can_begin_again_ = file->is_regular();
  // The first bytes of a file determine its format.
  std::string first(bytes_of_format, '\0');
  std::size_t filled = 0;
  while (filled < first.size()) {
    std::size_t const got = file->read(std::span(first).subspan(filled));
    if (got == 0) break;
    filled += got;
  }
  first.resize(filled);
  if (auto const format = recognize_format(std::string_view(first))) {
    // HDF5 reads positions in any order, which a pipe does not allow.
    if (format->id != "hdf5" || !file->is_regular()) throw wrong_format(*format, name_, "extended XYZ");
    packed_.reset();
    TrajectoryText trajectory = text_of_trajectory(path_);
    bytes_ = std::move(trajectory.bytes);
    left_out_ = std::move(trajectory.left_out);
    is_of_text_ = false;
    constexpr std::uint64_t usually_deflated = 4;
    likely_size_ = usually_deflated * file->size();
    return;
  }
  bytes_ = [file, first](std::span<char> into) mutable {
    if (first.empty()) return file->read(into);
    std::size_t const count = first.copy(into.data(), into.size());
    first.erase(0, count);
    return count;
  };
  likely_size_ = file->size();
  packed_.reset();
  if (!is_gzip(first)) return;
  constexpr std::uint64_t usually_packed = 4;
  likely_size_ *= usually_packed;
  packed_.emplace(bytes_);
}

std::size_t TextReader::read(std::span<char> into) {
  if (!packed_) return bytes_(into);
  if (auto const got = packed_->read(into)) return *got;
  throw Error({.what = fmt::format("cannot unpack {}: it is damaged or cut off", name_),
               .hint = "pack it again with gzip",
               .file = name_});
}

bool TextReader::begin_again() {
  if (!can_begin_again_) return false;
  if (path_.empty()) {
    bytes_ = bytes_of(text_);
  } else {
    open_file();
  }
  return true;
}

void TextReader::require_undamaged() {
  if (!packed_) return;
  std::vector<char> piece(std::size_t{1} << 16);
  while (read(piece) > 0) {
  }
}

}  // namespace gridlock
