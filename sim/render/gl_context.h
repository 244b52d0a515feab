#pragma once

#include <GL/osmesa.h>

#include <array>
// After osmesa.h, which brings gl.h.
#include <GL/glext.h>

namespace gusset {

/// The OpenGL functions the renderer uses, fetched by OSMesaGetProcAddress: were another libGL
/// loaded (OpenCV's GUI module brings one), a direct call would reach that one instead.
struct GlFunctions {
  decltype(&glBindTexture) BindTexture;
  decltype(&glClear) Clear;
  decltype(&glClearColor) ClearColor;
  decltype(&glDisable) Disable;
  decltype(&glDrawElements) DrawElements;
  decltype(&glEnable) Enable;
  decltype(&glFrontFace) FrontFace;
  decltype(&glGenTextures) GenTextures;
  decltype(&glGetString) GetString;
  decltype(&glPixelStorei) PixelStorei;
  decltype(&glReadPixels) ReadPixels;
  decltype(&glScissor) Scissor;
  decltype(&glTexImage2D) TexImage2D;
  decltype(&glTexParameteri) TexParameteri;
  decltype(&glTexSubImage2D) TexSubImage2D;
  decltype(&glViewport) Viewport;
  PFNGLACTIVETEXTUREPROC ActiveTexture;
  PFNGLATTACHSHADERPROC AttachShader;
  PFNGLBINDATTRIBLOCATIONPROC BindAttribLocation;
  PFNGLBINDBUFFERPROC BindBuffer;
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer;
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer;
  PFNGLBINDVERTEXARRAYPROC BindVertexArray;
  PFNGLBUFFERDATAPROC BufferData;
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus;
  PFNGLCOMPILESHADERPROC CompileShader;
  PFNGLCREATEPROGRAMPROC CreateProgram;
  PFNGLCREATESHADERPROC CreateShader;
  PFNGLDELETEBUFFERSPROC DeleteBuffers;
  PFNGLDELETESHADERPROC DeleteShader;
  PFNGLDELETEVERTEXARRAYSPROC DeleteVertexArrays;
  PFNGLENABLEVERTEXATTRIBARRAYPROC EnableVertexAttribArray;
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer;
  PFNGLGENBUFFERSPROC GenBuffers;
  PFNGLGENERATEMIPMAPPROC GenerateMipmap;
  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers;
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers;
  PFNGLGENVERTEXARRAYSPROC GenVertexArrays;
  PFNGLGETPROGRAMIVPROC GetProgramiv;
  PFNGLGETSHADERINFOLOGPROC GetShaderInfoLog;
  PFNGLGETSHADERIVPROC GetShaderiv;
  PFNGLGETUNIFORMLOCATIONPROC GetUniformLocation;
  PFNGLLINKPROGRAMPROC LinkProgram;
  PFNGLRENDERBUFFERSTORAGEPROC RenderbufferStorage;
  PFNGLSHADERSOURCEPROC ShaderSource;
  PFNGLTEXIMAGE3DPROC TexImage3D;
  PFNGLUNIFORM1FPROC Uniform1f;
  PFNGLUNIFORM1IPROC Uniform1i;
  PFNGLUNIFORM2FPROC Uniform2f;
  PFNGLUNIFORM3FPROC Uniform3f;
  PFNGLUNIFORMMATRIX4FVPROC UniformMatrix4fv;
  PFNGLUSEPROGRAMPROC UseProgram;
  PFNGLVERTEXATTRIBPOINTERPROC VertexAttribPointer;
};

/// An OSMesa 3.3 core context and its functions. Objects made in it die with it.
class GlContext {
 public:
  /// Leaves the context current. @throws RunError.
  GlContext();
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  /// Binds the context to this thread. @throws RunError.
  void MakeCurrent();
  /// Unbinds it, so that another thread may use it.
  void Release();
  const GlFunctions& gl() const { return gl_; }

 private:
  OSMesaContext context_;
  std::array<unsigned char, 4> pixel_{};  // OSMesa wants a window; we draw into our own buffers.
  GlFunctions gl_{};
};

}  // namespace gusset
