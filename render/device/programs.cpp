#include "render/device/programs.h"

#include <string>

#include "render/base/error.h"
#include "render/scene/shading.h"

namespace standin {
namespace {

constexpr const char* kVertexShader = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 0) uniform mat4 clip_from_mesh;
#if LIT
layout(location = 1) uniform mat3 world_from_normal;
out vec3 world_normal;
#endif
#if TEXTURED
out vec2 texture_uv;
#endif
void main() {
  gl_Position = clip_from_mesh * vec4(position, 1.0);
#if LIT
  world_normal = world_from_normal * normal;
#endif
#if TEXTURED
  texture_uv = uv;
#endif
}
)";

constexpr const char* kFragmentShader = R"(
#if LIT
layout(location = 2) uniform vec4 base_colour;
layout(location = 3) uniform vec2 ambient_diffuse;
layout(location = 5) uniform vec3 light_direction;
in vec3 world_normal;
#endif
#if TEXTURED
layout(binding = 0) uniform sampler2D colour_texture;
in vec2 texture_uv;
#endif
#if MASKED
layout(location = 4) uniform float alpha_cutoff;
#endif
out vec4 pixel;
void main() {
  vec4 colour = vec4(1.0);
#if TEXTURED
  colour *= texture(colour_texture, texture_uv);
#endif
#if LIT
  colour *= base_colour;
#endif
#if MASKED
  if (colour.a < alpha_cutoff) discard;
#elif !LIT
  if (colour.a < 0.5) discard;
#endif
#if LIT
  float square = max(dot(world_normal, world_normal), 1e-30);
  colour.rgb *= ambient_diffuse.x + ambient_diffuse.y * abs(dot(world_normal, light_direction)) * inversesqrt(square);
#endif
  pixel = vec4(colour.rgb, 1.0);
}
)";

std::string preamble(Program program) {
  const auto flag = [](const char* name, bool value) { return "#define " + std::string(name) + (value ? " 1\n" : " 0\n"); };
  return "#version 450 core\n" + flag("LIT", program != Program::kImpostor) + flag("TEXTURED", program != Program::kPlain) +
         flag("MASKED", program == Program::kMasked);
}

GLuint compile(const Gl& gl, GLenum stage, const std::string& preamble_text, const char* body) {
  const GLuint shader = gl.CreateShader(stage);
  const char* sources[] = {preamble_text.c_str(), body};
  gl.ShaderSource(shader, 2, sources, nullptr);
  gl.CompileShader(shader);
  GLint compiled = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) return shader;
  std::string log(2048, '\0');
  gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Failure(ErrorWord::kDeviceUnavailable, std::string("a shader does not compile: ") + log.c_str());
}

GLuint link(const Gl& gl, Program program) {
  const std::string preamble_text = preamble(program);
  const GLuint name = gl.CreateProgram();
  for (const auto& [stage, body] : {std::pair{GL_VERTEX_SHADER, kVertexShader}, std::pair{GL_FRAGMENT_SHADER, kFragmentShader}}) {
    const GLuint shader = compile(gl, stage, preamble_text, body);
    gl.AttachShader(name, shader);
    gl.DeleteShader(shader);  // freed with the program
  }
  gl.LinkProgram(name);
  GLint linked = GL_FALSE;
  gl.GetProgramiv(name, GL_LINK_STATUS, &linked);
  if (linked == GL_TRUE) return name;
  std::string log(2048, '\0');
  gl.GetProgramInfoLog(name, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw Failure(ErrorWord::kDeviceUnavailable, std::string("a shader program does not link: ") + log.c_str());
}

}  // namespace

Programs::Programs(const Gl& gl) : gl_(gl) {
  const glm::vec3 light(light_direction());
  for (std::size_t i = 0; i < kProgramCount; ++i) {
    const auto program = static_cast<Program>(i);
    names_[i] = link(gl_, program);
    if (program != Program::kImpostor) gl_.ProgramUniform3f(names_[i], kLightDirection, light.x, light.y, light.z);
  }
}

Programs::~Programs() {
  for (const GLuint name : names_) gl_.DeleteProgram(name);
}

}  // namespace standin
