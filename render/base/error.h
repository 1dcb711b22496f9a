// Errors with a stable word.
//
// Library code never exits and never prints: it throws a Failure that carries one word of the list below and a sentence
// that names the value, the place and the violated constraint. server/error_table.h maps each word to an exit code
// and an HTTP status; tests check the word, so that the right guard is known to have fired.
#pragma once

#include <stdexcept>
#include <string>

namespace standin {

enum class ErrorWord {
  kBadUsage,            // command line or parameter value out of its range
  kBadConfig,           // unknown key, wrong type or value in a configuration file
  kFileMissing,         // a named file or folder does not exist or cannot be read
  kFileBroken,          // truncated, malformed or inconsistent content
  kUriForbidden,        // a URI that leaves the scene's folder
  kExtensionUnknown,    // a required extension that is not read
  kSceneEmpty,          // nothing drawable is left
  kViewSpaceEmpty,      // no position to stand at
  kTargetUnreadable,    // target file of another format or version
  kOutputOccupied,      // the output folder holds another job
  kDeviceUnavailable,   // no context, or another device than the one asked for
  kImpostorImpossible,  // cluster and view cell allow no impostor
  kCancelled,           // stopped by the user
  // Of the service.
  kBadRequest,          // not HTTP, JSON or a query that can be understood
  kUnauthorized,        // no token, or an unknown one
  kForbidden,           // another origin's page, or a name that is not this server's
  kNotFound,            // no such route, job, upload or artifact, or not the caller's
  kMethodNotAllowed,    // the route knows other methods
  kNotFinished,         // asks of a job what only a finished one has, or allows
  kKeyReused,           // an Idempotency-Key that came with another body
  kTooLarge,            // a body, or a scene, above a limit
  kMediaUnsupported,    // a body of a type that the route does not take
  kRangeUnsatisfiable,  // a byte range beyond the end
  kQueueFull,           // as many jobs wait as may
  kBusy,                // as many event streams or uploads are open as may
  kDiskFull,            // the quota of the data folder
  kQuotaFull,           // an owner's part of it
  kDeadlinePassed,      // a job took longer than it may
  kWorkerLost,          // a worker process ended without a word
  kServerUnreachable,   // seen by a client
  kInternal,
};

class Failure : public std::runtime_error {
 public:
  Failure(ErrorWord word, const std::string& sentence) : std::runtime_error(sentence), word_(word) {}
  [[nodiscard]] ErrorWord word() const { return word_; }

 private:
  ErrorWord word_;
};

}  // namespace standin
