#include "sim/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "sim/render/backdrop.h"
#include "sim/render/bounds.h"
#include "sim/render/cloth_surface.h"
#include "sim/render/cloth_texture.h"
#include "sim/render/gl_context.h"
#include "sim/render/mesh_normals.h"
#include "sim/render/shaders.h"

namespace gusset {
namespace {

constexpr double kNear_m = 0.05, kFar_m = 12;

// The ground map (see shaders.cc): 3.75 mm a texel over the table's middle. Heights beyond
// kCaster_m are cut there, or their blurred edges would darken far too wide a border.
constexpr int kGroundPixels = 256;
constexpr double kGroundHalf_m = 0.48, kHeightRange_m = 1.5, kCaster_m = 0.05;
constexpr double kBlurTexels = 2.0;
constexpr int kBlurWindow = 9;

constexpr float kFlat_m = 0.001f;  // what reaches no higher is the table

constexpr int kClothTexturePixels = 384;
constexpr double kCrease_deg = 40;
constexpr std::size_t kMaxCachedMeshes = 256;

enum Attribute : GLuint { kPosition = 0, kNormal = 1, kUvLayer = 2 };

/// Binds the context for as long as it lives.
class Current {
 public:
  explicit Current(GlContext& context) : context_(context) { context_.MakeCurrent(); }
  ~Current() { context_.Release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;

 private:
  GlContext& context_;
};

struct MeshOnCard {
  TriMesh source;  // what was uploaded
  Bounds bounds;
  GLuint vertex_array = 0, vertices = 0, indices = 0;
  GLsizei index_count = 0;
};

struct ClothOnCard {
  std::optional<ClothSurface> surface;
  GLuint vertex_array = 0, positions = 0, normals = 0, uv_layer = 0, indices = 0;
  GLuint texture = 0;
  std::vector<LabelPatch> labels;
  Eigen::Vector3f rgb, label_rgb;
  Eigen::Vector2f extent_m;
  bool textured = false;
};

/// A thing as it lies in the world.
struct PlacedItem {
  const RenderItem* item;
  const MeshOnCard* mesh;
  Corners corners;  ///< Of the box around it, world.
  bool stands;      ///< Reaches higher than the table.
};

/// Pixel centres: OpenCV's lie at integers, OpenGL's at halves. Image row 0 is drawn at OpenGL's
/// bottom, so what is read back needs no flip; windings turn over instead.
Eigen::Matrix4f ClipFromWorld(const CameraModel& camera) {
  const Pinhole& p = camera.pinhole;
  Eigen::Matrix4d clip = Eigen::Matrix4d::Zero();
  clip(0, 0) = 2 * p.fx / p.width;
  clip(0, 2) = 2 * (p.cx + 0.5) / p.width - 1;
  clip(1, 1) = 2 * p.fy / p.height;
  clip(1, 2) = 2 * (p.cy + 0.5) / p.height - 1;
  clip(2, 2) = (kFar_m + kNear_m) / (kFar_m - kNear_m);
  clip(2, 3) = -2 * kFar_m * kNear_m / (kFar_m - kNear_m);
  clip(3, 2) = 1;
  return (clip * camera.X_WC.inverse().matrix()).cast<float>();
}

Eigen::Vector3d TowardsLight(const LightConfig& light) {
  const double azimuth = light.azimuth_deg * std::numbers::pi / 180;
  const double elevation = light.elevation_deg * std::numbers::pi / 180;
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

Eigen::Vector3f ColourOf(const LightConfig& light) {
  return Eigen::Vector3d(light.gain * light.red, light.gain, light.gain * light.blue).cast<float>();
}

/// Seen from above, sheared so that every ray of the light meets one texel; depth 1 is height 0.
Eigen::Matrix4f GroundFromWorld(const Eigen::Vector2d& shear) {
  Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();
  clip(0, 0) = clip(1, 1) = 1 / kGroundHalf_m;
  clip.block<2, 1>(0, 2) = -shear / kGroundHalf_m;
  clip(2, 2) = -2 / kHeightRange_m;
  clip(2, 3) = 1;
  return clip.cast<float>();
}

}  // namespace

struct Renderer::Impl {
  Impl();

  GLuint Link(const char* vertex_source, const char* fragment_source);
  void Use(GLuint program);
  void Set(const char* name, float value) { gl.Uniform1f(At(name), value); }
  void Set(const char* name, const Eigen::Vector2f& v) { gl.Uniform2f(At(name), v.x(), v.y()); }
  void Set(const char* name, const Eigen::Vector3f& v) {
    gl.Uniform3f(At(name), v.x(), v.y(), v.z());
  }
  void Set(const char* name, const Eigen::Matrix4f& m) {
    gl.UniformMatrix4fv(At(name), 1, GL_FALSE, m.data());
  }
  void SetSampler(const char* name, int unit) { gl.Uniform1i(At(name), unit); }
  GLint At(const char* name) { return gl.GetUniformLocation(current_program, name); }

  void Resize(int width, int height);
  const MeshOnCard& Mesh(const TriMesh& mesh);
  void UpdateCloth(const ClothItem& item);
  void UpdateClothTexture(const ClothItem& item);
  void ForgetMesh(const MeshOnCard& entry);
  std::vector<PlacedItem> Place(const SceneView& scene);
  /// Of the box around the cloth as drawn, both sides.
  Corners ClothCorners() const {
    Bounds bounds = Bounds::Of(cloth.surface->positions());
    bounds.lo.array() -= cloth.surface->half_thickness_m();
    bounds.hi.array() += cloth.surface->half_thickness_m();
    return bounds.corners();
  }
  std::vector<cv::Rect> ChangedParts(const std::vector<PlacedItem>& items,
                                     const std::optional<Corners>& around_cloth,
                                     const Eigen::Matrix4f& clip_from_world,
                                     const Eigen::Vector2d& shear) const;
  RgbdFrame Draw(const SceneView& scene, const CameraModel& camera, bool over_backdrop);
  void DrawGroundMap(const SceneView& scene, const std::vector<PlacedItem>& items,
                     const Eigen::Vector2d& shear);
  void SetLight(const LightConfig& light, const Eigen::Vector2d& shear);
  void DrawPart(const SceneView& scene, const std::vector<PlacedItem>& items,
                const std::optional<Corners>& around_cloth, const Eigen::Matrix4f& clip_from_world,
                const Eigen::Vector2d& shear, const cv::Rect& part);
  void DrawItems(const LightConfig& light, const std::vector<PlacedItem>& items,
                 const Eigen::Matrix4f& clip_from_world, const cv::Rect& part, bool standing);
  void DrawCloth(const SceneView& scene, const Eigen::Matrix4f& clip_from_world);
  void SortCloth(const Eigen::Matrix4f& clip_from_world);
  void ReadBack(const cv::Rect& part, RgbdFrame& frame);

  GlContext context;
  const GlFunctions& gl;
  GLuint rigid_program = 0, cloth_program = 0, height_program = 0;
  GLuint current_program = 0;
  GLuint frame_buffer = 0, color_buffer = 0, depth_buffer = 0;
  GLuint height_buffer = 0, height_depth = 0, ground_texture = 0;
  int width = 0, height_px = 0;
  std::map<const TriMesh*, MeshOnCard> meshes;
  ClothOnCard cloth;
  cv::Mat mottle;  // CV_32FC1, the ground map's second channel
  std::uint64_t mottle_seed = 0;
  std::vector<std::array<unsigned, 3>> sorted;
  Backdrop backdrop;
  cv::Mat heights, ground, rgba, depth;  // kept from frame to frame to save allocations
};

Renderer::Impl::Impl() : gl(context.gl()) {
  rigid_program = Link(kRigidVertexShader, kRigidFragmentShader);
  cloth_program = Link(kClothVertexShader, kClothFragmentShader);
  height_program = Link(kHeightVertexShader, kHeightFragmentShader);

  gl.GenFramebuffers(1, &frame_buffer);
  gl.GenRenderbuffers(1, &color_buffer);
  gl.GenRenderbuffers(1, &depth_buffer);

  gl.GenFramebuffers(1, &height_buffer);
  gl.GenRenderbuffers(1, &height_depth);
  gl.BindFramebuffer(GL_FRAMEBUFFER, height_buffer);
  gl.BindRenderbuffer(GL_RENDERBUFFER, height_depth);
  gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, kGroundPixels, kGroundPixels);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, height_depth);

  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl.GenTextures(1, &ground_texture);
  gl.BindTexture(GL_TEXTURE_2D, ground_texture);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, kGroundPixels, kGroundPixels, 0, GL_RG, GL_FLOAT,
                nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
    gl.TexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  }
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    gl.TexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  }

  gl.GenVertexArrays(1, &cloth.vertex_array);
  gl.GenTextures(1, &cloth.texture);
  for (GLuint* buffer : {&cloth.positions, &cloth.normals, &cloth.uv_layer, &cloth.indices}) {
    gl.GenBuffers(1, buffer);
  }
  gl.BindVertexArray(cloth.vertex_array);
  const std::pair<GLuint, GLuint> arrays[] = {
      {kPosition, cloth.positions}, {kNormal, cloth.normals}, {kUvLayer, cloth.uv_layer}};
  for (const auto& [attribute, buffer] : arrays) {
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.EnableVertexAttribArray(attribute);
    gl.VertexAttribPointer(attribute, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, cloth.indices);

  gl.Enable(GL_DEPTH_TEST);
  gl.Enable(GL_CULL_FACE);
  gl.ClearColor(0.4f, 0.4f, 0.42f, 1);
}

GLuint Renderer::Impl::Link(const char* vertex_source, const char* fragment_source) {
  const GLuint program = gl.CreateProgram();
  const std::pair<GLenum, const char*> stages[] = {{GL_VERTEX_SHADER, vertex_source},
                                                   {GL_FRAGMENT_SHADER, fragment_source}};
  for (const auto& [type, source] : stages) {
    const GLuint shader = gl.CreateShader(type);
    gl.ShaderSource(shader, 1, &source, nullptr);
    gl.CompileShader(shader);
    GLint compiled = 0;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled) {
      std::array<char, 512> log{};
      gl.GetShaderInfoLog(shader, log.size(), nullptr, log.data());
      throw RunError(std::string("a shader does not compile: ") + log.data());
    }
    gl.AttachShader(program, shader);
    gl.DeleteShader(shader);
  }
  gl.BindAttribLocation(program, kPosition, "position");
  gl.BindAttribLocation(program, kNormal, "normal");
  gl.BindAttribLocation(program, kUvLayer, "uv_layer");
  gl.LinkProgram(program);
  GLint linked = 0;
  gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) throw RunError("shaders do not link");
  return program;
}

void Renderer::Impl::Use(GLuint program) {
  gl.UseProgram(program);
  current_program = program;
}

void Renderer::Impl::Resize(int new_width, int new_height) {
  if (new_width == width && new_height == height_px) return;
  gl.BindFramebuffer(GL_FRAMEBUFFER, frame_buffer);
  const std::tuple<GLuint, GLenum, GLenum> buffers[] = {
      {color_buffer, GL_RGBA8, GL_COLOR_ATTACHMENT0},
      {depth_buffer, GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT}};
  for (const auto& [buffer, format, attachment] : buffers) {
    gl.BindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.RenderbufferStorage(GL_RENDERBUFFER, format, new_width, new_height);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer);
  }
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw RunError("OpenGL gives no frame buffer of " + std::to_string(new_width) + " x " +
                   std::to_string(new_height) + " px");
  }
  width = new_width;
  height_px = new_height;
  rgba.create(height_px, width, CV_8UC4);
  depth.create(height_px, width, CV_32FC1);
}

void Renderer::Impl::ForgetMesh(const MeshOnCard& entry) {
  gl.DeleteVertexArrays(1, &entry.vertex_array);
  gl.DeleteBuffers(1, &entry.vertices);
  gl.DeleteBuffers(1, &entry.indices);
}

const MeshOnCard& Renderer::Impl::Mesh(const TriMesh& mesh) {
  // Keyed by address, which a new mesh may have inherited from a dead one: hence the comparison.
  if (const auto found = meshes.find(&mesh); found != meshes.end()) {
    MeshOnCard& entry = found->second;
    if (entry.source.vertices == mesh.vertices && entry.source.triangles == mesh.triangles) {
      return entry;
    }
    ForgetMesh(entry);
    meshes.erase(found);
  }
  MeshOnCard& entry = meshes[&mesh];
  entry.source = mesh;
  entry.bounds = Bounds::Of(mesh.vertices);
  const ShadedMesh shaded = WithNormals(mesh, kCrease_deg);
  entry.index_count = static_cast<GLsizei>(3 * shaded.triangles.size());
  gl.GenVertexArrays(1, &entry.vertex_array);
  gl.GenBuffers(1, &entry.vertices);
  gl.GenBuffers(1, &entry.indices);
  gl.BindVertexArray(entry.vertex_array);
  gl.BindBuffer(GL_ARRAY_BUFFER, entry.vertices);
  gl.BufferData(GL_ARRAY_BUFFER, shaded.vertices.size() * sizeof(ShadedMesh::Vertex),
                shaded.vertices.data(), GL_STATIC_DRAW);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, entry.indices);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, entry.index_count * sizeof(unsigned),
                shaded.triangles.data(), GL_STATIC_DRAW);
  gl.EnableVertexAttribArray(kPosition);
  gl.VertexAttribPointer(kPosition, 3, GL_FLOAT, GL_FALSE, sizeof(ShadedMesh::Vertex), nullptr);
  gl.EnableVertexAttribArray(kNormal);
  gl.VertexAttribPointer(kNormal, 3, GL_FLOAT, GL_FALSE, sizeof(ShadedMesh::Vertex),
                         reinterpret_cast<const void*>(offsetof(ShadedMesh::Vertex, normal)));
  return entry;
}

std::vector<PlacedItem> Renderer::Impl::Place(const SceneView& scene) {
  if (meshes.size() > kMaxCachedMeshes) {
    for (const auto& [key, entry] : meshes) ForgetMesh(entry);
    meshes.clear();
  }
  std::vector<PlacedItem> items;
  for (const RenderItem& item : scene.items) {
    const MeshOnCard& mesh = Mesh(*item.mesh);
    const Corners corners = item.X_WM.cast<float>() * mesh.bounds.corners();
    items.push_back({&item, &mesh, corners, corners.row(2).maxCoeff() > kFlat_m});
  }
  return items;
}

void Renderer::Impl::UpdateCloth(const ClothItem& item) {
  gl.BindVertexArray(cloth.vertex_array);
  if (!cloth.surface || !cloth.surface->Fits(item)) {
    cloth.surface.emplace(item);
    const ClothSurface& surface = *cloth.surface;
    gl.BindBuffer(GL_ARRAY_BUFFER, cloth.uv_layer);
    gl.BufferData(GL_ARRAY_BUFFER, surface.uv_layer().size() * sizeof(Eigen::Vector3f),
                  surface.uv_layer().data(), GL_STATIC_DRAW);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, cloth.indices);
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, surface.triangles().size() * 3 * sizeof(unsigned),
                  surface.triangles().data(), GL_STATIC_DRAW);
    cloth.textured = false;
  }
  cloth.surface->Update(item);
  const std::pair<GLuint, const std::vector<Eigen::Vector3f>*> arrays[] = {
      {cloth.positions, &cloth.surface->positions()}, {cloth.normals, &cloth.surface->normals()}};
  for (const auto& [buffer, values] : arrays) {
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, values->size() * sizeof(Eigen::Vector3f), values->data(),
                  GL_STREAM_DRAW);
  }
  UpdateClothTexture(item);
}

void Renderer::Impl::UpdateClothTexture(const ClothItem& item) {
  if (cloth.textured && cloth.labels == item.labels && cloth.rgb == item.rgb &&
      cloth.label_rgb == item.label_rgb) {
    return;
  }
  Eigen::Vector3f most = Eigen::Vector3f::Zero();
  for (const Eigen::Vector3f& uv_layer : cloth.surface->uv_layer()) most = most.cwiseMax(uv_layer);
  cloth.extent_m = most.head<2>();
  const int layers = static_cast<int>(most.z()) + 1;
  const cv::Size size(kClothTexturePixels, kClothTexturePixels);
  std::vector<uchar> texels;
  for (int layer = 0; layer < layers; ++layer) {
    const cv::Mat texture = ClothTexture(item, layer, cloth.extent_m, size);
    texels.insert(texels.end(), texture.datastart, texture.dataend);
  }
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D_ARRAY, cloth.texture);
  gl.TexImage3D(GL_TEXTURE_2D_ARRAY, 0, GL_RGB8, size.width, size.height, layers, 0, GL_RGB,
                GL_UNSIGNED_BYTE, texels.data());
  gl.GenerateMipmap(GL_TEXTURE_2D_ARRAY);
  gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) {
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, wrap, GL_CLAMP_TO_EDGE);
  }
  cloth.labels = item.labels;
  cloth.rgb = item.rgb;
  cloth.label_rgb = item.label_rgb;
  cloth.textured = true;
}

void Renderer::Impl::DrawGroundMap(const SceneView& scene, const std::vector<PlacedItem>& items,
                                   const Eigen::Vector2d& shear) {
  const Eigen::Matrix4f clip_from_world = GroundFromWorld(shear);
  gl.Disable(GL_SCISSOR_TEST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, height_buffer);
  gl.Viewport(0, 0, kGroundPixels, kGroundPixels);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.FrontFace(GL_CCW);
  Use(height_program);
  Set("clip_from_world", clip_from_world);
  for (const auto& [item, mesh, corners, stands] : items) {
    // What reaches no higher than the table casts no shadow on it.
    if (!stands || !MayBeSeen(corners, clip_from_world)) continue;
    Set("X_WM", Eigen::Matrix4f(item->X_WM.matrix().cast<float>()));
    gl.BindVertexArray(mesh->vertex_array);
    gl.DrawElements(GL_TRIANGLES, mesh->index_count, GL_UNSIGNED_INT, nullptr);
  }
  if (!scene.cloth.x.empty()) {
    Set("X_WM", Eigen::Matrix4f(Eigen::Matrix4f::Identity()));
    gl.BindVertexArray(cloth.vertex_array);
    const auto indices = static_cast<GLsizei>(3 * cloth.surface->triangles().size());
    gl.Disable(GL_CULL_FACE);  // either side may face the light
    gl.DrawElements(GL_TRIANGLES, indices, GL_UNSIGNED_INT, nullptr);
    gl.Enable(GL_CULL_FACE);
  }
  heights.create(kGroundPixels, kGroundPixels, CV_32FC1);
  gl.ReadPixels(0, 0, kGroundPixels, kGroundPixels, GL_DEPTH_COMPONENT, GL_FLOAT, heights.data);
  for (float& value : cv::Mat_<float>(heights)) {
    value =
        std::min((1 - value) * static_cast<float>(kHeightRange_m), static_cast<float>(kCaster_m));
  }
  cv::GaussianBlur(heights, heights, {kBlurWindow, kBlurWindow}, kBlurTexels, kBlurTexels,
                   cv::BORDER_REPLICATE);
  if (mottle.empty() || mottle_seed != scene.canvas_seed) {
    mottle = FabricTexture(kGroundPixels, static_cast<float>(2 * kGroundHalf_m), scene.canvas_seed);
    mottle_seed = scene.canvas_seed;
  }
  cv::merge(std::array{heights, mottle}, ground);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_2D, ground_texture);
  gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kGroundPixels, kGroundPixels, GL_RG, GL_FLOAT,
                   ground.data);
}

void Renderer::Impl::SetLight(const LightConfig& light, const Eigen::Vector2d& shear) {
  Set("light", Eigen::Vector3f(TowardsLight(light).cast<float>()));
  Set("darkest", static_cast<float>(1 - light.contrast));
  const double per_m = light.uneven / 0.3;
  const Eigen::Vector2d towards = shear.normalized() * per_m;
  Set("brighter", Eigen::Vector2f(towards.cast<float>()));
  Set("shadow", static_cast<float>(light.shadow));
  Set("shear", Eigen::Vector2f(shear.cast<float>()));
  Set("ground_half", static_cast<float>(kGroundHalf_m));
  SetSampler("ground", 1);
}

// Either what stands up from the table or the table itself and what lies no higher.
void Renderer::Impl::DrawItems(const LightConfig& light, const std::vector<PlacedItem>& items,
                               const Eigen::Matrix4f& clip_from_world, const cv::Rect& part,
                               bool standing) {
  gl.FrontFace(GL_CW);
  Set("clip_from_world", clip_from_world);
  for (const auto& [item, mesh, corners, stands] : items) {
    if (stands != standing) continue;
    if ((PixelsOf(corners, clip_from_world, {width, height_px}) & part).empty()) continue;
    Set("X_WM", Eigen::Matrix4f(item->X_WM.matrix().cast<float>()));
    Set("rgb", Eigen::Vector3f(item->rgb.cwiseProduct(ColourOf(light))));
    Set("darkest", std::min(1 - item->contrast, static_cast<float>(1 - light.contrast)));
    Set("mottle", item->mottle);
    gl.BindVertexArray(mesh->vertex_array);
    gl.DrawElements(GL_TRIANGLES, mesh->index_count, GL_UNSIGNED_INT, nullptr);
  }
}

// Nearest first: what lies under other cloth then fails the depth test before it is shaded, and a
// bag has two layers everywhere, a folded one more. Bins keep neighbours together; exact order
// would gain nothing.
void Renderer::Impl::SortCloth(const Eigen::Matrix4f& clip_from_world) {
  constexpr int kBins = 64;
  const std::vector<Eigen::Vector3f>& positions = cloth.surface->positions();
  const std::vector<std::array<unsigned, 3>>& triangles = cloth.surface->triangles();
  const Eigen::Vector3f axis = clip_from_world.block<1, 3>(3, 0).transpose();
  std::vector<float> distance(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) distance[i] = axis.dot(positions[i]);
  const auto [least, most] = std::ranges::minmax(distance);
  const float per_m = (kBins - 1) / std::max(most - least, 1e-6f);
  std::vector<unsigned char> bin(triangles.size());
  std::array<unsigned, kBins + 1> begin{};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    const float nearest = std::min({distance[a], distance[b], distance[c]});
    bin[t] = static_cast<unsigned char>((nearest - least) * per_m);
    ++begin[bin[t] + 1u];
  }
  for (int k = 0; k < kBins; ++k) begin[k + 1] += begin[k];
  sorted.resize(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) sorted[begin[bin[t]]++] = triangles[t];
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, cloth.indices);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, sorted.size() * 3 * sizeof(unsigned), sorted.data(),
                GL_STREAM_DRAW);
}

void Renderer::Impl::DrawCloth(const SceneView& scene, const Eigen::Matrix4f& clip_from_world) {
  SetSampler("weave", 0);
  Set("clip_from_world", clip_from_world);
  Set("extent", cloth.extent_m);
  Set("gain", ColourOf(scene.light));
  gl.BindVertexArray(cloth.vertex_array);
  SortCloth(clip_from_world);
  const auto indices = static_cast<GLsizei>(3 * cloth.surface->triangles().size());
  // A shell: one side along the normals, one against them. Its rim, one thickness wide, is less
  // than a pixel and stays open.
  const float half = cloth.surface->half_thickness_m();
  const std::pair<GLenum, float> sides[] = {{GL_CW, half}, {GL_CCW, -half}};
  for (const auto& [front, offset] : sides) {
    gl.FrontFace(front);
    Set("offset", offset);
    gl.DrawElements(GL_TRIANGLES, indices, GL_UNSIGNED_INT, nullptr);
  }
}

// What has been drawn of a part, into the frame.
void Renderer::Impl::ReadBack(const cv::Rect& part, RgbdFrame& frame) {
  const cv::Mat part_rgba(part.size(), CV_8UC4, rgba.data);
  const cv::Mat part_depth(part.size(), CV_32FC1, depth.data);
  gl.ReadPixels(part.x, part.y, part.width, part.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
  gl.ReadPixels(part.x, part.y, part.width, part.height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.data);
  cv::cvtColor(part_rgba, frame.color(part), cv::COLOR_RGBA2BGR);
  // 1/z is linear in the depth buffer's d; halves are added so that cutting to integer rounds.
  constexpr auto kInverseNear = static_cast<float>(1 / (1000 * kNear_m));
  constexpr auto kSlope = static_cast<float>(1 / (1000 * kNear_m) - 1 / (1000 * kFar_m));
  std::vector<float> z(static_cast<std::size_t>(part.width));
  for (int row = 0; row < part.height; ++row) {
    const auto* d = part_depth.ptr<float>(row);
    auto* mm = frame.depth_mm.ptr<std::uint16_t>(part.y + row) + part.x;
    // In two loops, which the compiler makes vectors of; in one it does not.
    for (int column = 0; column < part.width; ++column) {
      const float rounded = 1 / (kInverseNear - kSlope * d[column]) + 0.5f;
      z[column] = d[column] < 1 ? rounded : 0.0f;
    }
    for (int column = 0; column < part.width; ++column) {
      mm[column] = static_cast<std::uint16_t>(static_cast<int>(z[column]));
    }
  }
}

void Renderer::Impl::DrawPart(const SceneView& scene, const std::vector<PlacedItem>& items,
                              const std::optional<Corners>& around_cloth,
                              const Eigen::Matrix4f& clip_from_world, const Eigen::Vector2d& shear,
                              const cv::Rect& part) {
  gl.Scissor(part.x, part.y, part.width, part.height);
  gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  // Nearest first as a rule, so that what they hide is not shaded.
  Use(rigid_program);
  SetLight(scene.light, shear);
  DrawItems(scene.light, items, clip_from_world, part, /*standing=*/true);
  if (around_cloth &&
      !(PixelsOf(*around_cloth, clip_from_world, {width, height_px}) & part).empty()) {
    Use(cloth_program);
    SetLight(scene.light, shear);
    DrawCloth(scene, clip_from_world);
    Use(rigid_program);
  }
  DrawItems(scene.light, items, clip_from_world, part, /*standing=*/false);
}

// Where the scene looks other than the backdrop.
std::vector<cv::Rect> Renderer::Impl::ChangedParts(const std::vector<PlacedItem>& items,
                                                   const std::optional<Corners>& around_cloth,
                                                   const Eigen::Matrix4f& clip_from_world,
                                                   const Eigen::Vector2d& shear) const {
  std::vector<Corners> moving, still;
  for (const PlacedItem& placed : items) {
    (placed.item->still ? still : moving).push_back(placed.corners);
  }
  if (around_cloth) moving.push_back(*around_cloth);
  // The blur's window reaches four texels, each look-up to the next one, and one is for rounding.
  constexpr double kTexel_m = 2 * kGroundHalf_m / kGroundPixels;
  constexpr auto kReach_m = static_cast<float>((kBlurWindow / 2 + 2) * kTexel_m);
  return backdrop.ChangedParts(moving, still, clip_from_world, shear.cast<float>(), kReach_m,
                               static_cast<float>(kGroundHalf_m - kReach_m));
}

RgbdFrame Renderer::Impl::Draw(const SceneView& scene, const CameraModel& camera,
                               bool over_backdrop) {
  const Eigen::Vector3d light = TowardsLight(scene.light);
  const Eigen::Vector2d shear = light.head<2>() / light.z();
  const std::vector<PlacedItem> items = Place(scene);
  std::optional<Corners> around_cloth;
  if (!scene.cloth.x.empty()) around_cloth = ClothCorners();
  DrawGroundMap(scene, items, shear);

  const Eigen::Matrix4f clip_from_world = ClipFromWorld(camera);
  RgbdFrame frame;
  std::vector<cv::Rect> parts;
  if (over_backdrop) {
    frame = {backdrop.frame().color.clone(), backdrop.frame().depth_mm.clone()};
    parts = ChangedParts(items, around_cloth, clip_from_world, shear);
  } else {
    frame.color.create(height_px, width, CV_8UC3);
    frame.depth_mm.create(height_px, width, CV_16UC1);
    parts = {cv::Rect(0, 0, width, height_px)};
  }
  gl.BindFramebuffer(GL_FRAMEBUFFER, frame_buffer);
  gl.Viewport(0, 0, width, height_px);
  gl.Enable(GL_SCISSOR_TEST);
  for (const cv::Rect& part : parts) {
    DrawPart(scene, items, around_cloth, clip_from_world, shear, part);
    ReadBack(part, frame);
  }
  return frame;
}

Renderer::Renderer() : impl_(std::make_unique<Impl>()) { impl_->context.Release(); }

Renderer::~Renderer() = default;

std::string Renderer::gl_renderer() const {
  const Current current(impl_->context);
  return reinterpret_cast<const char*>(impl_->gl.GetString(GL_RENDERER));
}

RgbdFrame Renderer::Render(const SceneView& scene, const CameraModel& camera) {
  for (const RenderItem& item : scene.items) {
    if (!item.X_WM.matrix().allFinite()) throw InputError("scene to draw: a pose is not finite");
  }
  Impl& impl = *impl_;
  const Current current(impl.context);
  impl.Resize(camera.pinhole.width, camera.pinhole.height);
  if (!scene.cloth.x.empty()) impl.UpdateCloth(scene.cloth);

  SceneView still;
  for (const RenderItem& item : scene.items) {
    if (item.still) still.items.push_back(item);
  }
  still.light = scene.light;
  still.canvas_seed = scene.canvas_seed;
  const bool over_backdrop = impl.backdrop.NoteLook(still, camera);
  if (over_backdrop && !impl.backdrop.kept()) {
    impl.backdrop.Keep(impl.Draw(still, camera, false));
  }
  return impl.Draw(scene, camera, over_backdrop);
}

CameraModel LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   const Pinhole& pinhole) {
  const Eigen::Vector3d z = (target - eye).normalized();
  const Eigen::Vector3d up =
      z.head<2>().norm() < 1e-6 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  CameraModel camera;
  camera.pinhole = pinhole;
  camera.X_WC.linear().col(0) = z.cross(up).normalized();
  camera.X_WC.linear().col(1) = z.cross(camera.X_WC.linear().col(0));
  camera.X_WC.linear().col(2) = z;
  camera.X_WC.translation() = eye;
  return camera;
}

}  // namespace gusset
