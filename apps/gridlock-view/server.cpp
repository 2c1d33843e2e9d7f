#include "server.hpp"

#include <sys/socket.h>

#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include "request_stream.hpp"

namespace gridlock::view {

namespace {

using Head = RequestStream::Head;

/// Maximum number of connections that the system holds until they are accepted.
constexpr int backlog = 1024;

/// A thread pool that counts the connections waiting for a thread.
class CountedQueue final : public httplib::ThreadPool {
 public:
  CountedQueue(std::size_t threads, std::atomic<std::size_t>& waiting) : ThreadPool(threads), waiting_(waiting) {}

  void enqueue(std::function<void()> work) override {
    ++waiting_;
    ThreadPool::enqueue([this, work = std::move(work)] {
      --waiting_;
      work();
    });
  }

 private:
  std::atomic<std::size_t>& waiting_;
};

/// Allows another server to take the port soon after this one ends. httplib's default would also let another program
/// share the port at the same time.
void choose_socket_options(socket_t socket) {
  int const yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
}

/// Answers an invalid request without httplib. Returns whether the request was invalid.
bool refuse(RequestStream& stream, Head head) {
  switch (head) {
    case Head::too_large:
      stream.refuse(431, "Request Header Fields Too Large", "the request is too large\n");
      return true;
    case Head::too_slow:
      stream.refuse(408, "Request Timeout", "the request did not arrive in time\n");
      return true;
    case Head::bad_range:
      stream.refuse(400, "Bad Request", "the range is too long\n");
      return true;
    case Head::none:
      return true;
    default:
      return false;
  }
}

}  // namespace

Server::Server(Answer answer, ConnectionLimits const& limits) : limits_(limits) {
  new_task_queue = [this] { return new CountedQueue(limits_.threads, waiting_); };
  set_socket_options(choose_socket_options);
  set_tcp_nodelay(true);
  set_keep_alive_max_count(1'000'000);
  // The handler runs before httplib's own routing, so that it receives every method and path.
  set_pre_routing_handler([answer = std::move(answer)](httplib::Request const& request, httplib::Response& response) {
    answer(request, response);
    return HandlerResponse::Handled;
  });
}

int Server::bind(int port) {
  constexpr char const* loopback = "127.0.0.1";
  errno = 0;
  int const bound = port == 0 ? bind_to_any_port(loopback) : bind_to_port(loopback, port) ? port : 0;
  if (bound <= 0) return 0;
  ::listen(svr_sock_, backlog);
  return bound;
}

void Server::serve() { listen_after_bind(); }

void Server::stop() {
  is_stopping_ = true;
  // httplib ignores a stop before it listens, and serve() may be about to listen.
  while (!is_running() && svr_sock_ != INVALID_SOCKET) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  httplib::Server::stop();
}

bool Server::process_and_close_socket(socket_t socket) {
  RequestStream stream(socket, limits_, is_stopping_, [this] { return waiting_ > 0; });
  for (bool is_last = false; !is_last && !is_stopping_;) {
    Head const head = stream.read_head();
    if (refuse(stream, head)) break;
    is_last = head == Head::whole_and_last;
    bool is_closed = false;
    bool const is_good =
        process_request(stream, is_last, is_closed, [](httplib::Request& request) { request.ranges.clear(); });
    if (!is_good || is_closed) break;
  }
  stream.close();
  return true;
}

}  // namespace gridlock::view
