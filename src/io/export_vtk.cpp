#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "io/file.hpp"
#include "io/frame_format.hpp"
#include "io/h5md_layout.hpp"

namespace gridlock {

namespace {

namespace fs = std::filesystem;

/// Writes numbers into a VTK file; vectors of the plane get the third component 0.
class VtkArrays {
 public:
  explicit VtkArrays(FrameSource const& frame) : frame_(frame) {}

  [[nodiscard]] std::string array(h5md::Element const& element) const {
    return std::visit([&](auto const& first) { return array_of(element, first); }, values(element.columns[0]));
  }

  template <class Number>
  static std::string text(std::string const& name, std::size_t components, std::vector<Number> const& numbers) {
    // The number of values is written out, since readers of VTK cannot derive it for field data.
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
    FrameValues const other = values(element.columns[1]);
    auto const& second = std::get<std::vector<Number>>(other);
    std::vector<Number> numbers;
    numbers.reserve(3 * first.size());
    for (std::size_t i = 0; i < first.size(); ++i) numbers.insert(numbers.end(), {first[i], second[i], Number{0}});
    return text(element.name, 3, numbers);
  }

  [[nodiscard]] FrameValues values(std::size_t column) const { return frame_.values(column, 0, frame_.size()); }

  FrameSource const& frame_;
};

/// Returns a frame in VTK's XML format for polygons: each agent is a point with a vertex.
std::string vtp_text(FrameSource const& frame) {
  VtkArrays const arrays(frame);
  std::string points;
  std::string data = VtkArrays::text("id", 1, frame.ids(0, frame.size()));
  for (h5md::Element const& element : h5md::elements_of(frame.columns())) {
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
      "<FieldData>\n{}{}{}</FieldData>\n"
      "<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
      "NumberOfPolys=\"0\">\n"
      "<PointData>\n{}</PointData>\n<Points>\n{}</Points>\n<Verts>\n{}{}</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n",
      VtkArrays::text("TimeValue", 1, std::vector<double>{frame.clock().time}),
      VtkArrays::text("box", 2, std::vector<double>{frame.box().width(), frame.box().height()}),
      VtkArrays::text("tilt", 1, std::vector<double>{frame.box().tilt()}), frame.size(), frame.size(), data, points,
      VtkArrays::text("connectivity", 1, vertices), VtkArrays::text("offsets", 1, ends));
}

/// Returns the directory with the files of the single frames.
fs::path vtk_directory(fs::path const& file) { return file.parent_path() / file.stem(); }

fs::path vtk_file(fs::path const& file, std::uint64_t step) {
  return vtk_directory(file) / fmt::format("step_{:010}.vtp", step);
}

/// Writes a file for each frame, and a file that lists them all.
class VtkFrames final : public FrameWriter {
 public:
  explicit VtkFrames(fs::path file) : file_(std::move(file)) { fs::create_directories(vtk_directory(file_)); }

  void write(FrameSource const& frame, std::span<double const> /*observables*/, std::uint64_t /*hash*/) override {
    fs::path const file = vtk_file(file_, frame.clock().step);
    write_file(file, vtp_text(frame));
    list_ += fmt::format("<DataSet timestep=\"{}\" file=\"{}\"/>\n", frame.clock().time,
                         (file.parent_path().filename() / file.filename()).string());
  }
  void finish() override { write_file(file_, list_ + "</Collection>\n</VTKFile>\n"); }

 private:
  fs::path file_;
  std::string list_ = "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n";
};

}  // namespace

FrameFormat vtk_frames() {
  return {.name = "vtk",
          .extension = ".pvd",
          .readers = "ParaView",
          .file_of_step = vtk_file,
          .create = [](fs::path const& file, H5mdSettings const&) -> std::unique_ptr<FrameWriter> {
            return std::make_unique<VtkFrames>(file);
          }};
}

}  // namespace gridlock
