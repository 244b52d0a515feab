#pragma once

namespace gusset {

/// GLSL 3.30 sources. Brightness is a + (1 - a) * lit, lit in 0..1, so no shade is darker than
/// a = 1 - contrast: perception's colour bounds can count on that.
extern const char* const kRigidVertexShader;
extern const char* const kRigidFragmentShader;
extern const char* const kClothVertexShader;
extern const char* const kClothFragmentShader;
/// Writes heights above the table into the depth buffer, sheared along the light.
extern const char* const kHeightVertexShader;
extern const char* const kHeightFragmentShader;

}  // namespace gusset
