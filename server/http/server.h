// The event loop: libmicrohttpd's, in one thread of its own, and the only file that knows it.
//
// Bodies go to a sink as they come in, files are sent from their descriptor, event streams sleep until their subject changes. A client that
// is slow, silent or gone costs a socket until it times out, and no thread. Handlers must not block.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/http/message.h"

namespace standin {

/// What the loop asks of the application. All calls come from its one thread.
class HttpApplication {
 public:
  virtual ~HttpApplication() = default;
  /// The head of a request is there: where its body is to go. Throws Failure: that is the answer.
  virtual std::unique_ptr<BodySink> begin(HttpRequest& request) = 0;
  /// All of it is there. Throws Failure: that is the answer.
  virtual HttpResponse answer(const HttpRequest& request, BodySink& body) = 0;
  /// What no handler should have thrown: for the log.
  virtual void unexpected(const std::string& what) = 0;
  /// For counting.
  virtual void answered(const HttpRequest& request, int status, double seconds) = 0;
};

struct HttpLimits {
  unsigned connections = 1000;
  unsigned silent_s = 30;              // until a connection on which nothing moves is closed
  double head_s = 30.0;                // until a request's head must be there
  double least_bytes_per_s = 1000.0;   // of a body, on average, once it has been coming for as long
  std::size_t head_bytes = 32 * 1024;  // of a request's line and headers
  double heartbeat_s = 15.0;
};

class HttpServer {
 public:
  /// `port` 0: any that is free. Throws Failure(kBadUsage) for an address that is none, Failure(kInternal) where it cannot be listened on.
  HttpServer(HttpApplication& application, const std::string& address, std::uint16_t port, const HttpLimits& limits);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Wakes the streams of a subject. From any thread.
  void changed(const std::string& subject);
  /// To be called about once a second: streams that were silent for long say that they live.
  void tick();

 private:
  struct Loop;
  std::unique_ptr<Loop> loop_;
};

}  // namespace standin
