#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "server.hpp"

namespace gridlock::view {

/// One connection. The head of a request is read here as a whole, within bounds; httplib gets those bytes and no
/// others.
class RequestStream final : public httplib::Stream {
 public:
  enum class Head {
    whole,
    whole_and_last,  ///< a request that may have a body, which nobody reads
    none,            ///< the client has gone, or sent nothing for too long
    too_large,
    too_slow,
    bad_range,  ///< longer than any range a browser asks for
  };

  /// `should_hurry` is asked while a request has not come as a whole.
  RequestStream(socket_t socket, ConnectionLimits const& limits, std::atomic<bool> const& is_stopping,
                std::function<bool()> should_hurry)
      : socket_(socket), limits_(limits), is_stopping_(is_stopping), should_hurry_(std::move(should_hurry)) {}

  Head read_head();
  /// Answers a request that httplib does not see.
  void refuse(int status, char const* reason, char const* text);
  /// Ends the connection so that the client still gets what was written, also where it has sent more than was read.
  void close();

  [[nodiscard]] bool is_readable() const override { return at_ < end_; }
  [[nodiscard]] bool is_writable() const override;
  ssize_t read(char* bytes, size_t size) override;
  ssize_t write(char const* bytes, size_t size) override;
  void get_remote_ip_and_port(std::string& address, int& port) const override;
  void get_local_ip_and_port(std::string& address, int& port) const override;
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  using Clock = std::chrono::steady_clock;

  /// Waits for the socket; false when the time is over or the server stops.
  bool wait(short events, int milliseconds) const;
  /// The same for bytes of a request, from `begin` on; less long while other connections wait.
  bool wait_for_bytes(Clock::time_point begin, int max_milliseconds) const;

  socket_t socket_;
  ConnectionLimits limits_;
  std::atomic<bool> const& is_stopping_;
  std::function<bool()> should_hurry_;
  std::string received_;
  std::size_t at_ = 0;   ///< what httplib has read
  std::size_t end_ = 0;  ///< of the head of the present request; what follows belongs to the next one
};

}  // namespace gridlock::view
