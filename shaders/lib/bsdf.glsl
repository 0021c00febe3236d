// glTF's metallic-roughness material: Lambert under a GGX lobe, or plain Lambert. All directions in the shading frame
// (z = shading normal), pointing away from the surface; wo.z > 0.
//   f = T(cos_o) T(cos_i) / T_mean (1 - metallic) base / pi + F D G2 / (4 cos cos)
// glTF 2.0, appendix B, writes 1 - F(wo . h) for the first factor, as an example of a mix: with it a white base under a coat
// reflects up to 1.7 of the light at grazing views. Here the base gets what the coat lets through [Kelemen and Szirmay-Kalos
// 2001]: T = 1 - E, E the coat's directional albedo, T_mean its cosine-weighted mean. That is reciprocal, and loses nothing.
// Under a tinted specular lobe T is the least of its channels, lest what remains take on the complementary colour
// [KHR_materials_specular].
// D: GGX; G2: height-correlated Smith; sampled by visible normals [Heitz 2018].
#ifndef HELIO_BSDF_GLSL
#define HELIO_BSDF_GLSL
#include "lib/effects.glsl"
#include "lib/math.glsl"

// Below this alpha the lobe is a mirror: a GGX peak that narrow has no digits left in floats.
const float kMirrorAlpha = 1e-3;

struct Bsdf {
  vec3 diffuse;   // albedo of the Lambert part before (1 - F)
  vec3 f0;
  float f90;      // 1 without kSpecular
  float alpha;    // roughness^2
  vec2 coat;      // power and scale of coatAlbedo
  bool tinted;    // false without kSpecular
  bool specular;  // has the GGX lobe at all
  bool mirror;    // the lobe is a delta
  vec3 compensation;  // factor on the GGX lobe; 1: single scattering
};

struct BsdfSample {
  vec3 wi;
  vec3 weight;   // f cos / pdf
  float pdf;     // per steradian; 0 with mirror
  bool mirror;
};

// Reflectance of a dielectric along its normal and at grazing angles, [0, 1].
struct Dielectric {
  vec3 f0;
  float f90;
  bool tinted;
};
const Dielectric kIor15 = Dielectric(vec3(0.04), 1.0, false);

Bsdf makeBsdf(vec3 base, float metallic, float roughness, bool lambert, Dielectric dielectric) {
  Bsdf b;
  b.specular = !lambert;
  b.diffuse = lambert ? base : base * (1.0 - metallic);
  b.f0 = mix(dielectric.f0, base, metallic);
  b.f90 = mix(dielectric.f90, 1.0, metallic);
  b.tinted = dielectric.tinted;
  b.coat = vec2(5.0 / (1.0 + 1.74 * roughness), 1.0 / (1.0 + 24.3 * pow(roughness, 2.47)));
  b.alpha = max(roughness * roughness, kMirrors ? 0.0 : kMirrorAlpha);
  b.mirror = kMirrors && b.specular && b.alpha < kMirrorAlpha;
  b.compensation = vec3(1.0);
  return b;
}

// Path-space regularisation: no lobe is narrower than `alpha`. Biased [Kaplanyan and Dachsbacher 2013].
void regularise(inout Bsdf b, float alpha) {
  b.alpha = max(b.alpha, alpha);
  b.mirror = b.mirror && b.alpha < kMirrorAlpha;
}

// Factor that gives a GGX lobe back what it loses by scattering only once; `albedo`: what a lobe of reflectance 1 keeps, seen
// from the same direction [Turquin 2019, Practical multiple scattering compensation for microfacet models, eq. 16].
vec3 compensation(Bsdf b, float albedo) { return b.mirror ? vec3(1.0) : 1.0 + b.f0 * ((1.0 - albedo) / albedo); }

vec3 fresnel(Bsdf b, float cos_theta) {
  const float f90 = kSpecular ? b.f90 : 1.0;
  const float m = clamp(1.0 - cos_theta, 0.0, 1.0);
  const float m2 = m * m;
  return b.f0 + (f90 - b.f0) * (m2 * m2 * m);
}

// Directional albedo of the GGX lobe, f0 + (f90 - f0) S. S, the mean of (1 - wo . h)^5 over the normals seen, is a fit to the
// integral: at most 0.008 below it, and exact for mirrors (tests/statistics, Bsdf.CoatAlbedoIsFitted).
vec3 coatAlbedo(Bsdf b, float grazing) { return b.f0 + ((kSpecular ? b.f90 : 1.0) - b.f0) * grazing; }
vec3 transmitted(Bsdf b, vec3 albedo) { return kSpecular && b.tinted ? vec3(1.0 - maxComponent(albedo)) : 1.0 - albedo; }
// What the coat lets through on the way from or to a direction.
vec3 transmitted(Bsdf b, float cos_theta) {
  return transmitted(b, coatAlbedo(b, b.coat.y * pow(clamp(1.0 - cos_theta, 0.0, 1.0), b.coat.x)));
}
// What the base shows of its own albedo under the coat.
vec3 underCoat(Bsdf b, float cos_o, float cos_i) {
  // The mean of (1 - cos)^n over the hemisphere, weighted by the cosine, is 2 / ((n + 1) (n + 2)).
  const float n = b.coat.x;
  const vec3 mean = transmitted(b, coatAlbedo(b, b.coat.y * 2.0 / ((n + 1.0) * (n + 2.0))));
  return transmitted(b, cos_o) * transmitted(b, cos_i) / max(mean, vec3(1e-4));
}

float ggxD(vec3 h, float alpha) {
  const vec2 s = h.xy / alpha;
  const float d = dot(s, s) + h.z * h.z;
  return 1.0 / (kPi * alpha * alpha * d * d);
}
float smithLambda(vec3 w, float alpha) {
  const float cos2 = w.z * w.z;
  const float tan2 = max(0.0, 1.0 - cos2) / max(cos2, 1e-12);
  return 0.5 * (sqrt(1.0 + alpha * alpha * tan2) - 1.0);
}
float smithG1(vec3 w, float alpha) { return 1.0 / (1.0 + smithLambda(w, alpha)); }
float smithG2(vec3 wo, vec3 wi, float alpha) { return 1.0 / (1.0 + smithLambda(wo, alpha) + smithLambda(wi, alpha)); }

// Normal visible from wo [Heitz 2018, listing 1].
vec3 sampleVisibleNormal(vec3 wo, float alpha, vec2 u) {
  const vec3 v = normalize(vec3(alpha * wo.xy, wo.z));
  const float length2 = dot(v.xy, v.xy);
  const vec3 t1 = length2 > 1e-14 ? vec3(-v.y, v.x, 0.0) * inversesqrt(length2) : vec3(1.0, 0.0, 0.0);
  const vec3 t2 = cross(v, t1);
  const float r = sqrt(u.x);
  const float phi = 2.0 * kPi * u.y;
  const float p1 = r * cos(phi);
  const float s = 0.5 * (1.0 + v.z);
  const float p2 = mix(sqrt(max(0.0, 1.0 - p1 * p1)), r * sin(phi), s);
  const vec3 n = p1 * t1 + p2 * t2 + sqrt(max(0.0, 1.0 - p1 * p1 - p2 * p2)) * v;
  return normalize(vec3(alpha * n.xy, max(1e-7, n.z)));
}

// Probability of sampling the specular lobe: its share of what is reflected about.
float specularProbability(Bsdf b, vec3 wo) {
  if (!b.specular) return 0.0;
  const float s = maxComponent(fresnel(b, wo.z));
  const float d = maxComponent(b.diffuse * transmitted(b, wo.z));
  if (kSpecular && s <= 0.0) return 0.0;
  return d <= 0.0 ? 1.0 : clamp(s / (s + d), 0.1, 0.9);
}

// f(wo, wi) |cos wi| of everything but a mirror, and the density with which sampleBsdf draws wi.
vec3 evaluateBsdf(Bsdf b, vec3 wo, vec3 wi, out float pdf) {
  pdf = 0.0;
  if (wi.z <= 0.0 || wo.z <= 0.0) return vec3(0.0);
  const float p = specularProbability(b, wo);
  if (!b.specular) {
    pdf = wi.z * kInvPi;
    return b.diffuse * pdf;
  }
  const vec3 h = normalize(wo + wi);
  const vec3 f = fresnel(b, dot(wo, h));
  const float diffuse_pdf = wi.z * kInvPi;
  vec3 value = underCoat(b, wo.z, wi.z) * b.diffuse * diffuse_pdf;
  pdf = (1.0 - p) * diffuse_pdf;
  if (!b.mirror) {
    const float d = ggxD(h, b.alpha);
    value += b.compensation * f * (d * smithG2(wo, wi, b.alpha) / (4.0 * wo.z));
    pdf += p * (d * smithG1(wo, b.alpha) / (4.0 * wo.z));
  }
  return value;
}

// Draws wi. False: the sample carries nothing (below the horizon).
bool sampleBsdf(Bsdf b, vec3 wo, vec3 u, out BsdfSample s) {
  const float p = specularProbability(b, wo);
  s.mirror = false;
  if (u.z < p) {
    if (b.mirror) {
      s.wi = vec3(-wo.xy, wo.z);
      s.weight = fresnel(b, wo.z) / p;
      s.pdf = 0.0;
      s.mirror = true;
      return true;
    }
    s.wi = reflect(-wo, sampleVisibleNormal(wo, b.alpha, u.xy));
  } else {
    s.wi = cosineHemisphere(u.xy);
  }
  const vec3 value = evaluateBsdf(b, wo, s.wi, s.pdf);
  if (!(s.pdf > 0.0)) return false;
  s.weight = value / s.pdf;
  return true;
}

#endif
