#pragma once

#include <httplib.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace gridlock::view {

/// How long a client may take, and how much it may send.
struct ConnectionLimits {
  std::size_t threads = 64;            ///< connections that are served at a time; others wait
  std::size_t max_head_bytes = 65536;  ///< of a request line with its headers
  int idle_milliseconds = 5000;        ///< until a request begins
  int head_milliseconds = 5000;        ///< from its first byte to its last
  int crowded_milliseconds = 200;      ///< for either while other connections wait
  int write_milliseconds = 15000;      ///< until a client takes more of an answer
};

/// An HTTP server on the loopback interface, for requests without a body.
///
/// cpp-httplib parses requests and writes answers. What it leaves open is bounded here, before it reads a byte: the
/// size and the time of a request, the connections that only wait, and a request with a body, after which the
/// connection ends.
/// `Request::ranges` is always empty: the header `Range` is left to who answers.
class Server : private httplib::Server {
 public:
  using Answer = std::function<void(httplib::Request const&, httplib::Response&)>;

  explicit Server(Answer answer, ConnectionLimits const& limits = {});

  /// Takes a port of 127.0.0.1, any free one for 0. Returns the port, or 0 where it cannot be had; then `errno` says
  /// why.
  int bind(int port);
  /// Answers until stop(). Requires bind().
  void serve();
  /// From another thread than serve(), which must be called; returns once that listens. Answers that are being written
  /// are cut off.
  void stop();

 private:
  bool process_and_close_socket(socket_t socket) override;

  ConnectionLimits limits_;
  std::atomic<std::size_t> waiting_{0};  ///< connections that no thread serves yet
  std::atomic<bool> is_stopping_{false};
};

}  // namespace gridlock::view
