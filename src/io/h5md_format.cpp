#include <utility>

#include "io/frame_format.hpp"

namespace gridlock {

namespace {

class H5mdFrames final : public FrameWriter {
 public:
  H5mdFrames(std::filesystem::path file, H5mdSettings header) : file_(std::move(file)), header_(std::move(header)) {}
  explicit H5mdFrames(H5mdWriter writer) : writer_(std::move(writer)) {}

  void write(FrameSource const& frame, std::span<double const> observables, std::uint64_t state_hash) override {
    if (!writer_) writer_ = H5mdWriter::create(file_, header_, frame);
    writer_->write(frame, observables, state_hash);
  }
  [[nodiscard]] std::optional<std::uint64_t> last_step() const override {
    return writer_ ? writer_->last_step() : std::nullopt;
  }
  [[nodiscard]] std::optional<std::uint64_t> state_hash_at(std::uint64_t step) const override {
    return writer_ ? writer_->state_hash_at(step) : std::nullopt;
  }

 private:
  std::filesystem::path file_;
  H5mdSettings header_;
  std::optional<H5mdWriter> writer_;
};

}  // namespace

FrameFormat h5md_frames() {
  return {
      .name = "h5md",
      .extension = ".h5",
      .is_exported = false,  // it is the format that exports convert
      .create = [](std::filesystem::path const& file, H5mdSettings const& header) -> std::unique_ptr<FrameWriter> {
        return std::make_unique<H5mdFrames>(file, header);
      },
      .append = [](std::filesystem::path const& file, FrameSource const& first) -> std::unique_ptr<FrameWriter> {
        return std::make_unique<H5mdFrames>(H5mdWriter::append(file, first));
      },
      .configuration_of = [](std::filesystem::path const& file) { return H5mdReader(file).settings().configuration; }};
}

}  // namespace gridlock
