#pragma once

namespace gusset {

/// Acceleration of free fall, m/s^2, everywhere: what falls, what the arm carries, what is weighed.
/// To three digits that of mid-latitudes (the standard one is 9.80665; 3rd CGPM, 1901).
inline constexpr double kGravity_m_s2 = 9.81;

}  // namespace gusset
