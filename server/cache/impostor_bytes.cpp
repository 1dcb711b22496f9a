#include "server/cache/impostor_bytes.h"

namespace standin {
namespace {

// Structs of numbers of one size: no padding, so that equal impostors have equal bytes.
static_assert(sizeof(Layer) == 3 * sizeof(double) && sizeof(Quad) == 5 * sizeof(std::uint32_t) &&
              sizeof(ImpostorVertex) == 5 * sizeof(double) && sizeof(Chart) == 6 * sizeof(std::uint32_t));

template <class Bytes, class Frame>
void pass_frame(Bytes& bytes, Frame& frame) {
  bytes.pass(frame.reference_viewpoint);
  bytes.pass(frame.forward);
  bytes.pass(frame.right);
  bytes.pass(frame.up);
  bytes.pass(frame.slope_min);
  bytes.pass(frame.slope_step);
  bytes.pass(frame.width);
  bytes.pass(frame.height);
}

template <class Bytes, class AnyImpostor>
void pass_impostor(Bytes& bytes, AnyImpostor& impostor) {
  pass_frame(bytes, impostor.frame);
  bytes.pass(impostor.layers);
  bytes.pass(impostor.quads);
  bytes.pass(impostor.texels);
  bytes.pass(impostor.mesh.charts);
  bytes.pass(impostor.mesh.vertices);
  bytes.pass(impostor.mesh.indices);
  bytes.pass(impostor.technique);
  bytes.pass(impostor.fuzzy);
}

}  // namespace

std::string bytes_of(const std::optional<Impostor>& impostor) {
  ByteWriter bytes;
  bytes.pass(impostor.has_value());
  if (impostor) pass_impostor(bytes, *impostor);
  return bytes.bytes();
}

std::optional<Impostor> read_impostor(ByteReader& bytes) {
  bool is_possible = false;
  bytes.pass(is_possible);
  if (!is_possible) return std::nullopt;
  Impostor impostor;
  pass_impostor(bytes, impostor);
  return impostor;
}

}  // namespace standin
