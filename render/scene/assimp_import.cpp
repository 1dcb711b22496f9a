// Every format but glTF, through Assimp: OBJ, PLY, STL, AC3D, FBX, Collada ...
//
// Assimp opens files through a file system of ours that ends at the scene's folder. Textures are looked up as named, then by their file
// name beside the scene and in LoadOptions::texture_folders: authors' absolute paths are common and their folders are not here.

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>
#include <assimp/commonMetaData.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "render/base/error.h"
#include "render/image/image_io.h"
#include "render/scene/ac3d.h"
#include "render/scene/import.h"

namespace standin {
namespace {

namespace fs = std::filesystem;
using Kind = LoadNote::Kind;

// Beyond this many units from the origin a float is coarser than a thousandth of a unit.
constexpr double kCoarse = 16384.0;

class ConfinedFiles : public Assimp::DefaultIOSystem {
 public:
  explicit ConfinedFiles(const SceneFolder& folder) : folder_(folder) {}

  bool Exists(const char* file) const override { return inside(file) && DefaultIOSystem::Exists(file); }
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    if (std::string_view(mode).find_first_of("wa+") != std::string_view::npos) return nullptr;
    if (inside(file)) return fs::path(file).extension() == ".acc" ? open_ac3d(file) : DefaultIOSystem::Open(file, mode);
    if (forbidden_.empty()) forbidden_ = file;
    return nullptr;
  }
  /// The first file outside the folder that a scene asked for, or "".
  [[nodiscard]] const std::string& forbidden() const { return forbidden_; }

 private:
  static Assimp::IOStream* open_ac3d(const char* file) {
    const std::vector<std::uint8_t> bytes = read_bytes(file);
    const std::string text = with_base_textures_only({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    auto* copy = new std::uint8_t[text.size()];
    std::copy(text.begin(), text.end(), copy);
    return new Assimp::MemoryIOStream(copy, text.size(), true);  // owns the copy; Close() deletes the stream
  }

  [[nodiscard]] bool inside(const char* file) const {
    std::error_code unknown;
    const fs::path relative = fs::weakly_canonical(fs::absolute(file), unknown).lexically_relative(folder_.path());
    return !unknown && !relative.empty() && *relative.begin() != "..";
  }

  SceneFolder folder_;
  std::string forbidden_;
};

Mat4 to_matrix(const aiMatrix4x4& m) {
  return glm::transpose(Mat4(m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2, m.d3, m.d4));
}

glm::vec3 to_vector(const aiVector3D& v) {
  return {v.x, v.y, v.z};
}

// Formats store a vertex per corner; one per distinct vertex is a third of the work.
void weld(Mesh& mesh) {
  std::vector<meshopt_Stream> streams{{mesh.positions.data(), sizeof(glm::vec3), sizeof(glm::vec3)},
                                      {mesh.normals.data(), sizeof(glm::vec3), sizeof(glm::vec3)}};
  if (!mesh.uvs.empty()) streams.push_back({mesh.uvs.data(), sizeof(glm::vec2), sizeof(glm::vec2)});
  const std::size_t before = mesh.positions.size();
  std::vector<unsigned int> remap(before);
  const std::size_t after =
      meshopt_generateVertexRemapMulti(remap.data(), mesh.indices.data(), mesh.indices.size(), before, streams.data(), streams.size());
  if (after == before) return;
  meshopt_remapIndexBuffer(mesh.indices.data(), mesh.indices.data(), mesh.indices.size(), remap.data());
  const auto compact = [&](auto& values) {
    if (values.empty()) return;
    meshopt_remapVertexBuffer(values.data(), values.data(), before, sizeof(values[0]), remap.data());
    values.resize(after);
  };
  compact(mesh.positions);
  compact(mesh.normals);
  compact(mesh.uvs);
}

// Assimp takes a face without corners for a polygon, and its triangulation ends the process where no face is one: it is told to let such
// meshes be.
void take_empty_faces_for_nothing(const aiScene& scene) {
  for (aiMesh* mesh : std::span(scene.mMeshes, scene.mNumMeshes)) {
    const std::span faces(mesh->mFaces, mesh->mNumFaces);
    const bool polygons = std::ranges::any_of(faces, [](const aiFace& face) { return face.mNumIndices > 3; });
    if (!polygons) mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
  }
}

class AssimpReader {
 public:
  explicit AssimpReader(Import& import) : import_(import), scene_(import.scene) {}

  void read(const fs::path& file) {
    auto* files = new ConfinedFiles(import_.folder);
    importer_.SetIOHandler(files);  // takes ownership
    from_ = importer_.ReadFile(fs::absolute(file).string(), 0);
    if (from_ != nullptr) {
      take_empty_faces_for_nothing(*from_);
      from_ = importer_.ApplyPostProcessing(aiProcess_Triangulate);
    }
    if (!files->forbidden().empty()) {
      throw Failure(ErrorWord::kUriForbidden, "the reference to " + files->forbidden() + " leads out of " + import_.folder.path().string());
    }
    if (from_ == nullptr || from_->mRootNode == nullptr) {
      throw Failure(ErrorWord::kFileBroken, file.string() + " cannot be read: " + importer_.GetErrorString());
    }
    read_statement();
    walk();
    note_precision();
  }

 private:
  struct PartRange {
    std::uint32_t first = 0;
    std::uint32_t count = 0;
  };

  // Assimp turns FBX and Collada scenes to y up by a transform on the root, Collada's also to metres; FBX states centimetres per unit.
  void read_statement() {
    aiString format;
    if (from_->mMetaData == nullptr || !from_->mMetaData->Get(AI_METADATA_SOURCE_FORMAT, format)) return;
    const std::string name = format.C_Str();
    const bool collada = name.find("Collada") != std::string::npos;
    const bool fbx = name.find("FBX") != std::string::npos || name.find("Autodesk") != std::string::npos;
    if (!collada && !fbx) return;
    import_.statement = {UpAxis::kY, collada ? 1.0 : 0.0, "the file (" + name + ")"};
    if (fbx) import_.statement.metres_per_unit = 0.01 * metadata_number("UnitScaleFactor");
  }

  [[nodiscard]] double metadata_number(const char* key) const {
    double number = 0.0;
    float single = 0.0F;
    if (from_->mMetaData->Get(key, number)) return number;
    return from_->mMetaData->Get(key, single) ? static_cast<double>(single) : 0.0;
  }

  void walk() {
    std::vector<std::pair<const aiNode*, Mat4>> stack{{from_->mRootNode, Mat4(1.0)}};
    while (!stack.empty()) {
      const auto [node, file_from_parent] = stack.back();
      stack.pop_back();
      const Mat4 file_from_node = file_from_parent * to_matrix(node->mTransformation);
      add_object(*node, file_from_node);
      for (unsigned int i = node->mNumChildren; i-- > 0;) stack.emplace_back(node->mChildren[i], file_from_node);
    }
  }

  void add_object(const aiNode& node, const Mat4& file_from_node) {
    const PartRange range = parts_of({node.mMeshes, node.mMeshes + node.mNumMeshes});
    if (range.count == 0) return;
    Object object;
    object.name = node.mName.length > 0 ? node.mName.C_Str() : "object_" + std::to_string(scene_.objects.size());
    object.world_from_object = file_from_node;
    object.first_part = range.first;
    object.part_count = range.count;
    scene_.objects.push_back(std::move(object));
  }

  PartRange parts_of(const std::vector<unsigned int>& meshes) {
    const auto [known, fresh] = part_ranges_.try_emplace(meshes);
    if (!fresh) return known->second;
    PartRange range{static_cast<std::uint32_t>(scene_.parts.size()), 0};
    for (const unsigned int index : meshes) {
      if (const auto mesh = mesh_of(index)) scene_.parts.push_back({*mesh, material_of(from_->mMeshes[index]->mMaterialIndex)});
    }
    range.count = static_cast<std::uint32_t>(scene_.parts.size()) - range.first;
    known->second = range;
    return range;
  }

  std::optional<std::uint32_t> mesh_of(unsigned int index) {
    const auto [known, fresh] = meshes_.try_emplace(index);
    if (!fresh) return known->second;
    Mesh mesh = converted(*from_->mMeshes[index]);
    const bool shared_vertices = !mesh.normals.empty();  // flat normals are a vertex per corner by design
    if (!clean(mesh, scene_)) return std::nullopt;
    if (shared_vertices) weld(mesh);
    known->second = static_cast<std::uint32_t>(scene_.meshes.size());
    scene_.meshes.push_back(std::move(mesh));
    return known->second;
  }

  Mesh converted(const aiMesh& from) {
    Mesh mesh;
    mesh.name = from.mName.length > 0 ? from.mName.C_Str() : "mesh";
    for (unsigned int v = 0; v < from.mNumVertices; ++v) {
      mesh.positions.push_back(to_vector(from.mVertices[v]));
      if (from.HasNormals()) mesh.normals.push_back(to_vector(from.mNormals[v]));
      if (from.HasTextureCoords(0)) mesh.uvs.emplace_back(from.mTextureCoords[0][v].x, 1.0F - from.mTextureCoords[0][v].y);
    }
    std::uint64_t thin = 0;
    for (unsigned int f = 0; f < from.mNumFaces; ++f) {
      const aiFace& face = from.mFaces[f];
      if (face.mNumIndices == 3) {
        mesh.indices.insert(mesh.indices.end(), face.mIndices, face.mIndices + 3);
      } else {
        ++thin;
      }
    }
    add_note(scene_, Kind::kDropped, "points and lines", thin, "they are not drawn");
    return mesh;
  }

  std::uint32_t material_of(unsigned int index) {
    const auto [known, fresh] = materials_.try_emplace(index, 0);
    if (!fresh) return known->second;
    const aiMaterial& from = *from_->mMaterials[index];
    Material material;
    material.name = from.GetName().length > 0 ? from.GetName().C_Str() : "material_" + std::to_string(index);
    aiColor4D colour(1, 1, 1, 1);
    if (from.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == AI_SUCCESS) material.base_colour = {colour.r, colour.g, colour.b, 1.0F};
    float opacity = 1.0F;
    if (from.Get(AI_MATKEY_OPACITY, opacity) == AI_SUCCESS && opacity < 1.0F) {
      add_note(scene_, Kind::kChosen, "materials", 1, "transparent ones are drawn opaque");
    }
    int shading = aiShadingMode_Gouraud;
    material.unlit = from.Get(AI_MATKEY_SHADING_MODEL, shading) == AI_SUCCESS && shading == aiShadingMode_NoShading;
    read_texture(from, material);
    known->second = index_of(std::move(material));
    return known->second;
  }

  // AC3D and others write a material per surface; each one kept would be a state switch.
  std::uint32_t index_of(Material material) {
    const auto look = [](const Material& m) {
      return std::tuple(m.base_colour.r, m.base_colour.g, m.base_colour.b, m.texture, m.alpha_mode, m.unlit);
    };
    const auto [known, fresh] = looks_.try_emplace(look(material), static_cast<std::uint32_t>(scene_.materials.size()));
    if (fresh) scene_.materials.push_back(std::move(material));
    return known->second;
  }

  void read_texture(const aiMaterial& from, Material& material) {
    aiString name;
    const bool found =
        from.GetTexture(aiTextureType_BASE_COLOR, 0, &name) == AI_SUCCESS || from.GetTexture(aiTextureType_DIFFUSE, 0, &name) == AI_SUCCESS;
    // "ERROR" is what Assimp makes of AC3D's unquoted names (TORCS: no texture).
    if (!found || name.length == 0 || std::string_view(name.C_Str()) == "ERROR") return;
    material.texture = texture_of(name.C_Str());
    if (material.texture < 0) return;
    if (glm::vec3(material.base_colour) == glm::vec3(0.0F)) {
      add_note(scene_, Kind::kRepaired, "materials", 1, "textured and black; drawn with the texture's colours");
      material.base_colour = glm::vec4(1.0F);
    }
    if (!holed_[static_cast<std::size_t>(material.texture)]) return;
    material.alpha_mode = AlphaMode::kMask;
    add_note(scene_, Kind::kChosen, "materials", 1, "the texture has holes; drawn as a mask at alpha 0.5");
  }

  std::int32_t texture_of(const std::string& name) {
    const auto [known, fresh] = textures_.try_emplace(name, -1);
    if (!fresh) return known->second;
    try {
      Texture texture = load_texture(name);
      texture.name = name;
      holed_.push_back(has_holes(texture));
      known->second = add_texture(import_, std::move(texture));
    } catch (const Failure& failure) {
      if (failure.word() != ErrorWord::kFileMissing && failure.word() != ErrorWord::kFileBroken) throw;
      add_note(scene_, Kind::kWarning, "textures", 1, std::string("left out: ") + failure.what());
    }
    return known->second;
  }

  Texture load_texture(const std::string& name) {
    const aiTexture* embedded = from_->GetEmbeddedTexture(name.c_str());
    if (embedded == nullptr) return read_image(texture_file(name));
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(embedded->pcData);
    if (embedded->mHeight == 0) return decode_image({bytes, embedded->mWidth}, name);
    Texture texture{name, static_cast<int>(embedded->mWidth), static_cast<int>(embedded->mHeight), {}};
    for (std::size_t i = 0; i < std::size_t{embedded->mWidth} * embedded->mHeight; ++i) {
      const aiTexel& texel = embedded->pcData[i];
      texture.rgba.insert(texture.rgba.end(), {texel.r, texel.g, texel.b, texel.a});
    }
    return texture;
  }

  // As named inside the folder, else by file name beside the scene or in the given folders.
  [[nodiscard]] fs::path texture_file(const std::string& name) const {
    std::string slashed = name;
    std::replace(slashed.begin(), slashed.end(), '\\', '/');
    const fs::path base = fs::path(slashed).filename();
    std::vector<fs::path> places{import_.folder.path() / base};
    for (const fs::path& folder : import_.options.texture_folders) places.push_back(folder / base);
    try {
      places.insert(places.begin(), import_.folder.resolve_path(slashed));
    } catch (const Failure&) {
      // It points elsewhere: only its file name is of use.
    }
    std::error_code ignored;
    for (const fs::path& place : places) {
      if (fs::is_regular_file(place, ignored)) return place;
    }
    throw Failure(ErrorWord::kFileMissing, name + " is neither beside the scene nor in a texture folder");
  }

  void note_precision() {
    Box bounds;
    for (const Mesh& mesh : scene_.meshes) {
      for (const glm::vec3& position : mesh.positions) bounds.extend(Vec3(position));
    }
    if (bounds.empty()) return;
    const Vec3 farthest = glm::max(glm::abs(bounds.min), glm::abs(bounds.max));
    const double far = std::max({farthest.x, farthest.y, farthest.z});
    if (far > kCoarse)
      add_note(scene_, Kind::kWarning, "coordinates", 1,
               "far from the origin; read as float, a step of " + std::to_string(far * 0x1p-23) + " units");
  }

  Import& import_;
  Scene& scene_;
  Assimp::Importer importer_;
  const aiScene* from_ = nullptr;
  std::map<std::vector<unsigned int>, PartRange> part_ranges_;
  std::map<unsigned int, std::optional<std::uint32_t>> meshes_;
  std::map<unsigned int, std::uint32_t> materials_;
  std::map<std::tuple<float, float, float, std::int32_t, AlphaMode, bool>, std::uint32_t> looks_;
  std::map<std::string, std::int32_t> textures_;
  std::vector<bool> holed_;  // per Scene::textures
};

}  // namespace

void read_by_assimp(Import& import, const fs::path& file) {
  AssimpReader(import).read(file);
}

}  // namespace standin
