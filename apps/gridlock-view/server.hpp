#pragma once

#include <httplib.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>

namespace gridlock::view {

/// Limits on the time of clients and the size of requests.
struct ConnectionLimits {
  std::size_t threads = 64;            ///< connections served at a time; others wait
  std::size_t max_head_bytes = 65536;  ///< size of a request line with its headers
  int idle_milliseconds = 5000;        ///< time until a request begins
  int head_milliseconds = 5000;        ///< time from the first byte of a head to the last
  int crowded_milliseconds = 200;      ///< replaces both times above while connections wait
  int write_milliseconds = 15000;      ///< time until a client accepts more of an answer
};

/// An HTTP server on the loopback interface, for requests without a body.
///
/// cpp-httplib parses requests and writes answers. This class adds limits before httplib reads a byte: on size and time
/// of a request and on idle connections; a request with a body ends its connection. `Request::ranges` is always empty,
/// so the answer function must handle the header `Range`.
class Server : private httplib::Server {
 public:
  using Answer = std::function<void(httplib::Request const&, httplib::Response&)>;

  explicit Server(Answer answer, ConnectionLimits const& limits = {});

  /// Binds a port of 127.0.0.1; 0 means any free port. Returns the port, or 0 with the reason in `errno`.
  int bind(int port);
  /// Answers requests until stop(). Requires bind().
  void serve();
  /// Stops serve(), which another thread must have called or be about to call, and returns after it listens. Answers in
  /// progress are cut off.
  void stop();

 private:
  bool process_and_close_socket(socket_t socket) override;

  ConnectionLimits limits_;
  std::atomic<std::size_t> waiting_{0};  ///< connections that wait for a thread
  std::atomic<bool> is_stopping_{false};
};

}  // namespace gridlock::view
