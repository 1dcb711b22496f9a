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
    ErrorRow{ErrorWord::kInternal, "internal", 3, 500},
};

}  // namespace

const ErrorRow& error_row(ErrorWord word) {
  for (const auto& row : kRows)
    if (row.word == word) return row;
  return kRows.back();
}

}  // namespace standin
