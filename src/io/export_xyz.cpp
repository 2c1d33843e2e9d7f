#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <variant>
#include <vector>

#include "gridlock/core/disks.hpp"
#include "io/file.hpp"
#include "io/frame_format.hpp"
#include "io/xyz_writer.hpp"

namespace gridlock {

namespace {

/// A frame with momenta added, since ASE does not read velocities. Agents without a mass get the mass 1.
class WithMomenta final : public FrameSource {
 public:
  explicit WithMomenta(FrameSource const& frame)
      : FrameSource(head_of(frame), frame.size(), frame.fields(), frame.networks()),
        frame_(frame),
        masses_(reals(frame, Mass::name)),
        velocities_(velocities_of(frame)) {}

  [[nodiscard]] std::vector<Id> ids(std::size_t first, std::size_t count) const override {
    return frame_.ids(first, count);
  }
  [[nodiscard]] FrameValues values(std::size_t column, std::size_t first, std::size_t count) const override {
    if (column < frame_.columns().size()) return frame_.values(column, first, count);
    FrameValues momenta = frame_.values(velocities_[column - frame_.columns().size()], first, count);
    if (masses_) {
      FrameValues const masses = frame_.values(*masses_, first, count);
      auto& values = std::get<std::vector<double>>(momenta);
      std::ranges::transform(values, std::get<std::vector<double>>(masses), values.begin(), std::multiplies{});
    }
    return momenta;
  }

 private:
  static std::optional<std::size_t> reals(FrameSource const& frame, char const* name) {
    std::optional<std::size_t> const place = frame.find(name);
    bool const is_real = place && std::holds_alternative<std::vector<double>>(frame.columns()[*place].values);
    return is_real ? place : std::nullopt;
  }
  /// Returns the indices of the two columns of velocities; none if a frame lacks one of them.
  static std::vector<std::size_t> velocities_of(FrameSource const& frame) {
    auto const x = reals(frame, VelocityX::name);
    auto const y = reals(frame, VelocityY::name);
    return x && y ? std::vector{*x, *y} : std::vector<std::size_t>();
  }
  static Frame head_of(FrameSource const& frame) {
    Frame head{.box = frame.box(), .clock = frame.clock(), .seed = frame.seed(), .ids = {}, .columns = frame.columns()};
    if (velocities_of(frame).empty()) return head;
    head.columns.push_back({"momentum_x", std::vector<double>()});
    head.columns.push_back({"momentum_y", std::vector<double>()});
    return head;
  }

  FrameSource const& frame_;
  std::optional<std::size_t> masses_;
  std::vector<std::size_t> velocities_;
};

/// Writes all frames of a trajectory into one file.
class XyzFrames final : public FrameWriter {
 public:
  explicit XyzFrames(std::filesystem::path const& file) : file_(file) {}
  void write(FrameSource const& frame, std::span<double const> /*observables*/, std::uint64_t /*hash*/) override {
    append_xyz(WithMomenta(frame), file_);
  }
  void finish() override { file_.commit(); }

 private:
  AtomicFile file_;
};

}  // namespace

FrameFormat xyz_frames() {
  return {.name = "xyz",
          .extension = ".xyz",
          .readers = "OVITO, ASE",
          .create = [](std::filesystem::path const& file, H5mdSettings const&) -> std::unique_ptr<FrameWriter> {
            return std::make_unique<XyzFrames>(file);
          }};
}

}  // namespace gridlock
