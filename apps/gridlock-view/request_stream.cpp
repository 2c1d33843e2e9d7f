#include "request_stream.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <string_view>

namespace gridlock::view {

namespace {

using std::chrono::milliseconds;

/// Maximum time in milliseconds until a stop is noticed.
constexpr int slice = 50;
/// Maximum length of a Range header; httplib parses it by a regular expression whose stack use grows with the length.
constexpr std::size_t longest_range = 128;

int left_until(std::chrono::steady_clock::time_point end) {
  return static_cast<int>(std::chrono::duration_cast<milliseconds>(end - std::chrono::steady_clock::now()).count());
}

bool begins_with_name(std::string_view line, std::string_view name) {
  return line.size() > name.size() && line[name.size()] == ':' &&
         std::equal(name.begin(), name.end(), line.begin(),
                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
}

RequestStream::Head kind_of(std::string_view head) {
  bool const has_no_body = head.starts_with("GET ") || head.starts_with("HEAD ");
  auto kind = has_no_body ? RequestStream::Head::whole : RequestStream::Head::whole_and_last;
  while (!head.empty()) {
    std::string_view const line = head.substr(0, head.find('\n'));
    head.remove_prefix(std::min(head.size(), line.size() + 1));
    if (begins_with_name(line, "range") && line.size() > longest_range) return RequestStream::Head::bad_range;
    if (begins_with_name(line, "content-length") || begins_with_name(line, "transfer-encoding")) {
      kind = RequestStream::Head::whole_and_last;
    }
  }
  return kind;
}

}  // namespace

bool RequestStream::wait(short events, int milliseconds) const {
  auto const end = Clock::now() + std::chrono::milliseconds(milliseconds);
  while (!is_stopping_) {
    int const left = left_until(end);
    if (left <= 0) return false;
    pollfd entry{.fd = socket_, .events = events, .revents = 0};
    int const ready = poll(&entry, 1, std::min(left, slice));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
  return false;
}

bool RequestStream::wait_for_bytes(Clock::time_point begin, int max_milliseconds) const {
  while (!is_stopping_) {
    auto const waited = std::chrono::duration_cast<milliseconds>(Clock::now() - begin).count();
    if (waited >= max_milliseconds || (waited >= limits_.crowded_milliseconds && should_hurry_())) return false;
    if (wait(POLLIN, slice)) return true;
  }
  return false;
}

RequestStream::Head RequestStream::read_head() {
  received_.erase(0, end_);
  at_ = end_ = 0;
  if (received_.empty() && !wait_for_bytes(Clock::now(), limits_.idle_milliseconds)) return Head::none;
  auto const begin = Clock::now();
  for (std::size_t searched = 0;;) {
    std::size_t const found = received_.find("\r\n\r\n", searched);
    if (found != std::string::npos && found <= limits_.max_head_bytes) {
      end_ = found + 4;
      return kind_of(std::string_view(received_).substr(0, end_));
    }
    if (received_.size() > limits_.max_head_bytes) return Head::too_large;
    searched = received_.size() < 3 ? 0 : received_.size() - 3;
    if (!wait_for_bytes(begin, limits_.head_milliseconds)) return is_stopping_ ? Head::none : Head::too_slow;
    char bytes[4096];
    ssize_t const count = recv(socket_, bytes, sizeof(bytes), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return Head::none;
    if (count > 0) received_.append(bytes, static_cast<std::size_t>(count));
  }
}

void RequestStream::refuse(int status, char const* reason, char const* text) {
  std::string const answer = fmt::format(
      "HTTP/1.1 {} {}\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\r\n{}",
      status, reason, std::string_view(text).size(), text);
  write(answer.data(), answer.size());
}

void RequestStream::close() {
  // Closing a connection with unread bytes would reset it, and the client would lose the answer.
  shutdown(socket_, SHUT_WR);
  constexpr int max_milliseconds = 500;
  auto const end = Clock::now() + milliseconds(max_milliseconds);
  char bytes[4096];
  while (left_until(end) > 0 && !should_hurry_() && wait(POLLIN, slice)) {
    ssize_t const count = recv(socket_, bytes, sizeof(bytes), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) break;
  }
  ::close(socket_);
}

bool RequestStream::is_writable() const { return wait(POLLOUT, limits_.write_milliseconds); }

ssize_t RequestStream::read(char* bytes, size_t size) {
  std::size_t const count = std::min(size, end_ - at_);
  std::copy_n(received_.data() + at_, count, bytes);
  at_ += count;
  return static_cast<ssize_t>(count);
}

ssize_t RequestStream::write(char const* bytes, size_t size) {
  std::size_t written = 0;
  while (written < size) {
    if (!wait(POLLOUT, limits_.write_milliseconds)) return -1;
    ssize_t const count = send(socket_, bytes + written, size - written, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count < 0 && errno != EAGAIN && errno != EINTR) return -1;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  return static_cast<ssize_t>(size);
}

// Both ends are on this machine; these functions are required by the interface, and their results are not used.
void RequestStream::get_remote_ip_and_port(std::string& address, int& port) const {
  address = "127.0.0.1";
  port = 0;
}

void RequestStream::get_local_ip_and_port(std::string& address, int& port) const {
  address = "127.0.0.1";
  port = 0;
}

}  // namespace gridlock::view
