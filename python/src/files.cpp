#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "gridlock/core/disks.hpp"
#include "gridlock/core/frame.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/io/xyz.hpp"
#include "gridlock/simulation/setup.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "gridlock/workspace/sweep.hpp"
#include "gridlock/workspace/verify.hpp"
#include "io/field_file.hpp"
#include "io/file.hpp"
#include "io/file_format.hpp"
#include "io/network_file.hpp"
#include "listener.hpp"
#include "settings.hpp"
#include "workspace/result_files.hpp"
#include "workspace/run_files.hpp"

namespace gridlock::python {

namespace {

/// Returns an array of shape (rows, columns) for each field.
NamedValues values_of_fields(std::vector<Field> const& fields) {
  NamedValues values;
  for (Field const& field : fields) {
    std::vector<double> numbers(field.values().begin(), field.values().end());
    values[field.name().c_str()] = nb::cast(owned_array(std::move(numbers), {field.rows(), field.columns()}));
  }
  return values;
}

/// Returns the Ids at both ends of each edge, shape (edges, 2), the weights, and whether it is directed, for each
/// network.
NamedValues values_of_networks(std::vector<Network> const& networks) {
  NamedValues values;
  for (Network const& network : networks) {
    std::vector<Id> ids;
    std::vector<double> weights;
    for (NetworkEdge const& edge : network.edges()) {
      ids.insert(ids.end(), {edge.from, edge.to});
      weights.push_back(edge.weight);
    }
    values[network.name().c_str()] = nb::make_tuple(owned_array(std::move(ids), {network.size(), 2}),
                                                    owned_array(std::move(weights)), network.is_directed());
  }
  return values;
}

}  // namespace

FrameValuesOfPython values_of_frame(Frame frame) {
  NamedValues columns;
  for (FrameColumn& column : frame.columns) {
    columns[column.name.c_str()] =
        std::visit([](auto& values) { return nb::cast(owned_array(std::move(values))); }, column.values);
  }
  return {nb::cast(owned_array(std::move(frame.ids))),
          columns,
          box_values(frame.box),
          frame.clock.step,
          frame.clock.time,
          values_of_fields(frame.fields),
          values_of_networks(frame.networks)};
}

namespace {

/// Returns the status of a run. Errors: RunFailure if the run failed.
std::string status_of(RunRecord const& record, Listener const& listener) {
  listener.raise();
  if (record.status == RunStatus::failed) throw RunFailure(record.failure);
  return to_text(record.status);
}

RunHooks hooks_for(Listener& listener, std::optional<std::uint64_t> threads) {
  return {.on_progress = [&](Progress const& progress) { return listener(progress.steps, progress.fraction); },
          .on_event = {},
          .threads = threads};
}

std::string run_directory(std::optional<std::string> const& file, Assignments const& assignments,
                          std::string const& directory, bool overwrites, std::optional<std::uint64_t> threads,
                          nb::object on_progress) {
  Listener listener(std::move(on_progress));
  RunRecord record;
  {
    nb::gil_scoped_release const released;
    Setup setup = set_up(settings_of(file, assignments), {.threads = threads});
    open_run_directory(directory, setup, overwrites, file.value_or(""));
    record = run_in(directory, std::move(setup), hooks_for(listener, threads));
  }
  return status_of(record, listener);
}

std::string resume_directory(std::string const& directory, std::optional<std::uint64_t> steps,
                             std::optional<std::uint64_t> threads, nb::object on_progress) {
  Listener listener(std::move(on_progress));
  RunRecord record;
  {
    nb::gil_scoped_release const released;
    RunHooks const hooks = hooks_for(listener, threads);
    record = steps ? lengthen_in(directory, {.steps = steps, .time = {}, .collisions_per_disk = {}}, hooks)
                   : resume_in(directory, hooks);
  }
  return status_of(record, listener);
}

NamedValues verify_directory(std::string const& directory, std::uint64_t windows, std::uint64_t seed,
                             std::optional<std::uint64_t> window_steps, std::optional<std::uint64_t> threads) {
  VerifiedRuns found;
  std::string text;
  {
    nb::gil_scoped_release const released;
    found = verify_all(
        directory,
        {.windows = windows, .seed = seed, .window_steps = window_steps, .threads = threads, .on_progress = {}},
        [&](std::string const& line) { text += (text.empty() ? "" : "\n") + line; });
  }
  Verification sum;
  for (Verification const& run : found.runs) {
    sum.steps += run.steps;
    sum.hashes += run.hashes;
    sum.states += run.states;
    sum.frames += run.frames;
    sum.results += run.results;
  }
  NamedValues values;
  values["is_verified"] = found.different == 0 && found.refused == 0;
  values["text"] = text;
  values["steps"] = sum.steps;
  values["hashes"] = sum.hashes;
  values["states"] = sum.states;
  values["frames"] = sum.frames;
  values["results"] = sum.results;
  values["runs"] = found.verified;
  return values;
}

NamedValues columns_of(Table const& table) {
  NamedValues columns;
  for (std::string const& name : table.names()) columns[name.c_str()] = array_of_cells(table.column(name));
  return columns;
}

/// Rows and means of a sweep, the numbers of failed and interrupted runs, and the error messages.
using SweepValues = std::tuple<NamedValues, NamedValues, std::size_t, std::size_t, std::vector<std::string>>;

SweepValues values_of(SweepResult const& result) {
  return {columns_of(result.rows), columns_of(result.means), result.failures, result.interruptions, result.messages};
}

/// Returns the number of runs of a sweep and the kinds of its models.
std::pair<std::size_t, std::vector<std::string>> sweep_size(std::optional<std::string> const& file,
                                                            Assignments const& assignments) {
  SweepPlan const plan = plan_sweep(settings_of(file, assignments));
  std::set<std::string> kinds;
  for (SweepRun const& run : plan.runs) kinds.insert(read_configuration(run.settings).model.kind);
  return {plan.runs.size(), std::vector(kinds.begin(), kinds.end())};
}

/// Carries out a sweep. `shard` is a number from 1 and the number of shards.
SweepValues sweep_directory(std::optional<std::string> const& file, Assignments const& assignments,
                            std::string const& directory, bool overwrites, unsigned threads,
                            std::optional<std::pair<std::size_t, std::size_t>> const& shard, nb::object on_progress) {
  Listener listener(std::move(on_progress));
  SweepResult result;
  {
    nb::gil_scoped_release const released;
    SweepSettings settings{
        .directory = directory, .overwrites = overwrites, .shard = {}, .threads = threads, .on_progress = {}};
    if (file) settings.settings_file = *file;
    if (shard) settings.shard = Shard{.number = shard->first, .count = shard->second};
    settings.on_progress = [&](SweepProgress const& progress) {
      return listener(progress.finished, progress.fraction);
    };
    result = run_sweep(plan_sweep(settings_of(file, assignments)), settings);
  }
  listener.raise();
  return values_of(result);
}

SweepValues collect_directory(std::string const& directory) {
  SweepResult result;
  {
    nb::gil_scoped_release const released;
    result = collect_sweep({directory}, directory);
  }
  return values_of(result);
}

/// Converts real numbers that are all whole to integers, since XYZ does not mark whole numbers such as kinds.
FrameColumn of_own_type(FrameColumn column) {
  auto const& values = std::get<std::vector<double>>(column.values);
  constexpr double most = 1e9;
  if (std::ranges::all_of(values, [](double v) { return v >= 0.0 && v < most && v == std::floor(v); })) {
    column.values = std::vector<std::uint32_t>(values.begin(), values.end());
  }
  return column;
}

/// Returns the columns of disks that the file has, and its other columns, as a frame.
Frame frame_of(XyzFrame file) {
  Frame frame = frame_of(file.state);
  std::erase_if(frame.columns, [&](FrameColumn const& column) {
    return (column.name.starts_with("velocity_") && !file.has_velocities) ||
           (column.name == Radius::name && !file.has_radii) || (column.name == Mass::name && !file.has_masses) ||
           (column.name.starts_with("image_") && !file.has_images);
  });
  for (FrameColumn& column : file.others) frame.columns.push_back(of_own_type(std::move(column)));
  return frame;
}

FrameValuesOfPython read_xyz_frame(std::string const& path, std::optional<std::int64_t> number) {
  std::optional<Frame> frame;
  {
    nb::gil_scoped_release const released;
    frame.emplace(frame_of(read_xyz(path, number)));
  }
  return values_of_frame(std::move(*frame));
}

/// An open trajectory.
class PythonTrajectory {
 public:
  explicit PythonTrajectory(std::string const& path) : path_(path), reader_(path) {}

  [[nodiscard]] std::size_t size() const { return reader_.frame_count(); }
  [[nodiscard]] std::string note_on_left_out() const { return gridlock::note_on_left_out(path_, reader_.settings()); }
  [[nodiscard]] auto steps() const {
    std::vector<std::uint64_t> steps;
    for (Clock const& clock : reader_.clocks()) steps.push_back(clock.step);
    return owned_array(std::move(steps));
  }
  [[nodiscard]] auto times() const {
    std::vector<double> times;
    for (Clock const& clock : reader_.clocks()) times.push_back(clock.time);
    return owned_array(std::move(times));
  }
  [[nodiscard]] FrameValuesOfPython frame(std::size_t k) const {
    if (k >= size()) throw nb::index_error("there are fewer frames");
    std::optional<H5mdFrame> frame;
    {
      nb::gil_scoped_release const released;
      frame.emplace(reader_.frame(k));
    }
    return values_of_frame(std::move(frame->frame));
  }
  [[nodiscard]] std::map<std::string, std::vector<std::string>> value_names() const {
    return reader_.settings().value_names;
  }
  [[nodiscard]] std::string const& configuration() const { return reader_.settings().configuration; }
  /// Returns step, time, Ids of shape (contacts, 2) and forces of the contacts; None if the file has no contacts.
  [[nodiscard]] auto contacts() const {
    std::optional<FrameContacts> found;
    {
      nb::gil_scoped_release const released;
      found = reader_.contacts();
    }
    std::optional<std::tuple<std::uint64_t, double, nb::object, nb::object>> values;
    if (!found) return values;
    std::size_t const count = found->size();
    values.emplace(found->clock.step, found->clock.time, nb::cast(owned_array(std::move(found->ids), {count, 2})),
                   nb::cast(owned_array(std::move(found->forces))));
    return values;
  }

 private:
  std::filesystem::path path_;
  H5mdReader reader_;
};

/// Returns id and name of the format that the first bytes of a file show; nothing if they show none.
std::optional<std::pair<std::string, std::string>> format_of(std::string const& path) {
  auto const format = recognize_format(std::filesystem::path(path));
  if (!format) return std::nullopt;
  return std::pair(std::string(format->id), std::string(format->name));
}

/// Calls protect_files(), and lists the files of `maker` if their directory has a list.
void protect_paths(std::vector<std::string> const& paths, std::string const& maker, std::string const& hint,
                   bool overwrites, std::vector<std::string> const& inputs) {
  protect_files({.results = {paths.begin(), paths.end()},
                 .inputs = {inputs.begin(), inputs.end()},
                 .maker = maker,
                 .hint = hint,
                 .overwrites = overwrites});
  if (maker.empty()) return;
  for (std::string const& path : paths) record_further_result(path, maker);
}

/// A directory that is locked against other processes, and lists the files that are written into it as results.
class PythonDirectory {
 public:
  /// `names` are the names of all files that will be written.
  PythonDirectory(std::string const& directory, std::vector<std::string> const& names, bool overwrites)
      : directory_(directory) {
    std::vector<std::filesystem::path> files;
    for (std::string const& name : names) files.push_back(directory_ / name);
    open_result_directory(directory_, std::move(files), {}, overwrites);
    lock_.emplace(directory_);
  }
  void write(std::string const& name, nb::bytes const& content) const {
    std::filesystem::path const file = directory_ / name;
    record_result(file);
    write_file(file, std::string_view(content.c_str(), content.size()));
  }
  void release() { lock_.reset(); }

 private:
  std::filesystem::path directory_;
  std::optional<DirectoryLock> lock_;
};

}  // namespace

void bind_files(nb::module_& module) {
  module.def("run_directory", &run_directory, nb::arg("file").none(), nb::arg("assignments"), nb::arg("directory"),
             nb::arg("overwrites"), nb::arg("threads").none(), nb::arg("on_progress").none());
  module.def("resume_directory", &resume_directory, nb::arg("directory"), nb::arg("steps").none(),
             nb::arg("threads").none(), nb::arg("on_progress").none());
  module.def("verify_directory", &verify_directory, nb::arg("directory"), nb::arg("windows"), nb::arg("seed"),
             nb::arg("window_steps").none(), nb::arg("threads").none());
  module.def("sweep_size", &sweep_size, nb::arg("file").none(), nb::arg("assignments"));
  module.def("sweep_directory", &sweep_directory, nb::arg("file").none(), nb::arg("assignments"), nb::arg("directory"),
             nb::arg("overwrites"), nb::arg("threads"), nb::arg("shard").none(), nb::arg("on_progress").none());
  module.def("collect_directory", &collect_directory, nb::arg("directory"));
  module.def(
      "read_csv", [](std::string const& path) { return columns_of(read_csv(path)); }, nb::arg("path"));
  module.def(
      "read_fields", [](std::string const& path) { return values_of_fields(read_fields(path)); }, nb::arg("path"));
  module.def(
      "read_networks", [](std::string const& path) { return values_of_networks(read_networks(path)); },
      nb::arg("path"));
  module.def("read_xyz", &read_xyz_frame, nb::arg("path"), nb::arg("frame").none());
  module.def(
      "record_result", [](std::string const& path) { record_result(path); }, nb::arg("path"));
  module.def("recognize_format", &format_of, nb::arg("path"));
  module.def("protect_files", &protect_paths, nb::arg("paths"), nb::arg("maker"), nb::arg("hint"),
             nb::arg("overwrites"), nb::arg("inputs"));
  nb::class_<PythonTrajectory>(module, "Trajectory")
      .def(nb::init<std::string const&>(), nb::arg("path"))
      .def("size", &PythonTrajectory::size)
      .def("note_on_left_out", &PythonTrajectory::note_on_left_out)
      .def("steps", &PythonTrajectory::steps)
      .def("times", &PythonTrajectory::times)
      .def("frame", &PythonTrajectory::frame, nb::arg("k"))
      .def("value_names", &PythonTrajectory::value_names)
      .def("configuration", &PythonTrajectory::configuration)
      .def("contacts", &PythonTrajectory::contacts);
  nb::class_<PythonDirectory>(module, "Directory")
      .def(nb::init<std::string const&, std::vector<std::string> const&, bool>(), nb::arg("directory"),
           nb::arg("names"), nb::arg("overwrites"))
      .def("write", &PythonDirectory::write, nb::arg("name"), nb::arg("content"))
      .def("release", &PythonDirectory::release);
}

}  // namespace gridlock::python
