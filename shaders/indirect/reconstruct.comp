#version 460
#extension GL_GOOGLE_include_directive : require
// Indirect light for all pixels from those that followed their paths. With kReuse a pixel takes its neighbours' rays as if it had
// drawn them itself: each counts with the pixel's own BRDF over the density with which it was drawn, and their sum is over that of
// the weights [Stachowiak 2015, Stochastic screen-space reflections, as PICA PICA's reflections use it; a ratio of two means, so
// biased]. Without, it takes what the neighbours made of their rays, by how alike the surfaces are [joint bilateral upsampling, Kopf et
// al. 2007]. Light is over albedo, by lobe, so textures stay sharp.
#include "lib/indirect.glsl"
#include "svgf/signals.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 56) const bool kReuse = true;

const int kRadius = 2;             // blocks: 25 rays
const float kSigmaPixels = 3.0;
const float kMostWeight = 16.0;    // of one ray: BRDF over density
const float kUnlike = 1e-4;        // weight of surfaces that are none of the pixel's, for where there are no others
const int kLog2SigmaNormalOfRays = 3;  // 8: a ray that another normal has drawn is as good a ray

// How alike the surfaces are that two pixels show. Rays may come from surfaces of other normals: the BRDF judges them.
float likeness(SurfaceTexel here, SurfaceTexel there, float gradient, float pixels) {
  if (!kReuse) return geometryWeight(here, there, gradient, pixels);
  if (there.depth == 0.0 || here.mirrored != there.mirrored) return 0.0;
  float alike = max(cosine(here, there), 0.0);
  for (int i = 0; i < kLog2SigmaNormalOfRays; ++i) alike *= alike;
  const float tolerance = kSigmaDepth * gradient * pixels + 1e-3 * here.depth;
  return alike * exp(-abs(here.depth - there.depth) / tolerance);
}

// The shape of both lobes towards `wi`, world space: |cos| / pi, and D G2 / (4 cos_o).
vec2 lobes(vec3 normal, vec3 view, float alpha, vec3 wi) {
  const float cos_i = dot(normal, wi);
  if (cos_i <= 0.0) return vec2(0.0);
  const mat3 to_world = basis(normal);
  const vec3 local_o = view * to_world, local_i = wi * to_world;
  const float cos_o = max(local_o.z, 1e-3);
  if (alpha <= 0.0) return vec2(cos_i * kInvPi, 0.0);
  const vec3 o = vec3(local_o.xy, cos_o);
  return vec2(cos_i * kInvPi, ggxD(normalize(o + local_i), alpha) * smithG2(o, local_i, alpha) / (4.0 * cos_o));
}

LobeLight reconstructed(ivec2 pixel, SurfaceTexel here) {
  IndirectTable table = IndirectTable(frame.indirect);
  const IndirectSample own = table.items[indirectIndex(uvec2(pixel))];
  const vec3 view = octahedral(own.view), normal = normalOf(here);
  const float gradient = imageLoad(images_rgba16f[history.motion], pixel).w;
  LobeLight sum = LobeLight(vec3[](vec3(0.0), vec3(0.0)), vec2(0.0));  // deviation: sums of weights
  const ivec2 block = pixel / ivec2(kIndirectBlock);
  for (int y = -kRadius; y <= kRadius; ++y)
    for (int x = -kRadius; x <= kRadius; ++x) {
      const ivec2 at_block = block + ivec2(x, y);
      if (any(lessThan(at_block, ivec2(0)))) continue;
      const ivec2 at = ivec2(tracedPixel(uvec2(at_block)));
      if (!inPicture(at) || at / ivec2(kIndirectBlock) != at_block) continue;
      const IndirectSample ray = table.items[indirectIndex(uvec2(at))];
      if (ray.pdf == 0.0 || (kReuse && ray.pdf < 0.0)) continue;
      const SurfaceTexel there = readSurface(history.surface, at);
      const float pixels = distance(vec2(at), vec2(pixel));
      float w = at == pixel ? 1.0 : max(likeness(here, there, gradient, pixels), there.depth > 0.0 ? kUnlike : 0.0);
      w *= exp(-pixels * pixels / (2.0 * kSigmaPixels * kSigmaPixels));
      if (w <= 0.0) continue;
      const vec3 light = ray.pdf > 0.0 ? unpackLight(ray.light) : vec3(0.0);
      if (kReuse) {
        const vec2 weights = w * min(lobes(normal, view, own.alpha, octahedral(ray.direction)) / ray.pdf, vec2(kMostWeight));
        for (uint s = 0u; s < kSignals; ++s) sum.rgb[s] += weights[s] * light;
        sum.deviation += weights;
      } else {
        const vec2 weights = ray.pdf > 0.0 ? unpackHalf2x16(ray.weights) : vec2(0.0);
        for (uint s = 0u; s < kSignals; ++s) sum.rgb[s] += w * weights[s] * light;
        sum.deviation += w;
      }
    }
  for (uint s = 0u; s < kSignals; ++s) sum.rgb[s] = sum.deviation[s] > 0.0 ? sum.rgb[s] / sum.deviation[s] : vec3(0.0);
  return sum;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inPicture(pixel)) return;
  const SurfaceTexel here = readSurface(history.surface, pixel);
  LobeLight light = sampledLight(pixel);
  vec3 radiance = unpackLight(imageLoad(images_r32ui[history.emission], pixel).x);
  if (here.depth > 0.0) {
    const LobeLight indirect = reconstructed(pixel, here);
    for (uint s = 0u; s < kSignals; ++s) light.rgb[s] += indirect.rgb[s];
    imageStore(images_rg32ui[history.sampled], pixel, uvec4(packLight(stored(light.rgb[0])), packLight(stored(light.rgb[1])), 0u, 0u));
    const uvec2 albedos = imageLoad(images_rg32ui[history.albedos], pixel).xy;
    if (albedos.x != 0u) radiance += unpackAlbedo(albedos.x) * light.rgb[0] + unpackAlbedo(albedos.y) * light.rgb[1];
  }
  const float kept = imageLoad(images_rgba32f[frame.radiance], pixel).a;
  imageStore(images_rgba32f[frame.radiance], pixel, vec4(radiance / history.unit, kept));
}
