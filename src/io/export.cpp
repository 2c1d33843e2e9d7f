#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "gridlock/core/disks.hpp"
#include "gridlock/core/error.hpp"
#include "gridlock/io/h5md.hpp"
#include "gridlock/io/xyz.hpp"
#include "io/file.hpp"
#include "io/h5md_layout.hpp"
#include "io/text.hpp"
#include "io/xyz_writer.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

template <class Visit>
void for_each_frame(H5mdReader const& trajectory, std::size_t every, Visit visit) {
  for (std::size_t k = 0; k < trajectory.frame_count(); k += every) visit(std::move(trajectory.frame(k).frame));
}

/// Adds the momenta: ASE knows velocities by them only. Agents without a mass have the mass 1.
Frame with_momenta(Frame frame) {
  auto const reals = [&](char const* name) -> std::vector<double> const* {
    FrameColumn const* const column = frame.find(name);
    return column == nullptr ? nullptr : std::get_if<std::vector<double>>(&column->values);
  };
  std::vector<double> const* const velocities[] = {reals(VelocityX::name), reals(VelocityY::name)};
  if (velocities[0] == nullptr || velocities[1] == nullptr) return frame;
  std::vector<double> momenta[] = {*velocities[0], *velocities[1]};
  if (std::vector<double> const* const masses = reals(Mass::name)) {
    for (std::vector<double>& momentum : momenta)
      std::ranges::transform(momentum, *masses, momentum.begin(), std::multiplies{});
  }
  frame.columns.push_back({"momentum_x", std::move(momenta[0])});
  frame.columns.push_back({"momentum_y", std::move(momenta[1])});
  return frame;
}

void write_all_xyz(H5mdReader const& trajectory, ExportSettings const& settings) {
  AtomicFile file(settings.file);
  for_each_frame(trajectory, settings.every,
                 [&](Frame frame) { append_xyz(*frame_source_of(with_momenta(std::move(frame))), file); });
  file.commit();
}

void append_number(std::string& line, FrameValues const& values, std::size_t row) {
  std::visit(
      [&](auto const& numbers) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(numbers[0])>, double>) {
          line += double_text(numbers[row]);
        } else {
          fmt::format_to(std::back_inserter(line), "{}", numbers[row]);
        }
      },
      values);
}

void write_all_csv(H5mdReader const& trajectory, ExportSettings const& settings) {
  AtomicFile file(settings.file);
  bool is_first = true;
  std::string line;
  for_each_frame(trajectory, settings.every, [&](Frame const& frame) {
    if (std::exchange(is_first, false)) {
      line = "step,time,id";
      for (FrameColumn const& column : frame.columns) line += "," + column.name;
      file.append(line + "\n");
    }
    std::string const clock = fmt::format("{},{}", frame.clock.step, double_text(frame.clock.time));
    for (std::size_t i = 0; i < frame.size(); ++i) {
      line = fmt::format("{},{}", clock, frame.ids[i]);
      for (FrameColumn const& column : frame.columns) {
        line += ',';
        append_number(line, column.values, i);
      }
      line += '\n';
      file.append(line);
    }
  });
  file.commit();
}

/// Numbers of a VTK file, each vector of the plane with a third component.
class VtkArrays {
 public:
  explicit VtkArrays(Frame const& frame) : frame_(frame) {}

  [[nodiscard]] std::string array(h5md::Element const& element) const {
    return std::visit([&](auto const& first) { return array_of(element, first); },
                      frame_.columns[element.columns[0]].values);
  }

  template <class Number>
  static std::string text(std::string const& name, std::size_t components, std::vector<Number> const& numbers) {
    // Nothing else tells readers of field data how many there are.
    std::string result =
        fmt::format(R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" NumberOfTuples="{}" format="ascii">)",
                    type_name<Number>(), name, components, numbers.size() / components);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      result += i % components == 0 ? '\n' : ' ';
      fmt::format_to(std::back_inserter(result), "{}", numbers[i]);
    }
    return result + "\n</DataArray>\n";
  }

 private:
  template <class Number>
  static constexpr char const* type_name() {
    if constexpr (std::is_same_v<Number, double>) return "Float64";
    if constexpr (std::is_same_v<Number, std::int32_t>) return "Int32";
    if constexpr (std::is_same_v<Number, std::uint32_t>) return "UInt32";
    if constexpr (std::is_same_v<Number, std::uint64_t>) return "UInt64";
    return "Int64";
  }

  template <class Number>
  std::string array_of(h5md::Element const& element, std::vector<Number> const& first) const {
    if (!element.is_vector()) return text(element.name, 1, first);
    auto const& second = std::get<std::vector<Number>>(frame_.columns[element.columns[1]].values);
    std::vector<Number> numbers;
    numbers.reserve(3 * first.size());
    for (std::size_t i = 0; i < first.size(); ++i) numbers.insert(numbers.end(), {first[i], second[i], Number{0}});
    return text(element.name, 3, numbers);
  }

  Frame const& frame_;
};

/// One frame as points with a vertex each, in VTK's XML format for polygons.
std::string vtp_text(Frame const& frame) {
  VtkArrays const arrays(frame);
  std::string points;
  std::string data = VtkArrays::text("id", 1, frame.ids);
  for (h5md::Element const& element : h5md::elements_of(frame.columns)) {
    (element.name == "position" && element.is_vector() ? points : data) += arrays.array(element);
  }
  if (points.empty()) {
    throw Error(Problem{.what = "the trajectory has no positions, which points need",
                        .hint = "export it as csv, or keep the columns x and y in trajectory.columns"});
  }
  std::vector<std::int64_t> vertices;
  std::vector<std::int64_t> ends;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    vertices.push_back(static_cast<std::int64_t>(i));
    ends.push_back(static_cast<std::int64_t>(i) + 1);
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\n<PolyData>\n"
      "<FieldData>\n{}{}</FieldData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n"
      "<PointData>\n{}</PointData>\n<Points>\n{}</Points>\n<Verts>\n{}{}</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n",
      VtkArrays::text("TimeValue", 1, std::vector<double>{frame.clock.time}),
      VtkArrays::text("box", 2, std::vector<double>{frame.box.width(), frame.box.height()}), frame.size(), frame.size(),
      data, points, VtkArrays::text("connectivity", 1, vertices), VtkArrays::text("offsets", 1, ends));
}

/// Where the frames lie that the file lists.
fs::path vtk_directory(ExportSettings const& settings) { return settings.file.parent_path() / settings.file.stem(); }

std::string vtk_name(std::uint64_t step) { return fmt::format("step_{:010}.vtp", step); }

void write_all_vtk(H5mdReader const& trajectory, ExportSettings const& settings) {
  fs::path const directory = vtk_directory(settings);
  std::string list = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
  fs::create_directories(directory);
  for_each_frame(trajectory, settings.every, [&](Frame const& frame) {
    std::string const name = vtk_name(frame.clock.step);
    write_file(directory / name, vtp_text(frame));
    list += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", frame.clock.time,
                        (directory.filename() / name).string());
  });
  write_file(settings.file, list + "</Collection>\n</VTKFile>\n");
}

}  // namespace

std::vector<fs::path> exported_files(H5mdReader const& trajectory, ExportSettings const& settings) {
  std::vector<fs::path> files{settings.file};
  if (settings.format != ExportFormat::vtk) return files;
  for (std::size_t k = 0; k < trajectory.frame_count(); k += settings.every) {
    files.push_back(vtk_directory(settings) / vtk_name(trajectory.clocks()[k].step));
  }
  return files;
}

std::vector<fs::path> export_trajectory(H5mdReader const& trajectory, ExportSettings const& settings) {
  switch (settings.format) {
    case ExportFormat::xyz:
      write_all_xyz(trajectory, settings);
      break;
    case ExportFormat::vtk:
      write_all_vtk(trajectory, settings);
      break;
    case ExportFormat::csv:
      write_all_csv(trajectory, settings);
      break;
  }
  return exported_files(trajectory, settings);
}

}  // namespace gridlock
