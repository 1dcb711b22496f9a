// Points of a curve, made by hand.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "render/base/error.h"
#include "server/sweep/curve.h"

namespace standin::test {

inline CurvePoint point(double budget_ms, std::uint64_t texture_bytes, std::uint64_t unsolved = 0) {
  CurvePoint made;
  made.budget_ms = budget_ms;
  made.cpvs = 100;
  made.unsolved = unsolved;
  made.impostors = 7;
  made.texture_bytes = texture_bytes;
  made.geometry_bytes = texture_bytes / 10;
  made.lower_bound_bytes = 0.25 * static_cast<double>(texture_bytes);
  return made;
}

/// What sweep.json holds of these points.
inline nlohmann::json sweep_json(const std::vector<CurvePoint>& points) {
  nlohmann::json object = to_json(CurveSubject{"city.glb", "llvmpipe", 45.0, 512, 384});
  object["points"] = nlohmann::json::array();
  for (const CurvePoint& one : points) object["points"].push_back(to_json(one));
  return object;
}

/// The failure that `run` throws.
inline Failure failure_of(const std::function<void()>& run) {
  try {
    run();
  } catch (const Failure& failure) {
    return failure;
  }
  ADD_FAILURE() << "nothing was thrown";
  return {ErrorWord::kInternal, ""};
}

}  // namespace standin::test
