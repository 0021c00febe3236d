// Sun and gradient sky for a height of the sun above the horizon.
#include <algorithm>
#include <array>
#include <cmath>

#include "scene/city.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

/// The sky at one height of the sun. `horizon` is what is seen at eye level.
struct SkyKey {
  float sine;        ///< of the sun's elevation
  glm::vec3 zenith;  ///< W/(sr m^2)
  glm::vec3 horizon;
};

// Night, end of civil twilight, sunrise, 4 degrees, 15 degrees, high sun.
constexpr std::array<SkyKey, 6> kSky = {{
    {-0.25f, {0.0035f, 0.0055f, 0.013f}, {0.005f, 0.007f, 0.014f}},
    {-0.10f, {0.012f, 0.020f, 0.050f}, {0.045f, 0.036f, 0.050f}},
    {0.00f, {0.055f, 0.080f, 0.170f}, {0.34f, 0.20f, 0.13f}},
    {0.07f, {0.115f, 0.165f, 0.320f}, {0.56f, 0.38f, 0.24f}},
    {0.26f, {0.28f, 0.43f, 0.80f}, {0.62f, 0.68f, 0.76f}},
    {0.87f, {0.42f, 0.70f, 1.32f}, {0.76f, 0.93f, 1.20f}},
}};

}  // namespace

Environment daylight(float elevation, float azimuth) {
  constexpr double kTurnsPerRadian = 0.15915494309189535;
  const glm::vec2 up = unitVector(static_cast<double>(elevation) * kTurnsPerRadian);
  const glm::vec2 around = unitVector(static_cast<double>(azimuth) * kTurnsPerRadian);
  const float sine = up.y;

  Environment environment;
  environment.sun.direction = -glm::normalize(glm::vec3(up.x * around.y, up.y, up.x * around.x));
  // Extinction along the path through the air, fitted to clear-sky irradiance at 60 and at 4 degrees.
  const float air = 1.0f / (std::max(sine, 0.0f) + 0.05f);
  const glm::vec3 thickness = 1.0f + air * glm::vec3(0.31f, 0.716f, 4.6f);
  const float risen = glm::smoothstep(-0.005f, 0.06f, sine);
  environment.sun.irradiance =
      sine > -0.005f ? risen * glm::vec3(35.8f, 60.2f, 614.0f) / (thickness * thickness) : glm::vec3(0.0f);
  environment.sun.angular_diameter = 0.0093f;

  size_t next = 1;
  while (next + 1 < kSky.size() && kSky[next].sine < sine) ++next;
  const SkyKey &low = kSky[next - 1], &high = kSky[next];
  const float t = std::clamp((sine - low.sine) / (high.sine - low.sine), 0.0f, 1.0f);
  const glm::vec3 zenith = glm::mix(low.zenith, high.zenith, t), horizon = glm::mix(low.horizon, high.horizon, t);
  environment.sky.zenith = zenith;
  environment.sky.ground = glm::max(2.0f * horizon - zenith, glm::vec3(0.0f));  // the gradient's middle is the horizon
  return environment;
}

}  // namespace helio::scene
