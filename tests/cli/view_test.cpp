// `gridlock view` serves a run, a sweep or a file to a browser on this machine, and nothing else to anybody.
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cstring>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/program.hpp"
#include "cli/view_server.hpp"
#include "gridlock/io/h5md.hpp"

namespace {

using namespace gridlock::test;
using gridlock::H5mdReader;
using Json = nlohmann::json;

constexpr char const* small_trajectory =
    "disks.count = 60\ndisks.packing_fraction = 0.5\nrun.steps = 60\nobserve.every = 20\ntrajectory.every = 20\n";

class View : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_view()) GTEST_SKIP() << "gridlock-view is not built: ./dev install program";
  }

  void make_run(std::string const& name = "results") const {
    write(workplace_ / "run.toml", small_trajectory);
    expect_good(in(workplace_, {"run", "run.toml", "-o", name, "-q"}));
  }

  Workplace workplace_;
};

/// The columns of a frame as it is served, as H5mdReader gives them.
gridlock::FrameValues values_of(Json const& column, std::size_t count, char const* data) {
  char const* const begin = data + column["offset"].get<std::size_t>();
  auto const copied = [&](auto numbers) {
    numbers.resize(count);
    std::memcpy(numbers.data(), begin, count * sizeof(numbers[0]));
    return gridlock::FrameValues(std::move(numbers));
  };
  if (column["type"] == "int32") return copied(std::vector<std::int32_t>());
  if (column["type"] == "uint32") return copied(std::vector<std::uint32_t>());
  if (column["type"] == "uint64") return copied(std::vector<std::uint64_t>());
  EXPECT_EQ(column["type"], "float64");
  return copied(std::vector<double>());
}

struct ServedFrame {
  Json head;
  std::string data;
};

ServedFrame read_frame(std::string const& bytes) {
  std::uint32_t length = 0;
  EXPECT_GE(bytes.size(), sizeof(length));
  std::memcpy(&length, bytes.data(), sizeof(length));
  EXPECT_EQ((sizeof(length) + length) % 8, 0U);
  return {Json::parse(bytes.substr(sizeof(length), length)), bytes.substr(sizeof(length) + length)};
}

TEST_F(View, ServesThePageAndTheFilesOfARun) {
  make_run();
  Viewer const viewer(workplace_, "results");
  std::string const page = "<meta name=\"gridlock-data\" content=\"./data/\"><title>the page</title>";
  EXPECT_EQ(viewer.get("/").body, page);
  EXPECT_EQ(viewer.get("/index.html").body, page);
  Answer const script = viewer.get("/assets/main.js");
  EXPECT_EQ(script.body, "go();");
  EXPECT_NE(script.head.find("Content-Type: text/javascript"), std::string::npos) << script.head;
  EXPECT_NE(script.head.find("Content-Security-Policy: default-src 'self'"), std::string::npos) << script.head;
  Json const contents = Json::parse(viewer.get("/data/contents.json").body);
  EXPECT_EQ(contents["kind"], "run");
  EXPECT_EQ(contents["runs"], Json::array({"run"}));
  Json const about = Json::parse(viewer.get("/data/runs/run/about.json").body);
  EXPECT_EQ(about["status"], "finished");
  EXPECT_EQ(about["trajectory"], "trajectory.h5");
  for (Json const& file : about["files"]) {
    std::string const name = file["name"];
    EXPECT_EQ(viewer.get("/data/runs/run/files/" + name).body, text_of(workplace_ / "results" / name)) << name;
  }
  Answer const head = viewer.get("/data/runs/run/files/series.csv", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_EQ(viewer.get("/data/runs/run/files/checkpoint.gridlock").status, 404) << "it is on no list";
  EXPECT_EQ(viewer.get("/data/runs/other/about.json").status, 404);
}

TEST_F(View, GivesFramesAsTheLibraryReadsThem) {
  make_run();
  Viewer const viewer(workplace_, "results");
  H5mdReader const trajectory(workplace_ / "results/trajectory.h5");
  Json const described = Json::parse(viewer.get("/data/runs/run/trajectory.json?from=1").body);
  EXPECT_EQ(described["valueNames"], Json::object()) << "disks have none";
  EXPECT_EQ(described["frames"], 4);
  EXPECT_EQ(described["configuration"], trajectory.settings().configuration) << "which has the walls";
  EXPECT_EQ(described["steps"], Json::array({20, 40, 60}));
  for (std::size_t k = 0; k < trajectory.frame_count(); ++k) {
    gridlock::H5mdFrame const expected = trajectory.frame(k);
    ServedFrame const served = read_frame(viewer.get("/data/runs/run/frames/" + std::to_string(k)).body);
    EXPECT_EQ(served.head["step"], expected.frame.clock.step);
    EXPECT_EQ(served.head["time"].get<double>(), expected.frame.clock.time);
    ASSERT_EQ(served.head["columns"].size(), expected.frame.columns.size() + 1);
    EXPECT_EQ(values_of(served.head["columns"][0], expected.frame.size(), served.data.data()),
              gridlock::FrameValues(expected.frame.ids));
    for (std::size_t c = 0; c < expected.frame.columns.size(); ++c) {
      Json const& column = served.head["columns"][c + 1];
      EXPECT_EQ(column["name"], expected.frame.columns[c].name);
      EXPECT_EQ(values_of(column, expected.frame.size(), served.data.data()), expected.frame.columns[c].values);
    }
    for (std::size_t o = 0; k > 0 && o < expected.observables.size(); ++o) {
      Json const& value = described["observables"][o]["values"][k - 1];
      EXPECT_EQ(value.is_null(), std::isnan(expected.observables[o]));
      if (!value.is_null()) {
        EXPECT_EQ(value.get<double>(), expected.observables[o]);
      }
    }
  }
  Json const columns = read_frame(viewer.get("/data/runs/run/frames/0?columns=y,nonsense").body).head["columns"];
  ASSERT_EQ(columns.size(), 2U);
  EXPECT_EQ(columns[1]["name"], "y");
  Answer const beyond = viewer.get("/data/runs/run/frames/4");
  EXPECT_EQ(beyond.status, 422);
  EXPECT_NE(beyond.body.find("there is no frame 4"), std::string::npos) << beyond.body;
  for (char const* number : {"-1", "x", "", "1e1", "99999999999999999999"}) {
    EXPECT_EQ(viewer.get(std::string("/data/runs/run/frames/") + number).status, 404) << number;
  }
}

TEST_F(View, AnswersOneRangeOfBytes) {
  make_run();
  Viewer const viewer(workplace_, "results");
  std::string const file = text_of(workplace_ / "results/series.csv");
  std::string const size = std::to_string(file.size());
  std::string const address = "/data/runs/run/files/series.csv";
  struct Case {
    std::string range;
    int status;
    std::string body;
    std::string content_range;
  };
  std::string const end = std::to_string(file.size() - 1);
  for (Case const& c : std::vector<Case>{{"bytes=0-9", 206, file.substr(0, 10), "bytes 0-9/" + size},
                                         {"bytes=7-7", 206, file.substr(7, 1), "bytes 7-7/" + size},
                                         {"bytes=20-", 206, file.substr(20), "bytes 20-" + end + "/" + size},
                                         {"bytes=5-999999999999", 206, file.substr(5), "bytes 5-" + end + "/" + size},
                                         {"bytes=-4", 206, file.substr(file.size() - 4),
                                          "bytes " + std::to_string(file.size() - 4) + "-" + end + "/" + size},
                                         {"bytes=-999999999", 206, file, "bytes 0-" + end + "/" + size},
                                         {"bytes=" + size + "-", 416, "", "bytes */" + size},
                                         {"bytes=-0", 416, "", "bytes */" + size},
                                         {"bytes=9-3", 416, "", ""},
                                         {"bytes=0-1,4-5", 200, file, ""},
                                         {"lines=0-1", 416, "", ""}}) {
    Answer const answer = viewer.get(address, "Range: " + c.range + "\r\n");
    EXPECT_EQ(answer.status, c.status) << c.range;
    if (c.status != 416) {
      EXPECT_EQ(answer.body, c.body) << c.range;
    }
    EXPECT_EQ(answer.head.find("Content-Range: ") != std::string::npos, !c.content_range.empty()) << answer.head;
    EXPECT_NE(answer.head.find(c.content_range), std::string::npos) << answer.head;
  }
}

TEST_F(View, ListsTheRunsOfASweepAlsoThoseThatBeginLater) {
  write(workplace_ / "sweep.toml", std::string(small_trajectory) + "[sweep]\n\"run.seed\" = [1, 2]\n");
  expect_good(in(workplace_, {"sweep", "sweep.toml", "-o", "results", "-q", "--no-pictures"}));
  Viewer const viewer(workplace_, "results");
  Json const contents = Json::parse(viewer.get("/data/contents.json").body);
  EXPECT_EQ(contents["kind"], "sweep");
  ASSERT_EQ(contents["runs"].size(), 2U);
  std::string const name = contents["runs"][1];
  EXPECT_EQ(viewer.get("/data/tables/sweep.csv").body, text_of(workplace_ / "results/sweep.csv"));
  EXPECT_EQ(Json::parse(viewer.get("/data/runs/" + name + "/trajectory.json").body)["frames"], 4);
  fs::copy(workplace_ / "results/runs" / name, workplace_ / "results/runs/later");
  EXPECT_EQ(Json::parse(viewer.get("/data/contents.json").body)["runs"].size(), 3U);
  EXPECT_EQ(viewer.get("/data/runs/later/about.json").status, 200);
}

TEST_F(View, ShowsAFileAlone) {
  make_run();
  for (std::string const name : {"trajectory.h5", "final.xyz"}) {
    Viewer const viewer(workplace_, "results/" + name);
    EXPECT_EQ(Json::parse(viewer.get("/data/contents.json").body)["kind"], "file");
    EXPECT_EQ(viewer.get("/data/runs/run/files/" + name).body, text_of(workplace_ / "results" / name));
    EXPECT_EQ(viewer.get("/data/runs/run/files/series.csv").status, 404) << "only the file that was named";
    EXPECT_EQ(viewer.get("/data/runs/run/trajectory.json").status, name == "trajectory.h5" ? 200 : 404);
  }
}

TEST_F(View, SaysWhatIsWrongWithADamagedTrajectory) {
  make_run();
  std::string bytes = text_of(workplace_ / "results/trajectory.h5");
  write(workplace_ / "results/trajectory.h5", bytes.substr(0, bytes.size() / 2));
  Viewer const viewer(workplace_, "results");
  Answer const answer = viewer.get("/data/runs/run/frames/3");
  EXPECT_EQ(answer.status, 422);
  EXPECT_NE(answer.body.find("trajectory.h5"), std::string::npos) << answer.body;
  write(workplace_ / "results/trajectory.h5", "no trajectory at all");
  EXPECT_EQ(viewer.get("/data/runs/run/trajectory.json").status, 422);
  EXPECT_EQ(viewer.get("/").status, 200);
}

TEST_F(View, ServesNoPathOutsideTheDirectory) {
  make_run("outer/results");
  write(workplace_ / "outer/secret.txt", "SECRET");
  write(workplace_ / "outer/results/secret.txt", "SECRET");
  Viewer const viewer(workplace_, "outer/results");
  std::string const absolute = (workplace_ / "outer/secret.txt").string();
  std::vector<std::string> starts{"/", "/data/", "/data/runs/", "/data/runs/run/files/", "/data/tables/", "/assets/"};
  std::vector<std::string> ends{"secret.txt",
                                "../secret.txt",
                                "../../secret.txt",
                                "..%2fsecret.txt",
                                "%2e%2e/secret.txt",
                                "%2e%2e%2fsecret.txt",
                                "%252e%252e%252fsecret.txt",
                                "..%5csecret.txt",
                                "..\\secret.txt",
                                "....//secret.txt",
                                "%c0%ae%c0%ae%c0%afsecret.txt",
                                "series.csv/../../secret.txt",
                                "series.csv%00/../secret.txt",
                                "secret.txt%00series.csv",
                                "./././secret.txt",
                                "file://" + absolute,
                                absolute,
                                "%2f" + absolute.substr(1)};
  for (std::string const& start : starts) {
    for (std::string const& end : ends) {
      Answer const answer = viewer.get(start + end);
      EXPECT_TRUE(answer.status == 404 || answer.status == 400) << start << end << ": " << answer.status;
      EXPECT_EQ(answer.body.find("SECRET"), std::string::npos) << start << end;
    }
  }
  for (std::string const& target : {absolute, std::string("http://127.0.0.1") + absolute, std::string("*"),
                                    std::string("secret.txt"), std::string("127.0.0.1:80")}) {
    Answer const answer = viewer.get(target);
    EXPECT_NE(answer.status, 200) << target;
    EXPECT_EQ(answer.body.find("SECRET"), std::string::npos) << target;
  }
}

TEST_F(View, FollowsNoLinkOutOfTheDirectory) {
  make_run("outer/results");
  write(workplace_ / "outer/secret.txt", "SECRET");
  fs::path const results = workplace_ / "outer/results";
  fs::create_directories(workplace_ / "page");
  for (char const* name : {"run.log", "series.csv"}) fs::remove(results / name);
  fs::create_symlink("../secret.txt", results / "run.log");
  fs::create_symlink("final.xyz", results / "series.csv");
  fs::create_symlink(workplace_ / "outer/secret.txt", workplace_ / "page/secret.txt");
  mkfifo((results / "stages.csv").c_str(), 0666);
  {
    Viewer const viewer(workplace_, "outer/results");
    for (char const* path : {"/data/runs/run/files/run.log", "/secret.txt", "/data/runs/run/files/stages.csv"}) {
      EXPECT_EQ(viewer.get(path).status, 404) << path;
    }
    EXPECT_EQ(viewer.get("/data/runs/run/files/series.csv").body, text_of(results / "final.xyz")) << "a link inside";
    EXPECT_EQ(Json::parse(viewer.get("/data/runs/run/about.json").body).dump().find("run.log"), std::string::npos);
  }
  fs::create_directories(workplace_ / "sweep/runs");
  fs::create_symlink(results, workplace_ / "sweep/runs/linked");
  write(workplace_ / "sweep/plan.json", "{}");
  Viewer const viewer(workplace_, "sweep");
  EXPECT_EQ(Json::parse(viewer.get("/data/contents.json").body)["runs"], Json::array());
  EXPECT_EQ(viewer.get("/data/runs/linked/files/final.xyz").status, 404);
  EXPECT_EQ(viewer.get("/data/runs/../about.json").status, 404);
  EXPECT_EQ(viewer.get("/data/runs/%2e%2e/about.json").status, 404);
  // Nor the names of runs that lie elsewhere.
  make_run("elsewhere/secret");
  make_run("mine");
  fs::create_symlink(workplace_ / "elsewhere", workplace_ / "mine/runs");
  Viewer const own(workplace_, "mine");
  auto const contents = Json::parse(own.get("/data/contents.json").body);
  EXPECT_EQ(contents["kind"], "run") << contents;
  EXPECT_EQ(contents.dump().find("secret"), std::string::npos) << contents;
  write(workplace_ / "mine/plan.json", "{}");
  Viewer const sweep(workplace_, "mine");
  EXPECT_EQ(Json::parse(sweep.get("/data/contents.json").body)["runs"], Json::array());
  EXPECT_EQ(sweep.get("/data/runs/secret/files/final.xyz").status, 404);
}

TEST_F(View, AnswersOnlyGetAndHead) {
  make_run();
  Viewer const viewer(workplace_, "results");
  for (std::string const& method : std::vector<std::string>{"POST", "PUT", "DELETE", "PATCH", "OPTIONS"}) {
    Answer const answer = viewer.get("/", "Content-Length: 3\r\n", method);
    EXPECT_EQ(answer.status, 405) << method;
    EXPECT_NE(answer.head.find("Allow: GET, HEAD"), std::string::npos) << answer.head;
  }
  for (std::string const& method : std::vector<std::string>{"TRACE", "CONNECT", "PROPFIND", "get", "G\x01T", ""}) {
    int const status = viewer.get("/", "", method).status;
    EXPECT_TRUE(status == 405 || status == 400 || status == 0) << method << ": " << status;
  }
  // What follows a request with a body is not taken for a request of its own.
  std::string const hidden = "GET /assets/main.js HTTP/1.1\r\nHost: " + viewer.host() + "\r\n\r\n";
  Connection const connection(viewer.port());
  connection.send("GET / HTTP/1.1\r\nHost: " + viewer.host() + "\r\nContent-Length: " + std::to_string(hidden.size()) +
                  "\r\n\r\n" + hidden);
  EXPECT_EQ(connection.receive().find("go();"), std::string::npos);
  EXPECT_EQ(viewer.get("/").status, 200);
}

TEST_F(View, AnswersOnlyItsOwnPageUnderNamesOfThisMachine) {
  make_run();
  Viewer const viewer(workplace_, "results");
  auto const status = [&](std::string const& headers) {
    return viewer.ask("GET /data/contents.json HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n").status;
  };
  std::string const port = std::to_string(viewer.port());
  for (std::string const& host :
       std::vector<std::string>{"127.0.0.1:" + port, "localhost:" + port, std::string("localhost:1"),
                                std::string("localhost"), "[::1]:" + port}) {
    EXPECT_EQ(status("Host: " + host + "\r\n"), 200) << host;
    EXPECT_EQ(status("Host: " + host + "\r\nOrigin: http://" + host + "\r\n"), 200) << host;
  }
  for (std::string const& host :
       std::vector<std::string>{"example.org", "example.org:" + port, "127.0.0.1.example.org", "localhost.example.org",
                                "example.org#127.0.0.1", "localhost@example.org", "", "[::1", "[::1]x", "0.0.0.0",
                                "127.0.0.1 example.org"}) {
    EXPECT_EQ(status("Host: " + host + "\r\n"), 403) << host;
  }
  EXPECT_EQ(status(""), 403) << "without a host";
  EXPECT_EQ(status("Host: " + viewer.host() + "\r\nHost: example.org\r\n"), 403);
  for (std::string const& origin :
       std::vector<std::string>{"http://example.org", "null", "https://" + viewer.host(), "http://localhost:1",
                                "http://" + viewer.host() + ".example.org", "file://"}) {
    EXPECT_EQ(status("Host: " + viewer.host() + "\r\nOrigin: " + origin + "\r\n"), 403) << origin;
  }
}

TEST_F(View, ListensOnTheLoopbackInterfaceAlone) {
  make_run();
  Viewer const viewer(workplace_, "results");
  EXPECT_TRUE(Connection(viewer.port()).is_connected());
  EXPECT_FALSE(Connection(viewer.port(), "127.0.0.2").is_connected());
  ifaddrs* interfaces = nullptr;
  ASSERT_EQ(getifaddrs(&interfaces), 0);
  for (ifaddrs const* entry = interfaces; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    char address[INET_ADDRSTRLEN] = {};
    inet_ntop(AF_INET, &reinterpret_cast<sockaddr_in const*>(entry->ifa_addr)->sin_addr, address, sizeof(address));
    if (!std::string(address).starts_with("127.")) {
      EXPECT_FALSE(Connection(viewer.port(), address).is_connected()) << address;
    }
  }
  freeifaddrs(interfaces);
}

TEST_F(View, SurvivesWhatIsNoRequest) {
  make_run();
  Viewer const viewer(workplace_, "results");
  std::string const start = "GET / HTTP/1.1\r\nHost: " + viewer.host() + "\r\n";
  std::string many_lines = start;
  for (int k = 0; k < 100'000; ++k) many_lines += "X-" + std::to_string(k) + ": y\r\n";
  std::string ranges = start + "Range: bytes=0-1";
  for (int k = 0; k < 1500; ++k) ranges += ",0-1";
  std::string every_byte;
  for (int k = 0; k < 256; ++k) every_byte += static_cast<char>(k);
  struct Case {
    char const* what;
    std::string bytes;
    std::vector<int> statuses;
  };
  for (Case const& c : std::vector<Case>{
           {"a header of a megabyte", start + "X: " + std::string(1 << 20, 'x') + "\r\n\r\n", {431}},
           {"a hundred thousand headers", many_lines + "\r\n", {431}},
           {"an address of a megabyte", "GET /" + std::string(1 << 20, 'x') + " HTTP/1.1\r\n\r\n", {431}},
           {"an address of 10 000 letters",
            "GET /" + std::string(10'000, 'x') + " HTTP/1.1\r\nHost: " + viewer.host() +
                "\r\nConnection: close\r\n\r\n",
            {400, 414, 404}},
           {"a header of 20 000 letters",
            start + "Connection: close\r\nX: " + std::string(20'000, 'x') + "\r\n\r\n",
            {0, 200, 400}},
           {"a thousand ranges", ranges + "\r\n\r\n", {400}},
           {"a line without an end", std::string(1 << 20, 'x'), {431}},
           {"nothing but ends of lines", "\r\n\r\n\r\n\r\n", {0, 400}},
           {"every byte there is", every_byte + "\r\n\r\n", {0, 400}},
           {"zeros", std::string(70'000, '\0'), {431}},
           {"TLS", "\x16\x03\x01\x02\x01\x01\x01\xfc\x03\x03" + std::string(60, 'r') + "\r\n\r\n", {0, 400}},
           {"HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", {0, 400, 405}},
           {"HTTP/0.9", "GET /\r\n\r\n", {0, 400}}}) {
    Answer const answer = viewer.ask(c.bytes);
    EXPECT_NE(std::find(c.statuses.begin(), c.statuses.end(), answer.status), c.statuses.end())
        << c.what << ": " << answer.status;
    EXPECT_EQ(viewer.get("/").status, 200) << "after " << c.what;
  }
}

TEST_F(View, EndsConnectionsThatOnlyWait) {
  make_run();
  Viewer const viewer(workplace_, "results");
  Connection const half(viewer.port());
  half.send("GET / HTTP/1.1\r\nHost:");
  Connection const silent(viewer.port());
  auto const begin = std::chrono::steady_clock::now();
  EXPECT_EQ(read_answer(half.receive()).status, 408);
  EXPECT_EQ(silent.receive(), "");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));
}

TEST_F(View, AnswersSoonBesideManyRequestsThatAreHalfSent) {
  make_run();
  Viewer const viewer(workplace_, "results");
  std::vector<std::unique_ptr<Connection>> half;
  for (int k = 0; k < 300; ++k) {
    half.push_back(std::make_unique<Connection>(viewer.port()));
    half.back()->send("GET / HTTP/1.1\r\nHost:");
  }
  auto const begin = std::chrono::steady_clock::now();
  EXPECT_EQ(viewer.get("/").status, 200);
  // Five rounds of 64 connections that were each waited for as long as one that is alone would take 25 seconds.
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
  EXPECT_EQ(read_answer(half.front()->receive()).status, 408);
}

TEST_F(View, AnswersSeveralRequestsOfOneConnection) {
  make_run();
  Viewer const viewer(workplace_, "results");
  Connection const connection(viewer.port());
  std::string requests;
  for (int k = 0; k < 20; ++k) {
    requests += "GET /assets/main.js HTTP/1.1\r\nHost: " + viewer.host() + "\r\n";
    requests += k == 19 ? "Connection: close\r\n\r\n" : "\r\n";
  }
  connection.send(requests);
  std::string const answers = connection.receive();
  std::size_t count = 0;
  for (std::size_t at = 0; (at = answers.find("go();", at)) != std::string::npos; ++at) ++count;
  EXPECT_EQ(count, 20U) << answers;
}

TEST_F(View, AnswersBesideAThousandConnections) {
  make_run();
  rlimit limit{};
  getrlimit(RLIMIT_NOFILE, &limit);
  limit.rlim_cur = std::min<rlim_t>(limit.rlim_max, 4096);
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &limit), 0);
  Viewer viewer(workplace_, "results");
  std::vector<std::unique_ptr<Connection>> silent;
  for (int k = 0; k < 1000; ++k) {
    silent.push_back(std::make_unique<Connection>(viewer.port()));
    ASSERT_TRUE(silent.back()->is_connected()) << k;
  }
  EXPECT_EQ(viewer.get("/").status, 200) << "beside a thousand that say nothing";
  silent.clear();
  std::vector<std::unique_ptr<Connection>> asking;
  for (int k = 0; k < 1000; ++k) {
    asking.push_back(std::make_unique<Connection>(viewer.port()));
    asking.back()->send("GET /assets/main.js HTTP/1.1\r\nHost: " + viewer.host() + "\r\nConnection: close\r\n\r\n");
  }
  for (auto const& connection : asking) EXPECT_EQ(read_answer(connection->receive()).body, "go();");
  EXPECT_EQ(viewer.end(SIGINT).exit_code, 0);
}

TEST_F(View, StopsOnSignalsAlsoInTheMiddleOfAnAnswer) {
  make_run();
  std::string const name = "results/series.csv";
  std::ofstream(workplace_ / name) << std::string(50 << 20, 'x');
  for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
    Viewer viewer(workplace_, "results");
    Connection const idle(viewer.port());
    Connection const slow(viewer.port());
    slow.send("GET /data/runs/run/files/series.csv HTTP/1.1\r\nHost: " + viewer.host() + "\r\n\r\n");
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    auto const begin = std::chrono::steady_clock::now();
    Outcome const outcome = viewer.end(signal);
    EXPECT_EQ(outcome.exit_code, 0) << signal;
    EXPECT_EQ(outcome.err, "");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(5)) << signal;
  }
}

TEST_F(View, SaysWhyItCannotBegin) {
  make_run();
  Viewer const viewer(workplace_, "results");
  fs::create_directory(workplace_ / "empty");
  fs::create_directory(workplace_ / "no_page");
  write(workplace_ / "text.txt", "text");
  struct Case {
    std::vector<std::string> arguments;
    std::string message;
  };
  for (Case const& c : std::vector<Case>{
           {{"view"}, "gridlock view needs PATH"},
           {{"view", ""}, "must not be empty"},
           {{"view", "nowhere"}, "there is no nowhere\n  hint: name the directory of a run or sweep"},
           {{"view", "empty", "--page", "page"}, "empty holds neither a run nor a sweep\n  hint: "},
           {{"view", "text.txt", "--page", "page"}, "text.txt cannot be shown\n  hint: "},
           {{"view", "results", "--page", "no_page"},
            "there is no index.html in no_page\n  hint: the packages and the wheel that"},
           {{"view", "results", "--page", "page", "--no-open", "--port", std::to_string(viewer.port())},
            "port " + std::to_string(viewer.port()) + " is in use\n  hint: leave --port out"},
           {{"view", "results", "--port", "0"}, "--port must be a whole number, from 1 to 65535, but is 0"},
           {{"view", "results", "--port", "70000"}, "--port must be a whole number"},
           {{"view", "results", "--no-opne"},
            "gridlock view has no option --no-opne\n  hint: did you mean --no-open?"}}) {
    Workplace const elsewhere;  // the viewer writes its output into the other
    Outcome const outcome = Process(
                                "/usr/bin/env",
                                [&] {
                                  std::vector<std::string> words{"-C", workplace_.path().string(), GRIDLOCK_PROGRAM};
                                  words.insert(words.end(), c.arguments.begin(), c.arguments.end());
                                  return words;
                                }(),
                                elsewhere.path())
                                .wait();
    EXPECT_EQ(outcome.exit_code, 2) << outcome.out << outcome.err;
    EXPECT_NE(outcome.err.find(c.message), std::string::npos) << c.message << "\n" << outcome.err;
  }
}

TEST_F(View, WithoutAPageSaysHowItIsBuilt) {
  make_run();
  fs::create_directory(workplace_ / "bin");
  for (char const* name : {"gridlock", "gridlock-view"}) {
    fs::copy_file(fs::path(GRIDLOCK_PROGRAM).parent_path() / name, workplace_ / "bin" / name);
  }
  Outcome const outcome =
      Process((workplace_ / "bin/gridlock").string(), {"view", "results"}, workplace_.path()).wait();
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(
      outcome.err,
      "error: the page that shows runs is not built\n  hint: the packages and the wheel that ./dev makes have it; "
      "in the sources of Gridlock, ./dev build-web makes it alone\n");
  // An installation has it beside the program's directory.
  fs::create_directories(workplace_ / "share/gridlock/web");
  write(workplace_ / "share/gridlock/web/index.html", "installed");
  Process const process((workplace_ / "bin/gridlock").string(), {"view", "results", "--no-open"}, workplace_.path());
  wait_for(workplace_ / ".stdout");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  process.signal(SIGTERM);
  Outcome const installed = process.wait();
  EXPECT_EQ(installed.exit_code, 0) << installed.err;
  EXPECT_NE(installed.out.find("ssh -N -L "), std::string::npos) << installed.out;
}

TEST_F(View, OpensTheBrowserOfADesktop) {
  make_run();
  fs::create_directories(workplace_ / "path");
  fs::create_directories(workplace_ / "page");
  write(workplace_ / "page/index.html", "page");
  write(workplace_ / "path/xdg-open", "#!/bin/sh\necho \"$@\" > " + (workplace_ / "opened").string() + "\n");
  fs::permissions(workplace_ / "path/xdg-open", fs::perms::owner_all);
  auto const begin = [&](std::vector<std::string> words) {
    words.insert(words.begin(), "PATH=" + (workplace_ / "path").string() + ":/usr/bin:/bin");
    return Process("/usr/bin/env", words, workplace_.path());
  };
  Process const process = begin({"DISPLAY=:0", GRIDLOCK_PROGRAM, "view", "results", "--page", "page"});
  wait_for(workplace_ / "opened");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait().exit_code, 0);
  EXPECT_TRUE(text_of(workplace_ / "opened").starts_with("http://127.0.0.1:")) << text_of(workplace_ / "opened");
  fs::remove(workplace_ / "opened");
  Process const silent = begin({"DISPLAY=:0", GRIDLOCK_PROGRAM, "view", "results", "--page", "page", "--no-open"});
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  silent.signal(SIGTERM);
  EXPECT_EQ(silent.wait().exit_code, 0);
  EXPECT_FALSE(fs::exists(workplace_ / "opened"));
}

/// The number of frames that the viewer sees; the newest of them are read.
std::size_t frames_seen(Viewer const& viewer, std::size_t known) {
  Answer const answer = viewer.get("/data/runs/run/trajectory.json");
  if (answer.status == 404) return 0;  // not begun
  EXPECT_EQ(answer.status, 200) << answer.body;
  std::size_t const count = Json::parse(answer.body)["frames"];
  EXPECT_GE(count, known);
  for (std::size_t k = std::max(known, count - std::min<std::size_t>(count, 10)); k < count; ++k) {
    Answer const frame = viewer.get("/data/runs/run/frames/" + std::to_string(k));
    EXPECT_EQ(frame.status, 200) << frame.body;
  }
  return count;
}

TEST_F(View, FollowsARunWhileItIsWrittenKilledAndResumed) {
  write(workplace_ / "run.toml",
        "disks.count = 2000\ndisks.packing_fraction = 0.5\nrun.steps = 2000000\nobserve.every = 1000\n"
        "trajectory.every = 20\n");
  Workplace const elsewhere;  // for the output of the run
  std::string const results = (workplace_ / "results").string();
  Process const run(GRIDLOCK_PROGRAM, {"run", (workplace_ / "run.toml").string(), "-o", results, "-q"},
                    elsewhere.path());
  wait_for(workplace_ / "results/config.resolved.toml");
  Viewer const viewer(workplace_, "results");
  EXPECT_EQ(Json::parse(viewer.get("/data/runs/run/about.json").body)["status"], "unfinished");
  auto const follow = [&](std::size_t seen, int growths) {
    auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (growths > 0 && std::chrono::steady_clock::now() < end) {
      std::size_t const count = frames_seen(viewer, seen);
      if (count > seen) --growths;
      seen = count;
    }
    EXPECT_EQ(growths, 0) << "the trajectory did not grow";
    return seen;
  };
  std::size_t seen = follow(0, 10);
  run.signal(SIGKILL);
  EXPECT_EQ(run.wait().exit_code, 128 + SIGKILL);
  seen = frames_seen(viewer, seen);
  EXPECT_EQ(Json::parse(viewer.get("/data/runs/run/about.json").body)["status"], "abandoned");
  Process const resumed(GRIDLOCK_PROGRAM, {"resume", results, "-q"}, elsewhere.path());
  follow(seen, 5);
  EXPECT_EQ(Json::parse(viewer.get("/data/runs/run/about.json").body)["status"], "unfinished");
  resumed.signal(SIGTERM);
  resumed.wait();
}

}  // namespace
