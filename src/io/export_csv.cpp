#include <fmt/format.h>

#include <iterator>
#include <string>
#include <type_traits>
#include <utility>

#include "io/file.hpp"
#include "io/frame_format.hpp"
#include "io/text.hpp"

namespace gridlock {

namespace {

/// Writes a trajectory as CSV, one row for each agent of each frame.
class CsvFrames final : public FrameWriter {
 public:
  explicit CsvFrames(std::filesystem::path const& file) : file_(file) {}

  void write(FrameSource const& frame, std::span<double const> /*observables*/, std::uint64_t /*hash*/) override {
    if (!std::exchange(has_header_, true)) {
      std::string header = "step,time,id";
      for (FrameColumn const& column : frame.columns()) header += "," + column.name;
      file_.append(header + "\n");
    }
    std::string const clock = fmt::format("{},{}", frame.clock().step, double_text(frame.clock().time));
    for_each_piece(frame.size(), rows_per_piece, [&](std::size_t first, std::size_t count) {
      Frame const rows = frame.piece(first, count);
      std::string text;
      for (std::size_t i = 0; i < count; ++i) {
        fmt::format_to(std::back_inserter(text), "{},{}", clock, rows.ids[i]);
        for (FrameColumn const& column : rows.columns) append_number(text, column.values, i);
        text += '\n';
      }
      file_.append(text);
    });
  }
  void finish() override { file_.commit(); }

 private:
  static constexpr std::size_t rows_per_piece = 8192;

  static void append_number(std::string& text, FrameValues const& values, std::size_t row) {
    text += ',';
    std::visit(
        [&](auto const& numbers) {
          if constexpr (std::is_same_v<std::remove_cvref_t<decltype(numbers[0])>, double>) {
            text += double_text(numbers[row]);
          } else {
            fmt::format_to(std::back_inserter(text), "{}", numbers[row]);
          }
        },
        values);
  }

  AtomicFile file_;
  bool has_header_ = false;
};

}  // namespace

FrameFormat csv_frames() {
  return {.name = "csv",
          .extension = ".csv",
          .create = [](std::filesystem::path const& file, H5mdSettings const&) -> std::unique_ptr<FrameWriter> {
            return std::make_unique<CsvFrames>(file);
          }};
}

}  // namespace gridlock
