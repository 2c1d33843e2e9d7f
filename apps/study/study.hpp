#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "drawing/page.hpp"
#include "drawing/picture.hpp"
#include "drawing/plot.hpp"
#include "gridlock/io/table.hpp"
#include "gridlock/observe/estimate.hpp"
#include "study/paper.hpp"
#include "study/partial_results.hpp"
#include "study/run_pool.hpp"

namespace gridlock {

/// Pictures of the report that stand side by side.
struct Drawing {
  std::vector<std::string> files;  ///< SVG, relative to the directory of the study
  std::string caption;
};

/// One section of the report: what was done, the pictures, the claims, the numbers, what follows from them.
struct Chapter {
  std::string title;
  std::vector<std::string> introduction;
  std::vector<Drawing> drawings;
  std::vector<PaperClaim> claims;
  std::vector<PageTable> tables;
  std::vector<std::string> conclusions;
};

/// Within the directory of a study.
inline constexpr char const* partial_results_name = "partial_results";

/// What all chapters are made with: the settings, the simulations and the directory they write into.
class Study {
 public:
  /// on_drawing(name) is called before each picture; where it returns false, nothing more is drawn.
  explicit Study(PaperSettings const& settings, std::function<bool(std::string const& name)> on_drawing)
      : partial_results(settings.output / partial_results_name),
        settings_(settings),
        on_drawing_(std::move(on_drawing)) {}

  [[nodiscard]] PaperExtent const& extent() const { return settings_.extent; }
  [[nodiscard]] std::uint64_t seed(std::uint64_t number) const { return settings_.seed + number; }

  PartialResults partial_results;
  RunPool runs;

  /// Writes a table as CSV.
  void write(Table const& table, std::string const& file);
  /// Draws disks as name.svg and name.png.
  void draw(State const& state, PictureSettings const& settings, std::string const& name);
  /// Draws a plot; what hinders it becomes a note.
  void draw(Plot const& plot);
  /// Remembers a file written by something else.
  void add_file(std::string const& file) { files_.push_back(path_of(file)); }
  void note(std::string text) { notes_.push_back(std::move(text)); }

  [[nodiscard]] std::filesystem::path path_of(std::string const& file) const { return settings_.output / file; }
  [[nodiscard]] std::vector<std::filesystem::path> const& files() const { return files_; }
  [[nodiscard]] std::vector<std::string> const& notes() const { return notes_; }

 private:
  PaperSettings const& settings_;
  std::function<bool(std::string const&)> on_drawing_;
  std::vector<std::filesystem::path> files_;
  std::vector<std::string> notes_;
};

/// "0.5181 ± 0.0012", both to the second digit of the error; "0.5181" without one.
std::string to_text(Estimate const& estimate);

/// The state a start has before its first step.
State start_state(PaperExtent const& extent, StartKind start, double packing_fraction, std::uint64_t seed);

}  // namespace gridlock
