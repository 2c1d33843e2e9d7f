#pragma once

#include <httplib.h>

#include <filesystem>
#include <map>
#include <string>

#include "contents.hpp"
#include "frames.hpp"

namespace gridlock::view {

/// Answers the requests of the page, and refuses all others:
///
///     /  /NAME                                  the page and its files, as they were at the start
///     /data/contents.json                       what is shown, and the runs of a sweep
///     /data/tables/NAME                         tables of a sweep
///     /data/runs/ID/about.json                  the files of a run that are there
///     /data/runs/ID/files/NAME                  one of them; `Range` with one range is answered
///     /data/runs/ID/trajectory.json?from=K      FrameStore::describe()
///     /data/runs/ID/frames/K?columns=x,y        FrameStore::frame()
///
/// Only GET and HEAD, only from this machine's own names, and only from pages of this server: another site that a
/// browser shows gets nothing, also where it makes its own name one of the loopback interface.
class Site {
 public:
  /// `page` is the directory of the built page.
  Site(Contents contents, std::filesystem::path const& page);

  void answer(httplib::Request const& request, httplib::Response& response);

 private:
  void answer_data(std::string const& path, httplib::Request const& request, httplib::Response& response);
  void answer_run(ShownRun const& run, std::string const& rest, httplib::Request const& request,
                  httplib::Response& response);
  [[nodiscard]] std::string contents_json() const;
  [[nodiscard]] std::string about_json(ShownRun const& run) const;

  Contents contents_;
  std::string index_;                                  ///< index.html
  std::map<std::string, std::filesystem::path> page_;  ///< path of a request → another file of the page
  FrameStore frames_;
};

/// One range of bytes of a file, clipped to it.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// The bytes that a header `Range` asks for of a file of `size` bytes.
struct AskedRange {
  enum class Kind { all, part, beyond } kind = Kind::all;
  ByteRange range;
};

/// Several ranges, other units and what is no range count as no header, as HTTP allows.
AskedRange read_range(std::string const& header, std::uint64_t size);

}  // namespace gridlock::view
