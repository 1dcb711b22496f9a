// The pictures of a report: worst views side by side, and the atlases.
#pragma once

#include <vector>

#include "render/impostor/impostor.h"
#include "server/report/report.h"
#include "server/verify/verify.h"

namespace standin {

/// Atlas pages are shrunk to at most 1024 texels a side, so that the page stays a page.
[[nodiscard]] std::vector<ReportPicture> report_pictures(const VerifyResult& verified, const ImpostorSet& set);

}  // namespace standin
