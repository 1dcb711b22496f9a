#include "server/cache/simplified_cache.h"

#include <string>
#include <utility>

#include "server/cache/object_content.h"

namespace standin {
namespace {

// Of a form but for its triangles.
template <class Bytes, class Form>
void pass_errors(Bytes& bytes, Form& form) {
  bytes.pass(form.error_m);
  bytes.pass(form.error_found_m);
  bytes.pass(form.pieces);
}

std::string bytes_of(const std::vector<SimplifiedMesh>& forms) {
  ByteWriter bytes;
  bytes.value(std::uint64_t{forms.size()});
  for (const SimplifiedMesh& form : forms) {
    pass_errors(bytes, form);
    bytes.list(form.mesh.source);
    bytes.list(form.mesh.indices);
  }
  return bytes.bytes();
}

void require_below(const std::vector<std::uint32_t>& numbers, std::size_t count, const char* what) {
  for (const std::uint32_t number : numbers)
    if (number >= count) throw Failure(ErrorWord::kFileBroken, std::string("no ") + what + " " + std::to_string(number));
}

SimplifiedMesh read_form(ByteReader& bytes, const Mesh& mesh) {
  SimplifiedMesh form;
  pass_errors(bytes, form);
  auto source = bytes.list<std::uint32_t>();
  auto indices = bytes.list<std::uint32_t>();
  require_below(source, mesh.positions.size(), "vertex of the mesh");
  require_below(indices, source.size(), "vertex of the form");
  if (indices.size() % 3 != 0) throw Failure(ErrorWord::kFileBroken, std::to_string(indices.size()) + " corners are no triangles");
  form.mesh = mesh_of_vertices(mesh, std::move(source), std::move(indices));
  return form;
}

std::vector<SimplifiedMesh> read_forms(ByteReader& bytes, const Mesh& mesh) {
  std::vector<SimplifiedMesh> forms;
  const auto count = bytes.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) forms.push_back(read_form(bytes, mesh));
  return forms;
}

std::vector<SimplifiedMesh> recall_or_simplify(StageCache& cache, const Mesh& mesh, const SimplifyOptions& options) {
  if (!may_be_simplified(mesh)) return {};
  const Fingerprint inputs = simplified_inputs(mesh, options);
  if (auto known = cache.recall(kSimplifiedMeshes, inputs, [&](ByteReader& bytes) { return read_forms(bytes, mesh); }))
    return *std::move(known);
  std::vector<SimplifiedMesh> forms = simplified(mesh, options);
  cache.keep(kSimplifiedMeshes, inputs, bytes_of(forms));
  return forms;
}

}  // namespace

Fingerprint simplified_inputs(const Mesh& mesh, const SimplifyOptions& options) {
  const auto& [textured, lock_border, measure, least_saving, pieces_per_triangle, budget] = options;  // a new one must be added below
  static_cast<void>(budget);
  Fingerprinter to;
  to.add(mesh_content(mesh)).add(textured).add(lock_border).add(measure).add(least_saving).add(pieces_per_triangle);
  return to.fingerprint();
}

Simplify simplified_through(StageCache* cache) {
  if (cache == nullptr) return simplified;
  return [cache](const Mesh& mesh, const SimplifyOptions& options) { return recall_or_simplify(*cache, mesh, options); };
}

}  // namespace standin
