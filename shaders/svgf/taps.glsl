// What the taps of a group of pixels find, unpacked once into shared memory. Pixels of a group are kStride apart, so their taps are
// the same few; groups beside each other take the pixels in between (render/passes/svgf.cpp). Who includes it says kGroup, pixels a
// side, kStride, and kMargin, how many taps go beyond the group.
#ifndef HELIO_SVGF_TAPS_GLSL
#define HELIO_SVGF_TAPS_GLSL
#include "svgf/filter.glsl"

const int kColumns = kGroup + 2 * kMargin, kTaps = kColumns * kColumns;

// The less they take the more groups find room at a time. Light loses nothing in 16-bit floats; normals do, but those of a plane all
// the same.
shared float depths[kTaps];            // 0: nothing is there; negative: in a mirror
shared uvec2 surfaces[kTaps];          // packHalf4(): normal
shared uvec2 lights[kSignals][kTaps];  // packHalf4(); a: standard deviation of its luminance

// The pixel of a point in the group's lattice.
ivec2 pixelOf(ivec2 point) {
  const ivec2 group = ivec2(gl_WorkGroupID.xy);
  return (group / kStride * kGroup + point) * kStride + group % kStride;
}
// Of that point; steps of a tap are 1 and kColumns.
int tapOf(ivec2 point) { return (point.y + kMargin) * kColumns + point.x + kMargin; }

void fetchTaps() {
  for (int i = int(gl_LocalInvocationIndex); i < kTaps; i += kGroup * kGroup) {
    const ivec2 at = pixelOf(ivec2(i % kColumns, i / kColumns) - kMargin);
    depths[i] = 0.0;
    if (!inPicture(at)) continue;
    const SurfaceTexel t = readSurface(history.surface, at);
    const LobeLight l = readLight(filter_.source, filter_.source_deviation, at);
    surfaces[i] = packHalf4(vec4(normalOf(t), 0.0));
    depths[i] = t.mirrored ? -t.depth : t.depth;
    for (uint s = 0u; s < kSignals; ++s) lights[s][i] = packHalf4(vec4(l.rgb[s], l.deviation[s]));
  }
  barrier();
}

vec2 luminancesOf(int tap) { return vec2(luminance(unpackHalf4(lights[0][tap]).rgb), luminance(unpackHalf4(lights[1][tap]).rgb)); }

// Taps that weigh less than this for their surface alone may be left out, before their light is looked at.
const float kLeastAlike = 1e-3, kMostApart = 7.0;  // exp(-7) = 1e-3

// How alike the surfaces of two taps are, as geometryWeight() has it: normals * exp(-apart). Of a product of
// exponentials, the exponents' sum; who has another factor adds its own.
struct Likeness {
  float normals;  // 0: not at all
  float apart;
};
bool counts(Likeness l) { return l.normals >= kLeastAlike && l.apart <= kMostApart; }

// `surface`, `depth`: of one tap, unpacked; `there`: the other. `gradient`: of depth, metres a tap; `taps` apart.
Likeness likeness(vec4 surface, float depth, int there, float gradient, float taps) {
  const vec4 other = unpackHalf4(surfaces[there]);
  const float other_depth = depths[there];
  float alike = max(dot(surface.xyz, other.xyz), 0.0);
  for (int i = 0; i < kLog2SigmaNormal; ++i) alike *= alike;
  // Around a ball of mirror the ground that it shows lies as the ground itself does, and has another light.
  return Likeness(depth * other_depth > 0.0 ? alike : 0.0,
                  abs(depth - other_depth) / depthTolerance(abs(depth), gradient, taps));
}

#endif
