#include "render/image/image_io.h"

#include <dlfcn.h>

#include <array>

#include "render/base/error.h"
#include "render/image/image_codec.h"

namespace standin {
namespace {

namespace fs = std::filesystem;

// Beside the program, where an installation puts it, and in the build tree.
std::array<fs::path, 3> module_places() {
  std::error_code ignored;
  const fs::path here = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  return {here / kImageModule, here.parent_path() / "lib" / "standin" / kImageModule, fs::path(STANDIN_MODULE_FOLDER) / kImageModule};
}

const ImageCodec* open_codec() {
  std::string tried;
  for (const fs::path& place : module_places()) {
    std::error_code ignored;
    if (!fs::exists(place, ignored)) {
      tried += " " + place.string();
      continue;
    }
    void* module = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) throw Failure(ErrorWord::kInternal, std::string("the image module does not load: ") + dlerror());
    using Entry = const ImageCodec* (*)();
    const auto entry = reinterpret_cast<Entry>(dlsym(module, kImageCodecSymbol));
    if (entry == nullptr) throw Failure(ErrorWord::kInternal, place.string() + " exports no " + kImageCodecSymbol);
    return entry();
  }
  throw Failure(ErrorWord::kInternal, std::string("the image module ") + kImageModule + " is missing; looked for" + tried);
}

// Opened once, never closed: OpenImageIO keeps threads and caches until the process ends.
const ImageCodec& codec() {
  static const ImageCodec* const kLoaded = open_codec();
  return *kLoaded;
}

void check(const std::string& wrong, const std::string& name) {
  if (!wrong.empty()) throw Failure(ErrorWord::kFileBroken, "image " + name + " " + wrong);
}

void check_whole(const Texture& image) {
  const auto expected = static_cast<std::int64_t>(image.width) * image.height * 4;
  if (image.width > 0 && image.height > 0 && static_cast<std::int64_t>(image.rgba.size()) == expected) return;
  throw Failure(ErrorWord::kInternal, "texture " + image.name + " of " + std::to_string(image.width) + " x " +
                                          std::to_string(image.height) + " holds " + std::to_string(image.rgba.size()) + " bytes");
}

}  // namespace

Texture read_image(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) throw Failure(ErrorWord::kFileMissing, "image " + file.string() + " is not a file");
  Texture image;
  image.name = file.filename().string();
  check(codec().read(file.string(), image), file.string());
  return image;
}

Texture decode_image(std::span<const std::uint8_t> bytes, const std::string& name) {
  if (bytes.empty()) throw Failure(ErrorWord::kFileBroken, "image " + name + " has no bytes");
  Texture image;
  image.name = name;
  check(codec().decode(bytes.data(), bytes.size(), image), name);
  return image;
}

std::string encode_png(const Texture& image) {
  check_whole(image);
  std::string png;
  check(codec().encode_png(image, png), image.name);
  return png;
}

}  // namespace standin
