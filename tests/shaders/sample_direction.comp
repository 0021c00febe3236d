#version 460
#extension GL_GOOGLE_include_directive : require
// Draws one direction an item by one of the library's samplers.
#include "probe.glsl"
#include "lib/bsdf.glsl"
#include "lib/sky.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { DirectionQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { DirectionDrawn items[]; };

DirectionDrawn draw(vec3 wo, vec3 u) {
  DirectionDrawn drawn = DirectionDrawn(vec3(0.0), 0.0, vec3(0.0));
  if (probe.routine == kSampleBsdf) {
    BsdfSample s;
    if (sampleBsdf(makeBsdf(probe.base, probe.metallic, probe.roughness, probe.lambert != 0u, kIor15), wo, u, s))
      drawn = DirectionDrawn(s.wi, s.mirror ? -1.0 : s.pdf, s.weight);
  } else if (probe.routine == kSampleVisibleNormal) {
    drawn = DirectionDrawn(sampleVisibleNormal(wo, probe.roughness * probe.roughness, u.xy), 1.0, vec3(1.0));
  } else if (probe.routine == kSampleCosine) {
    drawn = DirectionDrawn(cosineHemisphere(u.xy), 1.0, vec3(1.0));
  } else if (probe.routine == kSampleSky) {
    const vec3 wi = sampleSky(u.xy, wo);
    drawn = DirectionDrawn(wi, skyPdf(wi, wo), vec3(1.0));
  } else {
    drawn = DirectionDrawn(sampleSun(u.xy), sunPdf(), vec3(1.0));
  }
  return drawn;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  Answers(probe.answers).items[i] = draw(Questions(probe.questions).items[i].wo, RandomTable(probe.randoms).items[i].a.xyz);
}
