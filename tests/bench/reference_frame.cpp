// What normalising by an interleaved reference frame is worth: one fixed frame, timed again and again while the other processor is kept
// busy, with and without. Results: time_model.md.
//
//   reference_frame [SECONDS]
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <thread>

#include "render/device/context.h"
#include "render/device/frame_timer.h"
#include "render/scene/city.h"

namespace {

using namespace standin;

/// Streams through memory, as a neighbour that builds or sorts does.
void keep_busy(const std::atomic<bool>& stop) {
  std::vector<double> memory(8 << 20, 1.0);
  for (volatile double sink = 0.0; !stop;) sink = std::accumulate(memory.begin(), memory.end(), sink * 1e-9);
}

void print(const char* name, std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  const double n = static_cast<double>(times_ms.size());
  const double mean = std::accumulate(times_ms.begin(), times_ms.end(), 0.0) / n;
  const double variance =
      std::accumulate(times_ms.begin(), times_ms.end(), 0.0, [&](double sum, double t) { return sum + (t - mean) * (t - mean); }) / n;
  const auto at = [&](double share) { return times_ms[static_cast<std::size_t>(share * (n - 1.0))]; };
  std::printf("| %s | %zu | %.2f ms | %.1f %% | %.1f %% | %.2f |\n", name, times_ms.size(), at(0.5), 100.0 * std::sqrt(variance) / mean,
              100.0 * (at(0.9) - at(0.1)) / at(0.5), times_ms.back() / times_ms.front());
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 600.0;
  const Scene scene = make_city({300, 500'000, 101});
  const Camera camera;
  const auto context = make_context(DeviceKind::kOsMesa, camera.width, camera.height);
  const auto timer = make_frame_timer(*context, {.repeats = 3});
  Renderer renderer(*context, scene, camera);
  DrawList everything;
  everything.objects.resize(scene.objects.size());
  std::iota(everything.objects.begin(), everything.objects.end(), 0U);
  const View view{Vec3(scene.bounds.centre().x, 1.7, scene.bounds.centre().z), glm::normalize(Vec3(1.0, 0.0, 0.3))};
  std::atomic<bool> stop = false;
  std::thread neighbour([&] { keep_busy(stop); });
  std::vector<double> least_ms, normalised_ms;
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    const FrameSample sample = timer->time(renderer, view, everything);
    least_ms.push_back(sample.raw_milliseconds);
    normalised_ms.push_back(sample.milliseconds);
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  stop = true;
  neighbour.join();
  std::printf("| a fixed frame, %.0f s | timed | median | coefficient of variation | p10 to p90 | max / min |\n|---|---|---|---|---|---|\n",
              seconds);
  print("least of 3 repeats, as measured", least_ms);
  print("normalised by the reference frame", normalised_ms);
}
