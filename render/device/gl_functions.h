// The OpenGL functions that Standin uses, as pointers loaded from a context: gl.Clear(...) is glClear.
//
// Mesa's OSMesa and EGL libraries export different entry points of the same names; pointers per context let both live in one process.
#pragma once

#include <GL/glcorearb.h>

#include "render/device/context.h"

#define STANDIN_GL_FUNCTIONS(X)                                          \
  X(PFNGLATTACHSHADERPROC, AttachShader)                                 \
  X(PFNGLBEGINQUERYPROC, BeginQuery)                                     \
  X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                           \
  X(PFNGLBINDTEXTUREUNITPROC, BindTextureUnit)                           \
  X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                           \
  X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus)   \
  X(PFNGLCLEARPROC, Clear)                                               \
  X(PFNGLCLEARCOLORPROC, ClearColor)                                     \
  X(PFNGLCLEARDEPTHPROC, ClearDepth)                                     \
  X(PFNGLCLIPCONTROLPROC, ClipControl)                                   \
  X(PFNGLCOMPILESHADERPROC, CompileShader)                               \
  X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                               \
  X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                     \
  X(PFNGLCREATEPROGRAMPROC, CreateProgram)                               \
  X(PFNGLCREATEQUERIESPROC, CreateQueries)                               \
  X(PFNGLCREATERENDERBUFFERSPROC, CreateRenderbuffers)                   \
  X(PFNGLCREATESHADERPROC, CreateShader)                                 \
  X(PFNGLCREATETEXTURESPROC, CreateTextures)                             \
  X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                     \
  X(PFNGLCULLFACEPROC, CullFace)                                         \
  X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                               \
  X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                     \
  X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                               \
  X(PFNGLDELETEQUERIESPROC, DeleteQueries)                               \
  X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                   \
  X(PFNGLDELETESHADERPROC, DeleteShader)                                 \
  X(PFNGLDELETETEXTURESPROC, DeleteTextures)                             \
  X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                     \
  X(PFNGLDEPTHFUNCPROC, DepthFunc)                                       \
  X(PFNGLDISABLEPROC, Disable)                                           \
  X(PFNGLDRAWELEMENTSBASEVERTEXPROC, DrawElementsBaseVertex)             \
  X(PFNGLENABLEPROC, Enable)                                             \
  X(PFNGLENABLEVERTEXARRAYATTRIBPROC, EnableVertexArrayAttrib)           \
  X(PFNGLENDQUERYPROC, EndQuery)                                         \
  X(PFNGLFINISHPROC, Finish)                                             \
  X(PFNGLGENERATETEXTUREMIPMAPPROC, GenerateTextureMipmap)               \
  X(PFNGLGETERRORPROC, GetError)                                         \
  X(PFNGLGETINTEGERVPROC, GetIntegerv)                                   \
  X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                       \
  X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                 \
  X(PFNGLGETQUERYOBJECTUI64VPROC, GetQueryObjectui64v)                   \
  X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                         \
  X(PFNGLGETSHADERIVPROC, GetShaderiv)                                   \
  X(PFNGLLINKPROGRAMPROC, LinkProgram)                                   \
  X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                     \
  X(PFNGLNAMEDFRAMEBUFFERRENDERBUFFERPROC, NamedFramebufferRenderbuffer) \
  X(PFNGLNAMEDRENDERBUFFERSTORAGEPROC, NamedRenderbufferStorage)         \
  X(PFNGLPROGRAMUNIFORM3FPROC, ProgramUniform3f)                         \
  X(PFNGLREADPIXELSPROC, ReadPixels)                                     \
  X(PFNGLSHADERSOURCEPROC, ShaderSource)                                 \
  X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                       \
  X(PFNGLTEXTURESTORAGE2DPROC, TextureStorage2D)                         \
  X(PFNGLTEXTURESUBIMAGE2DPROC, TextureSubImage2D)                       \
  X(PFNGLUNIFORM2FPROC, Uniform2f)                                       \
  X(PFNGLUNIFORM1FPROC, Uniform1f)                                       \
  X(PFNGLUNIFORM4FVPROC, Uniform4fv)                                     \
  X(PFNGLUNIFORMMATRIX3FVPROC, UniformMatrix3fv)                         \
  X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)                         \
  X(PFNGLUSEPROGRAMPROC, UseProgram)                                     \
  X(PFNGLVERTEXARRAYATTRIBBINDINGPROC, VertexArrayAttribBinding)         \
  X(PFNGLVERTEXARRAYATTRIBFORMATPROC, VertexArrayAttribFormat)           \
  X(PFNGLVERTEXARRAYELEMENTBUFFERPROC, VertexArrayElementBuffer)         \
  X(PFNGLVERTEXARRAYVERTEXBUFFERPROC, VertexArrayVertexBuffer)           \
  X(PFNGLVIEWPORTPROC, Viewport)

namespace standin {

struct Gl {
  /// Throws Failure(kDeviceUnavailable) naming a function that the context lacks.
  explicit Gl(const Context& context);
  /// Throws Failure(kDeviceUnavailable) if an error (out of memory, mostly) occurred since the last call.
  void check(const char* doing_what) const;

#define STANDIN_GL_MEMBER(type, name) type name = nullptr;
  STANDIN_GL_FUNCTIONS(STANDIN_GL_MEMBER)
#undef STANDIN_GL_MEMBER
};

}  // namespace standin
