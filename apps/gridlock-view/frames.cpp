#include "frames.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include "gridlock/core/error.hpp"

namespace gridlock::view {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "columns are sent as they lie in memory");

constexpr std::size_t max_open = 4;

/// Returns a number, or null for NaN, which JSON lacks.
Json number_or_null(double number) { return std::isfinite(number) ? Json(number) : Json(nullptr); }

struct TypeName {
  char const* operator()(std::vector<double> const&) const { return "float64"; }
  char const* operator()(std::vector<std::int32_t> const&) const { return "int32"; }
  char const* operator()(std::vector<std::uint32_t> const&) const { return "uint32"; }
  char const* operator()(std::vector<std::uint64_t> const&) const { return "uint64"; }
};

std::span<char const> bytes_of(FrameValues const& values) {
  return std::visit(
      [](auto const& numbers) {
        return std::span(reinterpret_cast<char const*>(numbers.data()), numbers.size() * sizeof(numbers[0]));
      },
      values);
}

void fill_up(std::string& bytes, char filling) { bytes.append((8 - bytes.size() % 8) % 8, filling); }

/// Returns the requested columns of a frame after a column of Ids; all columns if `wanted` is empty.
std::vector<FrameColumn> chosen_columns(Frame& frame, std::vector<std::string> const& wanted) {
  std::vector<FrameColumn> columns{{.name = "id", .values = std::move(frame.ids)}};
  for (FrameColumn& column : frame.columns) {
    bool const is_wanted = wanted.empty() || std::ranges::find(wanted, column.name) != wanted.end();
    if (is_wanted) columns.push_back(std::move(column));
  }
  return columns;
}

/// Returns one answer where x and y are alike, else one for each.
Json periodic_axes(Box const& box) {
  if (box.edge_x() == box.edge_y()) return box.is_periodic();
  return Json::array({box.is_periodic_x(), box.is_periodic_y()});
}

}  // namespace

FrameStore::Version FrameStore::version_of(fs::path const& file) {
  struct stat status {};
  if (stat(file.c_str(), &status) != 0) {
    throw Error(
        {.what = fmt::format("cannot read {}: {}", file.filename().string(), std::generic_category().message(errno)),
         .hint = "was the run removed?"});
  }
  return {.device = status.st_dev,
          .inode = status.st_ino,
          .bytes = static_cast<std::uint64_t>(status.st_size),
          .seconds = status.st_mtim.tv_sec,
          .nanoseconds = status.st_mtim.tv_nsec};
}

H5mdReader const& FrameStore::reader(fs::path const& file) {
  Version const version = version_of(file);
  auto const found = std::ranges::find(open_, file, &Open::file);
  if (found != open_.end() && found->version == version) {
    open_.splice(open_.begin(), open_, found);
    return open_.front().reader;
  }
  if (found != open_.end()) open_.erase(found);
  if (open_.size() >= max_open) open_.pop_back();
  open_.push_front({.file = file, .version = version, .reader = H5mdReader(file)});
  return open_.front().reader;
}

std::string FrameStore::describe(fs::path const& file, std::size_t first) {
  std::lock_guard const lock(mutex_);
  H5mdReader const& trajectory = reader(file);
  std::size_t const count = trajectory.frame_count();
  std::size_t const from = std::min(first, count);
  Json json{{"agents", trajectory.settings().agents},
            {"version", trajectory.settings().version},
            {"configuration", trajectory.settings().configuration},
            {"columns", trajectory.column_names()},
            {"valueNames", trajectory.settings().value_names},
            {"frames", count},
            {"first", from},
            {"steps", Json::array()},
            {"times", Json::array()},
            {"observables", Json::array()}};
  for (Clock const& clock : trajectory.clocks().subspan(from)) {
    json["steps"].push_back(clock.step);
    json["times"].push_back(clock.time);
  }
  auto const& observables = trajectory.settings().observables;
  for (std::size_t k = 0; k < observables.size(); ++k) {
    std::vector<double> const values = trajectory.observable(k);
    Json shown = Json::array();
    for (double const value : std::span(values).subspan(from)) shown.push_back(number_or_null(value));
    json["observables"].push_back(
        {{"name", observables[k].name}, {"unit", observables[k].unit}, {"values", std::move(shown)}});
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string FrameStore::frame(fs::path const& file, std::size_t k, std::vector<std::string> const& columns) {
  H5mdFrame read;
  {
    std::lock_guard const lock(mutex_);
    H5mdReader const& trajectory = reader(file);
    if (k >= trajectory.frame_count()) {
      throw Error({.what = fmt::format("there is no frame {}: {} has {}", k, file.filename().string(),
                                       trajectory.frame_count()),
                   .hint = "frames are counted from 0"});
    }
    read = trajectory.frame(k);
  }
  Frame& frame = read.frame;
  Json json{{"step", frame.clock.step},
            {"time", frame.clock.time},
            {"box",
             {{"width", frame.box.width()},
              {"height", frame.box.height()},
              {"periodic", periodic_axes(frame.box)},
              {"shift", frame.box.shift()}}},
            {"count", frame.size()},
            {"stateHash", fmt::format("{:016x}", read.state_hash)},
            {"columns", Json::array()}};
  std::vector<FrameColumn> const sent = chosen_columns(frame, columns);
  std::size_t offset = 0;
  for (FrameColumn const& column : sent) {
    json["columns"].push_back(
        {{"name", column.name}, {"type", std::visit(TypeName{}, column.values)}, {"offset", offset}});
    offset += (bytes_of(column.values).size() + 7) / 8 * 8;
  }
  std::string bytes(sizeof(std::uint32_t), '\0');
  bytes += json.dump(-1, ' ', false, Json::error_handler_t::replace);
  fill_up(bytes, ' ');
  auto const length = static_cast<std::uint32_t>(bytes.size() - sizeof(std::uint32_t));
  std::memcpy(bytes.data(), &length, sizeof(length));
  bytes.reserve(bytes.size() + offset);
  for (FrameColumn const& column : sent) {
    std::span<char const> const values = bytes_of(column.values);
    bytes.append(values.data(), values.size());
    fill_up(bytes, '\0');
  }
  return bytes;
}

}  // namespace gridlock::view
