#include "site.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>
#include <vector>

#include "gridlock/core/error.hpp"
#include "gridlock/core/version.hpp"
#include "gridlock/workspace/run_directory.hpp"
#include "io/file.hpp"

namespace gridlock::view {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using httplib::Request;
using httplib::Response;

constexpr char const* json_type = "application/json";

void set_json(Response& response, std::string const& text) { response.set_content(text, json_type); }

void refuse(Response& response, int status, std::string const& what, std::string const& hint) {
  response.status = status;
  set_json(response, Json{{"error", what}, {"hint", hint}}.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void refuse_path(Response& response) {
  refuse(response, 404, "there is nothing at this address", "gridlock view serves its page and the files of the run");
}

std::string type_of(fs::path const& file) {
  static std::map<std::string, std::string> const types{{".html", "text/html; charset=utf-8"},
                                                        {".js", "text/javascript; charset=utf-8"},
                                                        {".mjs", "text/javascript; charset=utf-8"},
                                                        {".css", "text/css; charset=utf-8"},
                                                        {".json", json_type},
                                                        {".wasm", "application/wasm"},
                                                        {".svg", "image/svg+xml"},
                                                        {".png", "image/png"},
                                                        {".ico", "image/x-icon"},
                                                        {".woff2", "font/woff2"},
                                                        {".csv", "text/csv; charset=utf-8"},
                                                        {".toml", "text/plain; charset=utf-8"},
                                                        {".log", "text/plain; charset=utf-8"},
                                                        {".txt", "text/plain; charset=utf-8"},
                                                        {".xyz", "text/plain; charset=utf-8"},
                                                        {".h5", "application/x-hdf5"}};
  auto const found = types.find(file.extension().string());
  return found == types.end() ? "application/octet-stream" : found->second;
}

/// Returns whether a header `Host` names the loopback interface. Any port is accepted, since an SSH tunnel gives the
/// browser another port.
bool is_loopback(std::string_view host) {
  for (std::string_view const name : {"127.0.0.1", "localhost", "[::1]"}) {
    if (!host.starts_with(name)) continue;
    std::string_view const rest = host.substr(name.size());
    if (rest.empty()) return true;
    return rest.front() == ':' && rest.find_first_not_of("0123456789", 1) == std::string_view::npos;
  }
  return false;
}

bool is_from_here(Request const& request) {
  if (request.get_header_value_count("Host") != 1) return false;
  std::string const host = request.get_header_value("Host");
  if (!is_loopback(host)) return false;
  if (!request.has_header("Origin")) return true;
  return request.get_header_value_count("Origin") == 1 && request.get_header_value("Origin") == "http://" + host;
}

void set_headers(Response& response) {
  response.set_header("Cache-Control", "no-store");
  response.set_header("X-Content-Type-Options", "nosniff");
  response.set_header("Referrer-Policy", "no-referrer");
  response.set_header("Cross-Origin-Resource-Policy", "same-origin");
  // The page may request nothing from other servers, and no other page may show it in a frame. The page itself
  // restricts its scripts to those with known hashes.
  response.set_header(
      "Content-Security-Policy",
      "default-src 'self' data: blob:; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'self' "
      "'unsafe-inline'; "
      "worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
}

/// A regular file, open for reading; closed by the destructor.
class OpenFile {
 public:
  /// Does not follow a link, which may have replaced the checked file, and does not wait at a pipe.
  explicit OpenFile(fs::path const& path)
      : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)) {
    struct stat status {};
    is_good_ = descriptor_ >= 0 && fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    size_ = is_good_ ? static_cast<std::uint64_t>(status.st_size) : 0;
  }
  ~OpenFile() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  OpenFile(OpenFile const&) = delete;
  OpenFile& operator=(OpenFile const&) = delete;

  [[nodiscard]] bool is_good() const { return is_good_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] ssize_t read(char* bytes, std::size_t count, std::uint64_t at) const {
    return pread(descriptor_, bytes, count, static_cast<off_t>(at));
  }

 private:
  int descriptor_;
  bool is_good_ = false;
  std::uint64_t size_ = 0;
};

constexpr std::size_t bytes_at_a_time = std::size_t{1} << 18;

/// Sends a part of a file to the client piece by piece. The answer breaks off if the file becomes too short.
void send_part(Response& response, std::shared_ptr<OpenFile> file, ByteRange const& part, std::string const& type) {
  auto const provide = [file = std::move(file), part](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    std::vector<char> bytes(std::min(length, bytes_at_a_time));
    ssize_t const count = file->read(bytes.data(), bytes.size(), part.first + offset);
    return count > 0 && sink.write(bytes.data(), static_cast<std::size_t>(count));
  };
  response.set_content_provider(part.count, type, provide);
}

void send_file(fs::path const& path, Request const& request, Response& response) {
  auto const file = std::make_shared<OpenFile>(path);
  if (!file->is_good()) return refuse_path(response);
  AskedRange const asked = read_range(request.get_header_value("Range"), file->size());
  response.set_header("Accept-Ranges", "bytes");
  if (asked.kind == AskedRange::Kind::beyond) {
    refuse(response, 416, "the file is not as long as that", "ask for less");
    return response.set_header("Content-Range", fmt::format("bytes */{}", file->size()));
  }
  response.status = asked.kind == AskedRange::Kind::part ? 206 : 200;
  ByteRange const part = asked.range;
  if (response.status == 206) {
    response.set_header("Content-Range",
                        fmt::format("bytes {}-{}/{}", part.first, part.first + part.count - 1, file->size()));
  }
  if (part.count == 0) return response.set_content("", type_of(path));
  send_part(response, file, part, type_of(path));
}

/// Returns index.html with the address of the data added. The same page on a server without data requests none.
std::string index_of(fs::path const& page) {
  std::string text = read_file(page / "index.html");
  std::string const head = "<head>";
  std::size_t const at = text.find(head);
  return text.insert(at == std::string::npos ? 0 : at + head.size(),
                     "<meta name=\"gridlock-data\" content=\"./data/\">");
}

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<std::string> names_between_commas(std::string const& text) {
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) {
    if (!name.empty()) names.push_back(name);
  }
  return names;
}

/// Returns the files of the built page by the paths of their requests.
std::map<std::string, fs::path> files_of_page(fs::path const& page) {
  std::map<std::string, fs::path> files;
  fs::path const root = fs::canonical(page);
  for (auto const& entry : fs::recursive_directory_iterator(root)) {
    if (entry.is_symlink() || !entry.is_regular_file()) continue;
    files["/" + entry.path().lexically_relative(root).generic_string()] = entry.path();
  }
  return files;
}

/// Returns the status of a run from its summary; nothing if there is no summary.
std::optional<std::string> end_of(Contents const& contents, ShownRun const& run) {
  if (!contents.find(run, "summary.json")) return std::nullopt;
  try {
    auto const summary = read_summary(run.directory);
    return summary ? std::optional(to_text(summary->status)) : std::nullopt;
  } catch (std::exception const&) {
    return "damaged";
  }
}

/// Returns the status of a run: that of its summary, "unfinished" while a program works in its directory, otherwise
/// "abandoned".
std::string status_of(Contents const& contents, ShownRun const& run) {
  if (auto const end = end_of(contents, run)) return *end;
  if (DirectoryLock::is_held(run.directory)) return "unfinished";
  // The run may have ended between the two checks.
  return end_of(contents, run).value_or("abandoned");
}

/// Calls `work`; an exception becomes an error answer.
template <class Work>
void guarded(Response& response, Work const& work) {
  try {
    work();
  } catch (Error const& error) {
    refuse(response, 422, error.problems().front().what, error.problems().front().hint);
  } catch (std::bad_alloc const&) {
    refuse(response, 500, "a frame does not fit into the memory", "show fewer columns, or a smaller run");
  } catch (std::exception const& error) {
    refuse(response, 500, error.what(), "try again");
  }
}

}  // namespace

AskedRange read_range(std::string const& header, std::uint64_t size) {
  using Kind = AskedRange::Kind;
  AskedRange const all{.kind = Kind::all, .range = {.first = 0, .count = size}};
  constexpr std::string_view unit = "bytes=";
  if (!header.starts_with(unit)) return all;
  std::string_view const text = std::string_view(header).substr(unit.size());
  std::size_t const dash = text.find('-');
  if (dash == std::string_view::npos) return all;
  std::string_view const before = text.substr(0, dash);
  std::string_view const after = text.substr(dash + 1);
  auto const first = whole_number(before);
  auto const last = whole_number(after);
  if ((!before.empty() && !first) || (!after.empty() && !last) || (!first && !last)) return all;
  if (first && last && *last < *first) return all;
  std::uint64_t const begin = first ? *first : size - std::min(size, *last);
  if (begin >= size || (!first && *last == 0)) return {.kind = Kind::beyond, .range = {}};
  std::uint64_t const end = first && last ? std::min(size - 1, *last) : size - 1;
  return {.kind = Kind::part, .range = {.first = begin, .count = end - begin + 1}};
}

Site::Site(Contents contents, fs::path const& page)
    : contents_(std::move(contents)), index_(index_of(page)), page_(files_of_page(page)) {}

void Site::answer(Request const& request, Response& response) {
  set_headers(response);
  if (!is_from_here(request)) {
    return refuse(response, 403, "this request comes from another site or by another name",
                  "open the address that gridlock view has printed");
  }
  if (request.method != "GET" && request.method != "HEAD") {
    response.set_header("Allow", "GET, HEAD");
    return refuse(response, 405, "only GET and HEAD are answered", "nothing can be changed here");
  }
  constexpr std::string_view data = "/data/";
  if (request.path.starts_with(data)) {
    return guarded(response, [&] { answer_data(request.path.substr(data.size()), request, response); });
  }
  if (request.path == "/" || request.path == "/index.html") {
    return response.set_content(index_, "text/html; charset=utf-8");
  }
  auto const found = page_.find(request.path);
  if (found == page_.end()) return refuse_path(response);
  send_file(found->second, request, response);
}

void Site::answer_data(std::string const& path, Request const& request, Response& response) {
  if (path == "contents.json") return set_json(response, contents_json());
  constexpr std::string_view tables = "tables/";
  if (path.starts_with(tables)) {
    auto const file = contents_.find(std::nullopt, path.substr(tables.size()));
    return file ? send_file(*file, request, response) : refuse_path(response);
  }
  constexpr std::string_view runs = "runs/";
  if (!path.starts_with(runs)) return refuse_path(response);
  std::size_t const slash = path.find('/', runs.size());
  if (slash == std::string::npos) return refuse_path(response);
  auto const run = contents_.run(path.substr(runs.size(), slash - runs.size()));
  if (!run) return refuse_path(response);
  answer_run(*run, path.substr(slash + 1), request, response);
}

void Site::answer_run(ShownRun const& run, std::string const& rest, Request const& request, Response& response) {
  constexpr std::string_view files = "files/";
  constexpr std::string_view frames = "frames/";
  if (rest == "about.json") return set_json(response, about_json(run));
  if (rest.starts_with(files)) {
    auto const file = contents_.find(run, rest.substr(files.size()));
    return file ? send_file(*file, request, response) : refuse_path(response);
  }
  auto const trajectory = contents_.find(run, run.trajectory);
  if (!trajectory) return refuse_path(response);
  if (rest == "trajectory.json") {
    return set_json(response, frames_.describe(*trajectory, whole_number(request.get_param_value("from")).value_or(0)));
  }
  auto const k = rest.starts_with(frames) ? whole_number(std::string_view(rest).substr(frames.size())) : std::nullopt;
  if (!k) return refuse_path(response);
  auto const columns = names_between_commas(request.get_param_value("columns"));
  response.set_content(frames_.frame(*trajectory, *k, columns), "application/octet-stream");
}

std::string Site::contents_json() const {
  constexpr std::array kinds{"run", "sweep", "file"};
  Json json{{"kind", kinds[static_cast<std::size_t>(contents_.kind())]},
            {"name", contents_.name()},
            {"version", version()},
            {"tables", contents_.tables()},
            {"runs", contents_.runs()}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string Site::about_json(ShownRun const& run) const {
  Json json{{"id", run.id}, {"status", status_of(contents_, run)}, {"trajectory", nullptr}, {"files", Json::array()}};
  for (std::string const& name : run.files) {
    auto const file = contents_.find(run, name);
    std::error_code error;
    if (!file) continue;
    json["files"].push_back({{"name", name}, {"bytes", fs::file_size(*file, error)}});
    if (name == run.trajectory) json["trajectory"] = name;
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace gridlock::view
