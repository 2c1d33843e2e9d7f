#pragma once

#include <httplib.h>

#include <filesystem>
#include <map>
#include <string>

#include "contents.hpp"
#include "frames.hpp"

namespace gridlock::view {

/// Answers the requests of the page and refuses all others:
///
///     /  /NAME                                  the page and its files, as they were at the start
///     /data/contents.json                       what is shown, and the runs of a sweep
///     /data/tables/NAME                         tables of a sweep
///     /data/runs/ID/about.json                  the files of a run that are there
///     /data/runs/ID/files/NAME                  one of them; `Range` with one range is answered
///     /data/runs/ID/trajectory.json?from=K      FrameStore::describe()
///     /data/runs/ID/frames/K?columns=x,y        FrameStore::frame()
///
/// Accepts only GET and HEAD, only with a host name of the loopback interface, and only from pages of this server.
/// Another site in the user's browser gets no data, even if its own name resolves to the loopback interface.
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
  std::map<std::string, std::filesystem::path> page_;  ///< files of the page by the path of their requests
  FrameStore frames_;
};

/// A range of bytes within a file.
struct ByteRange {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

/// The result of a header `Range` for a file of `size` bytes.
struct AskedRange {
  enum class Kind { all, part, beyond } kind = Kind::all;
  ByteRange range;
};

/// Reads a header `Range`. Invalid headers, several ranges and other units count as no header, as HTTP allows.
AskedRange read_range(std::string const& header, std::uint64_t size);

}  // namespace gridlock::view
