#include "server/cache/impostor_bytes.h"

namespace standin {
namespace {

// Structs of numbers of one size: no padding, so that equal impostors have equal bytes.
static_assert(sizeof(Layer) == 3 * sizeof(double) && sizeof(Quad) == 5 * sizeof(std::uint32_t) &&
              sizeof(ImpostorVertex) == 5 * sizeof(double) && sizeof(Chart) == 6 * sizeof(std::uint32_t));

void write(const ImpostorFrame& frame, ByteWriter& bytes) {
  for (const Vec3* vector : {&frame.reference_viewpoint, &frame.forward, &frame.right, &frame.up}) bytes.value(*vector);
  bytes.value(frame.slope_min);
  bytes.value(frame.slope_step);
  bytes.value(frame.width);
  bytes.value(frame.height);
}

ImpostorFrame read_frame(ByteReader& bytes) {
  ImpostorFrame frame;
  for (Vec3* vector : {&frame.reference_viewpoint, &frame.forward, &frame.right, &frame.up}) *vector = bytes.value<Vec3>();
  frame.slope_min = bytes.value<Vec2>();
  frame.slope_step = bytes.value<Vec2>();
  frame.width = bytes.value<std::uint32_t>();
  frame.height = bytes.value<std::uint32_t>();
  return frame;
}

}  // namespace

std::string bytes_of(const std::optional<Impostor>& impostor) {
  ByteWriter bytes;
  bytes.value(static_cast<std::uint8_t>(impostor ? 1 : 0));
  if (!impostor) return bytes.bytes();
  write(impostor->frame, bytes);
  bytes.list(impostor->layers);
  bytes.list(impostor->quads);
  bytes.list(impostor->texels);
  bytes.list(impostor->mesh.charts);
  bytes.list(impostor->mesh.vertices);
  bytes.list(impostor->mesh.indices);
  bytes.value(impostor->technique);
  bytes.value(static_cast<std::uint8_t>(impostor->fuzzy ? 1 : 0));
  return bytes.bytes();
}

std::optional<Impostor> read_impostor(ByteReader& bytes) {
  if (bytes.value<std::uint8_t>() == 0) return std::nullopt;
  Impostor impostor;
  impostor.frame = read_frame(bytes);
  impostor.layers = bytes.list<Layer>();
  impostor.quads = bytes.list<Quad>();
  impostor.texels = bytes.list<std::uint8_t>();
  impostor.mesh.charts = bytes.list<Chart>();
  impostor.mesh.vertices = bytes.list<ImpostorVertex>();
  impostor.mesh.indices = bytes.list<std::uint32_t>();
  impostor.technique = bytes.value<Technique>();
  impostor.fuzzy = bytes.value<std::uint8_t>() != 0;
  return impostor;
}

}  // namespace standin
