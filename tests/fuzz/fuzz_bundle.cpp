// Archives: whatever they hold, nothing but plain files comes out, and nowhere but in the folder.
#include "server/service/bundle.h"
#include "tests/fuzz/input_file.h"

namespace fs = std::filesystem;

namespace standin::fuzz {
namespace {

constexpr BundleLimits kLimits{.bytes = 1 << 20, .files = 50};

void check_what_came_out() {
  std::uint64_t bytes = 0;
  for (const auto& entry : fs::recursive_directory_iterator(input_folder().path() / "outer")) {
    require(!entry.is_symlink(), "no link comes out");
    require(entry.is_directory() || entry.is_regular_file(), "no device comes out");
    if (entry.is_regular_file()) bytes += entry.file_size();
  }
  require(bytes <= kLimits.bytes + (1 << 17), "no more comes out than may");
  for (const auto& entry : fs::directory_iterator(input_folder().path() / "outer"))
    require(entry.path().filename() == "scene.zip" || entry.path().filename() == "out", "nothing leaves the folder");
}

}  // namespace
}  // namespace standin::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace standin;
  const fs::path outer = fuzz::input_folder().path() / "outer";
  fs::create_directories(outer);
  const auto file = fuzz::input_folder().write("outer/scene.zip", fuzz::view_of(data, size));
  fs::path scene;
  const bool unpacked = fuzz::read_or_refused([&] { scene = unpack_bundle(file, outer / "out", fuzz::kLimits, {}); });
  if (unpacked) fuzz::require(fs::is_regular_file(scene), "the scene is there");
  fuzz::check_what_came_out();
  fs::remove_all(outer);
  return 0;
}
