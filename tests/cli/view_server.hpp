#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "program.hpp"

namespace gridlock::test {

/// Whether this build has gridlock-view.
inline bool has_view() { return fs::exists(fs::path(GRIDLOCK_PROGRAM).parent_path() / "gridlock-view"); }

/// A connection to a port of this machine, as raw as an attacker's.
class Connection {
 public:
  explicit Connection(int port, char const* address = "127.0.0.1") : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, address, &place.sin_addr);
    is_connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&place), sizeof(place)) == 0;
  }
  ~Connection() { close(socket_); }
  Connection(Connection const&) = delete;
  Connection& operator=(Connection const&) = delete;

  [[nodiscard]] bool is_connected() const { return is_connected_; }

  /// False where the server has closed meanwhile.
  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      ssize_t const count = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  /// Says that nothing more is sent.
  void finish() const { shutdown(socket_, SHUT_WR); }

  /// All that comes until the server closes, or until the time is over.
  [[nodiscard]] std::string receive(std::chrono::milliseconds limit = std::chrono::seconds(20)) const {
    auto const end = std::chrono::steady_clock::now() + limit;
    std::string received;
    for (;;) {
      auto const left =
          std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now()).count();
      pollfd entry{.fd = socket_, .events = POLLIN, .revents = 0};
      if (left <= 0 || poll(&entry, 1, static_cast<int>(left)) <= 0) return received;
      char bytes[65536];
      ssize_t const count = recv(socket_, bytes, sizeof(bytes), 0);
      if (count <= 0) return received;
      received.append(bytes, static_cast<std::size_t>(count));
    }
  }

 private:
  int socket_;
  bool is_connected_ = false;
};

struct Answer {
  int status = 0;  ///< 0 where nothing came
  std::string head;
  std::string body;
};

inline Answer read_answer(std::string const& text) {
  Answer answer;
  std::size_t const end = text.find("\r\n\r\n");
  if (!text.starts_with("HTTP/1.1 ") || end == std::string::npos) return answer;
  answer.status = std::stoi(text.substr(9, 3));
  answer.head = text.substr(0, end);
  answer.body = text.substr(end + 4);
  return answer;
}

/// `gridlock view PATH` at work in a workplace, with a little page.
class Viewer {
 public:
  Viewer(Workplace const& workplace, std::string const& path) {
    fs::create_directories(workplace / "page/assets");
    write(workplace / "page/index.html", "<title>the page</title>");
    write(workplace / "page/assets/main.js", "go();");
    fs::remove(workplace / ".stdout");  // of one before
    process_ = std::make_unique<Process>(
        GRIDLOCK_PROGRAM, std::vector<std::string>{"view", path, "--no-open", "--page", "page"}, workplace.path());
    port_ = printed_port(workplace / ".stdout");
  }
  ~Viewer() {
    if (process_) end(SIGTERM);
  }
  Viewer(Viewer const&) = delete;
  Viewer& operator=(Viewer const&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string host() const { return "127.0.0.1:" + std::to_string(port_); }

  /// The answer to a request with these header lines besides Host.
  [[nodiscard]] Answer get(std::string const& path, std::string const& headers = "",
                           std::string const& method = "GET") const {
    return ask(method + " " + path + " HTTP/1.1\r\nHost: " + host() + "\r\nConnection: close\r\n" + headers + "\r\n");
  }
  /// The answer to these bytes.
  [[nodiscard]] Answer ask(std::string_view bytes) const {
    Connection const connection(port_);
    connection.send(bytes);
    connection.finish();
    return read_answer(connection.receive());
  }

  Outcome end(int signal) {
    process_->signal(signal);
    Outcome outcome = process_->wait();
    process_.reset();
    return outcome;
  }

 private:
  static int printed_port(fs::path const& output) {
    std::string const before = "http://127.0.0.1:";
    auto const end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < end) {
      std::string const text = text_of(output);
      std::size_t const at = text.find(before);
      if (at != std::string::npos && text.find("Ctrl-C") != std::string::npos) {
        return std::stoi(text.substr(at + before.size()));
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ADD_FAILURE() << "gridlock view printed no address: " << text_of(output);
    return 0;
  }

  std::unique_ptr<Process> process_;
  int port_ = 0;
};

}  // namespace gridlock::test
