#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <string>

#include "server.hpp"

namespace gridlock::view {

/// A connection. This class reads the complete head of a request within limits, and passes only these bytes to httplib.
class RequestStream final : public httplib::Stream {
 public:
  enum class Head {
    whole,
    whole_and_last,  ///< a request with a body, which is not read
    none,            ///< the client has disconnected or was idle for too long
    too_large,
    too_slow,
    bad_range,  ///< longer than ranges of browsers
  };

  /// `should_hurry` returns whether other connections wait; it is called while a request is incomplete.
  RequestStream(socket_t socket, ConnectionLimits const& limits, std::atomic<bool> const& is_stopping,
                std::function<bool()> should_hurry)
      : socket_(socket), limits_(limits), is_stopping_(is_stopping), should_hurry_(std::move(should_hurry)) {}

  Head read_head();
  /// Sends an error answer without httplib.
  void refuse(int status, char const* reason, char const* text);
  /// Closes the connection. The client still receives the answer, even if it sent more bytes than were read.
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

  /// Waits for an event of the socket; returns false after the given time or when the server stops.
  bool wait(short events, int milliseconds) const;
  /// Waits for bytes of a request that began at `begin`; only for crowded_milliseconds if other connections wait.
  bool wait_for_bytes(Clock::time_point begin, int max_milliseconds) const;

  socket_t socket_;
  ConnectionLimits limits_;
  std::atomic<bool> const& is_stopping_;
  std::function<bool()> should_hurry_;
  std::string received_;
  std::size_t at_ = 0;   ///< bytes of the head that httplib has read
  std::size_t end_ = 0;  ///< length of the current head; later bytes belong to the next request
};

}  // namespace gridlock::view
