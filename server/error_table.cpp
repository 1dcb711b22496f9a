#include "server/error_table.h"

#include <array>

namespace standin {
namespace {

constexpr std::array kRows = {
    ErrorRow{ErrorWord::kBadUsage, "bad_usage", 2, 422},
    ErrorRow{ErrorWord::kBadConfig, "bad_config", 2, 422},
    ErrorRow{ErrorWord::kFileMissing, "file_missing", 2, 404},
    ErrorRow{ErrorWord::kFileBroken, "file_broken", 2, 422},
    ErrorRow{ErrorWord::kUriForbidden, "uri_forbidden", 2, 422},
    ErrorRow{ErrorWord::kExtensionUnknown, "extension_unknown", 2, 422},
    ErrorRow{ErrorWord::kSceneEmpty, "scene_empty", 2, 422},
    ErrorRow{ErrorWord::kViewSpaceEmpty, "view_space_empty", 2, 422},
    ErrorRow{ErrorWord::kTargetUnreadable, "target_unreadable", 2, 422},
    ErrorRow{ErrorWord::kOutputOccupied, "output_occupied", 2, 409},
    ErrorRow{ErrorWord::kDeviceUnavailable, "device_unavailable", 3, 503},
    ErrorRow{ErrorWord::kImpostorImpossible, "impostor_impossible", 2, 422},
    ErrorRow{ErrorWord::kCancelled, "cancelled", 3, 499},
    ErrorRow{ErrorWord::kBadRequest, "bad_request", 2, 400},
    ErrorRow{ErrorWord::kUnauthorized, "unauthorized", 2, 401},
    ErrorRow{ErrorWord::kForbidden, "forbidden", 2, 403},
    ErrorRow{ErrorWord::kNotFound, "not_found", 2, 404},
    ErrorRow{ErrorWord::kMethodNotAllowed, "method_not_allowed", 2, 405},
    ErrorRow{ErrorWord::kNotFinished, "not_finished", 2, 409},
    ErrorRow{ErrorWord::kKeyReused, "key_reused", 2, 422},
    ErrorRow{ErrorWord::kTooLarge, "too_large", 2, 413},
    ErrorRow{ErrorWord::kMediaUnsupported, "media_unsupported", 2, 415},
    ErrorRow{ErrorWord::kRangeUnsatisfiable, "range_unsatisfiable", 2, 416},
    ErrorRow{ErrorWord::kQueueFull, "queue_full", 3, 429},
    ErrorRow{ErrorWord::kBusy, "busy", 3, 503},
    ErrorRow{ErrorWord::kDiskFull, "disk_full", 3, 507},
    ErrorRow{ErrorWord::kQuotaFull, "quota_full", 2, 507},
    ErrorRow{ErrorWord::kDeadlinePassed, "deadline_passed", 3, 504},
    ErrorRow{ErrorWord::kWorkerLost, "worker_lost", 3, 500},
    ErrorRow{ErrorWord::kServerUnreachable, "server_unreachable", 3, 502},
    ErrorRow{ErrorWord::kInternal, "internal", 3, 500},
};

}  // namespace

const ErrorRow& error_row(ErrorWord word) {
  for (const auto& row : kRows)
    if (row.word == word) return row;
  return kRows.back();
}

ErrorWord word_named(std::string_view name) {
  for (const auto& row : kRows)
    if (row.name == name) return row.word;
  return ErrorWord::kInternal;
}

}  // namespace standin
