#include "sim/render/gl_context.h"

#include <cstdlib>
#include <string>

#include "base/error.h"

namespace gusset {
namespace {

template <class F>
void Fetch(F& function, const char* name) {
  function = reinterpret_cast<F>(OSMesaGetProcAddress(name));
  if (function == nullptr) throw RunError(std::string("OSMesa lacks the function ") + name);
}

void FetchAll(GlFunctions& gl) {
#define GUSSET_GL(name) Fetch(gl.name, "gl" #name)
  GUSSET_GL(BindTexture);
  GUSSET_GL(Clear);
  GUSSET_GL(ClearColor);
  GUSSET_GL(Disable);
  GUSSET_GL(DrawElements);
  GUSSET_GL(Enable);
  GUSSET_GL(FrontFace);
  GUSSET_GL(GenTextures);
  GUSSET_GL(GetString);
  GUSSET_GL(PixelStorei);
  GUSSET_GL(ReadPixels);
  GUSSET_GL(Scissor);
  GUSSET_GL(TexImage2D);
  GUSSET_GL(TexParameteri);
  GUSSET_GL(TexSubImage2D);
  GUSSET_GL(Viewport);
  GUSSET_GL(ActiveTexture);
  GUSSET_GL(AttachShader);
  GUSSET_GL(BindAttribLocation);
  GUSSET_GL(BindBuffer);
  GUSSET_GL(BindFramebuffer);
  GUSSET_GL(BindRenderbuffer);
  GUSSET_GL(BindVertexArray);
  GUSSET_GL(BufferData);
  GUSSET_GL(CheckFramebufferStatus);
  GUSSET_GL(CompileShader);
  GUSSET_GL(CreateProgram);
  GUSSET_GL(CreateShader);
  GUSSET_GL(DeleteBuffers);
  GUSSET_GL(DeleteShader);
  GUSSET_GL(DeleteVertexArrays);
  GUSSET_GL(EnableVertexAttribArray);
  GUSSET_GL(FramebufferRenderbuffer);
  GUSSET_GL(GenBuffers);
  GUSSET_GL(GenerateMipmap);
  GUSSET_GL(GenFramebuffers);
  GUSSET_GL(GenRenderbuffers);
  GUSSET_GL(GenVertexArrays);
  GUSSET_GL(GetProgramiv);
  GUSSET_GL(GetShaderInfoLog);
  GUSSET_GL(GetShaderiv);
  GUSSET_GL(GetUniformLocation);
  GUSSET_GL(LinkProgram);
  GUSSET_GL(RenderbufferStorage);
  GUSSET_GL(ShaderSource);
  GUSSET_GL(TexImage3D);
  GUSSET_GL(Uniform1f);
  GUSSET_GL(Uniform1i);
  GUSSET_GL(Uniform2f);
  GUSSET_GL(Uniform3f);
  GUSSET_GL(UniformMatrix4fv);
  GUSSET_GL(UseProgram);
  GUSSET_GL(VertexAttribPointer);
#undef GUSSET_GL
}

}  // namespace

GlContext::GlContext() {
  // Mesa reads this once, at the process's first context. A user's own setting wins.
  static const int once = setenv("LP_NUM_THREADS", "0", 0);
  (void)once;
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  context_ = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context_ == nullptr) throw RunError("OSMesa gives no OpenGL 3.3 core context");
  try {
    MakeCurrent();
    FetchAll(gl_);
  } catch (...) {
    OSMesaDestroyContext(context_);
    throw;
  }
}

GlContext::~GlContext() { OSMesaDestroyContext(context_); }

void GlContext::MakeCurrent() {
  if (!OSMesaMakeCurrent(context_, pixel_.data(), GL_UNSIGNED_BYTE, 1, 1)) {
    throw RunError("OSMesa cannot make its context current");
  }
}

void GlContext::Release() { OSMesaMakeCurrent(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }

}  // namespace gusset
