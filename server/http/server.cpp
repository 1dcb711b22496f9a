#include "server/http/server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cstring>
#include <mutex>
#include <set>

namespace standin {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kStreamBlock = 16 * 1024;
constexpr std::uint64_t kDrained = 1 << 20;  // bodies of refused requests up to here are read, so that the client sees the answer

struct DestroyResponse {
  void operator()(MHD_Response* response) const { MHD_destroy_response(response); }
};
using Response = std::unique_ptr<MHD_Response, DestroyResponse>;

// A connection, as its clients' speed is judged: a request must come in within bounds, whatever trickles.
struct Link {
  int socket = -1;
  Clock::time_point since = Clock::now();  // of the phase
  std::uint64_t received = 0;              // of a body
  enum class Phase { kHead, kBody, kAnswer } phase = Phase::kHead;

  void enter(Phase next) {
    phase = next;
    since = Clock::now();
    received = 0;
  }
};

// One request on its way.
struct Exchange {
  HttpRequest request;
  std::unique_ptr<BodySink> body;
  std::optional<HttpResponse> refusal;  // known before the body's end
  std::uint64_t drained = 0;            // bytes of its body that nobody wanted
  Clock::time_point start = Clock::now();
  int status = 0;
};

MHD_Result keep_query(void* request, MHD_ValueKind, const char* name, const char* value) {
  static_cast<HttpRequest*>(request)->query[name] = value == nullptr ? "" : value;
  return MHD_YES;
}

MHD_Result keep_header(void* request, MHD_ValueKind, const char* name, const char* value) {
  std::string lower = name;
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  static_cast<HttpRequest*>(request)->headers[lower] = value == nullptr ? "" : value;
  return MHD_YES;
}

// What a handler throws is its answer; anything else is ours to be ashamed of.
template <class Handler, class Unexpected>
std::optional<HttpResponse> failure_of(Handler&& handler, Unexpected&& unexpected) {
  try {
    handler();
  } catch (const Failure& failure) {
    return problem_response(failure);
  } catch (const std::exception& error) {
    unexpected(error);
    return problem_response(Failure(ErrorWord::kInternal, "the server failed; its log says why"));
  }
  return std::nullopt;
}

sockaddr_in socket_address(const std::string& address, std::uint16_t port) {
  sockaddr_in socket{};
  socket.sin_family = AF_INET;
  socket.sin_port = htons(port);
  if (inet_pton(AF_INET, address.c_str(), &socket.sin_addr) != 1)
    throw Failure(ErrorWord::kBadUsage, "listen address " + address + " is no IPv4 address");
  return socket;
}

}  // namespace

struct HttpServer::Loop {
  // An event stream; it sleeps (suspended) while there is nothing to send.
  struct Stream {
    Loop* loop = nullptr;
    MHD_Connection* connection = nullptr;
    std::shared_ptr<TextStream> source;
    std::string pending;
    Clock::time_point last_sent = Clock::now();
    std::uint64_t wakes = 0;
    bool asleep = false;
    bool heartbeat = false;
  };

  Loop(HttpApplication& of, const HttpLimits& within) : application(of), limits(within) {}

  HttpApplication& application;
  const HttpLimits limits;
  MHD_Daemon* daemon = nullptr;
  std::mutex mutex;  // of the streams and links
  std::set<Stream*> streams;
  std::set<Link*> links;
  bool closing = false;

  static MHD_Result on_request(void* loop, MHD_Connection* connection, const char* url, const char* method, const char*, const char* data,
                               std::size_t* size, void** state) {
    auto& self = *static_cast<Loop*>(loop);
    if (*state == nullptr) {
      *state = new Exchange;
      return self.begin(*static_cast<Exchange*>(*state), connection, url, method);
    }
    auto& exchange = *static_cast<Exchange*>(*state);
    if (*size == 0) return self.end(exchange, connection);
    self.note_received(connection, *size);
    if (exchange.refusal && (exchange.drained += *size) > kDrained) return MHD_NO;
    if (!exchange.refusal) exchange.refusal = self.failure([&] { exchange.body->write({data, *size}); });
    *size = 0;
    return MHD_YES;
  }

  template <class Handler>
  std::optional<HttpResponse> failure(Handler&& handler) {
    return failure_of(handler, [&](const std::exception& error) { application.unexpected(error.what()); });
  }

  static Link* link_of(MHD_Connection* connection) {
    return static_cast<Link*>(MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context);
  }

  void enter(MHD_Connection* connection, Link::Phase phase) {
    const std::scoped_lock lock(mutex);
    if (Link* link = link_of(connection)) link->enter(phase);
  }

  void note_received(MHD_Connection* connection, std::size_t bytes) {
    const std::scoped_lock lock(mutex);
    if (Link* link = link_of(connection)) link->received += bytes;
  }

  static void on_connection(void* loop, MHD_Connection* connection, void** context, MHD_ConnectionNotificationCode code) {
    auto& self = *static_cast<Loop*>(loop);
    const std::scoped_lock lock(self.mutex);
    if (code == MHD_CONNECTION_NOTIFY_STARTED) {
      auto link = std::make_unique<Link>();
      link->socket = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd;
      self.links.insert(link.get());
      *context = link.release();
    } else {
      const std::unique_ptr<Link> link(static_cast<Link*>(std::exchange(*context, nullptr)));
      self.links.erase(link.get());
    }
  }

  // The loop sees a socket that was shut down as one that its client closed.
  void drop_slow_links() {
    const auto now = Clock::now();
    for (const Link* link : links) {
      const double seconds = std::chrono::duration<double>(now - link->since).count();
      const bool slow_head = link->phase == Link::Phase::kHead && seconds > limits.head_s;
      const bool slow_body = link->phase == Link::Phase::kBody && seconds > limits.head_s &&
                             static_cast<double>(link->received) < limits.least_bytes_per_s * seconds;
      if (slow_head || slow_body) ::shutdown(link->socket, SHUT_RDWR);
    }
  }

  MHD_Result begin(Exchange& exchange, MHD_Connection* connection, const char* url, const char* method) {
    enter(connection, Link::Phase::kBody);
    exchange.request.method = method;
    exchange.request.path = url;
    MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, &keep_query, &exchange.request);
    MHD_get_connection_values(connection, MHD_HEADER_KIND, &keep_header, &exchange.request);
    exchange.refusal = failure([&] { exchange.body = application.begin(exchange.request); });
    if (!exchange.refusal || std::strtoull(exchange.request.header("content-length").c_str(), nullptr, 10) <= kDrained) return MHD_YES;
    return queue(exchange, connection, *exchange.refusal);
  }

  MHD_Result end(Exchange& exchange, MHD_Connection* connection) {
    HttpResponse response;
    if (!exchange.refusal) exchange.refusal = failure([&] { response = application.answer(exchange.request, *exchange.body); });
    return queue(exchange, connection, exchange.refusal ? *exchange.refusal : response);
  }

  MHD_Result queue(Exchange& exchange, MHD_Connection* connection, const HttpResponse& response) {
    enter(connection, Link::Phase::kAnswer);
    exchange.status = response.status;
    const Response made = make(connection, response, exchange);
    if (!made) return MHD_NO;
    for (const auto& [name, value] : response.headers) MHD_add_response_header(made.get(), name.c_str(), value.c_str());
    return MHD_queue_response(connection, static_cast<unsigned>(exchange.status), made.get());
  }

  Response make(MHD_Connection* connection, const HttpResponse& response, Exchange& exchange) {
    if (const auto* text = std::get_if<std::string>(&response.body))
      return Response(MHD_create_response_from_buffer(text->size(), const_cast<char*>(text->data()), MHD_RESPMEM_MUST_COPY));
    if (const auto* file = std::get_if<FileBody>(&response.body)) return make_from(*file, exchange);
    return make_stream(connection, std::get<std::shared_ptr<TextStream>>(response.body));
  }

  static Response make_from(const FileBody& body, Exchange& exchange) {
    const int descriptor = ::open(body.file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor >= 0) return Response(MHD_create_response_from_fd_at_offset64(body.bytes, descriptor, body.begin));
    exchange.status = errno == ENOENT ? 404 : 503;  // removed a moment ago, or no descriptor is left
    return Response(MHD_create_response_from_buffer(0, nullptr, MHD_RESPMEM_PERSISTENT));
  }

  Response make_stream(MHD_Connection* connection, const std::shared_ptr<TextStream>& source) {
    auto* stream = new Stream;
    stream->loop = this;
    stream->connection = connection;
    stream->source = source;
    const std::scoped_lock lock(mutex);
    streams.insert(stream);
    return Response(MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, kStreamBlock, &read_stream, stream, &end_stream));
  }

  // Sleeps only if nobody woke it since it last looked: a change between looking and sleeping is not lost.
  static ssize_t read_stream(void* cls, std::uint64_t, char* buffer, std::size_t most) {
    auto& stream = *static_cast<Stream*>(cls);
    auto& self = *stream.loop;
    for (;;) {
      std::uint64_t wakes = 0;
      {
        const std::scoped_lock lock(self.mutex);
        if (self.closing) return MHD_CONTENT_READER_END_OF_STREAM;
        wakes = stream.wakes;
        if (std::exchange(stream.heartbeat, false) && stream.pending.empty()) stream.pending = stream.source->heartbeat();
      }
      if (stream.pending.empty()) {
        std::optional<std::string> text;
        if (self.failure([&] { text = stream.source->next(); }) || !text) return MHD_CONTENT_READER_END_OF_STREAM;
        stream.pending = std::move(*text);
      }
      const std::scoped_lock lock(self.mutex);
      if (!stream.pending.empty()) {
        const std::size_t size = std::min(most, stream.pending.size());
        std::memcpy(buffer, stream.pending.data(), size);
        stream.pending.erase(0, size);
        stream.last_sent = Clock::now();
        return static_cast<ssize_t>(size);
      }
      if (stream.wakes != wakes || self.closing) continue;
      stream.asleep = true;
      MHD_suspend_connection(stream.connection);
      return 0;
    }
  }

  static void end_stream(void* cls) {
    auto* stream = static_cast<Stream*>(cls);
    {
      const std::scoped_lock lock(stream->loop->mutex);
      stream->loop->streams.erase(stream);
    }
    delete stream;
  }

  // With the mutex held.
  static void wake(Stream& stream) {
    ++stream.wakes;
    if (std::exchange(stream.asleep, false)) MHD_resume_connection(stream.connection);
  }

  static void on_completed(void* loop, MHD_Connection* connection, void** state, MHD_RequestTerminationCode) {
    static_cast<Loop*>(loop)->enter(connection, Link::Phase::kHead);
    const std::unique_ptr<Exchange> exchange(static_cast<Exchange*>(*state));
    *state = nullptr;
    if (!exchange) return;
    const double seconds = std::chrono::duration<double>(Clock::now() - exchange->start).count();
    static_cast<Loop*>(loop)->application.answered(exchange->request, exchange->status, seconds);
  }
};

HttpServer::HttpServer(HttpApplication& application, const std::string& address, std::uint16_t port, const HttpLimits& limits)
    : loop_(std::make_unique<Loop>(application, limits)) {
  const sockaddr_in socket = socket_address(address, port);
  loop_->daemon = MHD_start_daemon(MHD_USE_EPOLL_INTERNAL_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr, nullptr, &Loop::on_request,
                                   loop_.get(), MHD_OPTION_SOCK_ADDR, &socket, MHD_OPTION_CONNECTION_LIMIT, limits.connections,
                                   MHD_OPTION_CONNECTION_TIMEOUT, limits.silent_s, MHD_OPTION_CONNECTION_MEMORY_LIMIT, limits.head_bytes,
                                   MHD_OPTION_NOTIFY_COMPLETED, &Loop::on_completed, loop_.get(), MHD_OPTION_NOTIFY_CONNECTION,
                                   &Loop::on_connection, loop_.get(), MHD_OPTION_LISTENING_ADDRESS_REUSE, 1U, MHD_OPTION_END);
  if (loop_->daemon == nullptr)
    throw Failure(ErrorWord::kInternal, "cannot listen on " + address + ":" + std::to_string(port) + ": " + std::strerror(errno));
}

HttpServer::~HttpServer() {
  {
    const std::scoped_lock lock(loop_->mutex);
    loop_->closing = true;
    for (Loop::Stream* stream : loop_->streams) Loop::wake(*stream);
  }
  MHD_stop_daemon(loop_->daemon);
}

std::uint16_t HttpServer::port() const {
  return MHD_get_daemon_info(loop_->daemon, MHD_DAEMON_INFO_BIND_PORT)->port;
}

void HttpServer::changed(const std::string& subject) {
  const std::scoped_lock lock(loop_->mutex);
  for (Loop::Stream* stream : loop_->streams)
    if (stream->source->subject() == subject) Loop::wake(*stream);
}

void HttpServer::tick() {
  const auto now = Clock::now();
  const std::scoped_lock lock(loop_->mutex);
  loop_->drop_slow_links();
  for (Loop::Stream* stream : loop_->streams) {
    if (std::chrono::duration<double>(now - stream->last_sent).count() < loop_->limits.heartbeat_s) continue;
    stream->heartbeat = true;
    Loop::wake(*stream);
  }
}

}  // namespace standin
