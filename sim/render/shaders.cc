#include "sim/render/shaders.h"

namespace gusset {

// Half-Lambert (Mitchell, McTaggart, Green 2006) keeps shape in surfaces turned from the light;
// a share of sky light from above keeps an upright side darker than a top.
#define GUSSET_LIT                                          \
  "uniform vec3 light;\n"                                   \
  "float Lit(vec3 n) {\n"                                   \
  "  float key = 0.5 + 0.5 * dot(n, light);\n"              \
  "  return 0.75 * key * key + 0.25 * (0.5 + 0.5 * n.z);\n" \
  "}\n"

// Brighter on the lamp's side of the table: linear over it, so that a table of four corners is
// right.
#define GUSSET_NEARNESS      \
  "uniform vec2 brighter;\n" \
  "float Nearness(vec3 p) { return clamp(1.0 + dot(brighter, p.xy), 0.5, 1.5); }\n"

// `ground` is a map of the table's plane. Red is the blurred height (m) of what the light meets
// first on its way there: whatever lies below it gets the less light the deeper it lies. In a
// crease the blurred height exceeds the crease's own, so creases darken too. Green is mottling; one
// texture, because a second look-up per pixel would cost as much as all the rest of the shading.
#define GUSSET_GROUND                                                \
  "uniform sampler2D ground;\n"                                      \
  "uniform vec2 shear;\n"                                            \
  "uniform float ground_half;\n"                                     \
  "uniform float shadow;\n"                                          \
  "vec2 Ground(vec3 p) {\n"                                          \
  "  vec2 at = (p.xy - p.z * shear) / (2.0 * ground_half) + 0.5;\n"  \
  "  vec2 here = texture(ground, at).rg;\n"                          \
  "  float below = max(0.0, here.r - p.z - 0.0006);\n"               \
  "  return vec2(1.0 - shadow * below / (below + 0.009), here.g);\n" \
  "}\n"

const char* const kRigidVertexShader =
    "#version 330 core\n"
    "in vec3 position;\n"
    "in vec3 normal;\n"
    "uniform mat4 X_WM;\n"
    "uniform mat4 clip_from_world;\n" GUSSET_LIT GUSSET_NEARNESS
    "out vec3 p_W;\n"
    "out float lit;\n"
    "out float nearness;\n"
    "void main() {\n"
    "  vec4 p = X_WM * vec4(position, 1.0);\n"
    "  p_W = p.xyz;\n"
    "  lit = Lit(mat3(X_WM) * normal);\n"
    "  nearness = Nearness(p_W);\n"
    "  gl_Position = clip_from_world * p;\n"
    "}\n";

const char* const kRigidFragmentShader =
    "#version 330 core\n"
    "in vec3 p_W;\n"
    "in float lit;\n"
    "in float nearness;\n"
    "uniform vec3 rgb;\n"
    "uniform float mottle;\n"
    "uniform float darkest;\n" GUSSET_GROUND
    "out vec4 color;\n"
    "void main() {\n"
    "  vec2 here = Ground(p_W);\n"
    "  float shade = darkest + (1.0 - darkest) * lit * here.x;\n"
    "  color = vec4(rgb * (nearness * shade * (1.0 + mottle * here.y)), 1.0);\n"
    "}\n";

const char* const kClothVertexShader =
    "#version 330 core\n"
    "in vec3 position;\n"
    "in vec3 normal;\n"
    "in vec3 uv_layer;\n"
    "uniform float offset;\n"  // the shell's side: plus or minus half the thickness
    "uniform vec2 extent;\n"
    "uniform mat4 clip_from_world;\n" GUSSET_NEARNESS
    "out vec3 p_W;\n"
    "out vec3 n_W;\n"
    "out vec3 texel;\n"
    "out float nearness;\n"
    "void main() {\n"
    "  p_W = position + offset * normal;\n"
    "  n_W = sign(offset) * normal;\n"
    "  texel = vec3(uv_layer.xy / extent, uv_layer.z);\n"
    "  nearness = Nearness(p_W);\n"
    "  gl_Position = clip_from_world * vec4(p_W, 1.0);\n"
    "}\n";

const char* const kClothFragmentShader =
    "#version 330 core\n"
    "in vec3 p_W;\n"
    "in vec3 n_W;\n"
    "in vec3 texel;\n"
    "in float nearness;\n"
    "uniform vec3 gain;\n"
    "uniform float darkest;\n"
    "uniform sampler2DArray weave;\n" GUSSET_LIT GUSSET_GROUND
    "out vec4 color;\n"
    "void main() {\n"
    // The mesh is coarse; normals taken per pixel make it look as smooth as the cloth is.
    "  float shade = darkest + (1.0 - darkest) * Lit(normalize(n_W)) * Ground(p_W).x;\n"
    "  color = vec4(texture(weave, texel).rgb * gain * (nearness * shade), 1.0);\n"
    "}\n";

const char* const kHeightVertexShader =
    "#version 330 core\n"
    "in vec3 position;\n"
    "uniform mat4 X_WM;\n"
    "uniform mat4 clip_from_world;\n"
    "void main() { gl_Position = clip_from_world * (X_WM * vec4(position, 1.0)); }\n";

const char* const kHeightFragmentShader =
    "#version 330 core\n"
    "void main() {}\n";

#undef GUSSET_LIT
#undef GUSSET_NEARNESS
#undef GUSSET_GROUND

}  // namespace gusset
