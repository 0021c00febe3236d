#version 460
#extension GL_GOOGLE_include_directive : require
// The density with which sample_direction.comp draws each item's wi, as the library states it; for the BSDF also its value.
#include "probe.glsl"
#include "lib/bsdf.glsl"
#include "lib/sky.glsl"

layout(buffer_reference, scalar) readonly buffer Questions { DirectionQuestion items[]; };
layout(buffer_reference, scalar) writeonly buffer Answers { DirectionDensity items[]; };

DirectionDensity density(vec3 wo, vec3 wi) {
  DirectionDensity answer = DirectionDensity(vec3(0.0), 0.0);
  if (probe.routine == kSampleBsdf) {
    answer.value = evaluateBsdf(makeBsdf(probe.base, probe.metallic, probe.roughness, probe.lambert != 0u, kIor15), wo, wi, answer.pdf);
  } else if (probe.routine == kSampleVisibleNormal) {
    // Distribution of visible normals: G1 D (wo . h) / cos(wo) [Heitz 2018, eq. 1].
    const float alpha = probe.roughness * probe.roughness;
    if (wi.z > 0.0) answer.pdf = smithG1(wo, alpha) * ggxD(wi, alpha) * max(0.0, dot(wo, wi)) / wo.z;
  } else if (probe.routine == kSampleCosine) {
    answer.pdf = max(0.0, wi.z) * kInvPi;
  } else if (probe.routine == kSampleSky) {
    answer.pdf = skyPdf(wi, wo);
  } else {
    answer.pdf = inSunDisc(wi) ? sunPdf() : 0.0;
  }
  return answer;
}

void main() {
  const uint i = gl_GlobalInvocationID.x;
  if (i >= probe.count) return;
  const DirectionQuestion question = Questions(probe.questions).items[i];
  Answers(probe.answers).items[i] = density(question.wo, question.wi);
}
