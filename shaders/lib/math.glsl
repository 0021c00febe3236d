#ifndef HELIO_MATH_GLSL
#define HELIO_MATH_GLSL

const float kPi = 3.14159265358979;
const float kInvPi = 0.318309886183791;
const float kFar = 1e30;  // beyond all surfaces

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }
float maxComponent(vec3 c) { return max(c.x, max(c.y, c.z)); }
bool finite3(vec3 v) { return !(any(isnan(v)) || any(isinf(v))); }

// Orthonormal basis around n [Duff et al. 2017]: columns are tangent, bitangent, n.
mat3 basis(vec3 n) {
  const float s = n.z >= 0.0 ? 1.0 : -1.0;
  const float a = -1.0 / (s + n.z);
  const float b = n.x * n.y * a;
  return mat3(vec3(1.0 + s * n.x * n.x * a, s * b, -s * n.x), vec3(b, s + n.y * n.y * a, -n.y), n);
}

// Unit vector from an octahedral snorm16 pair [Cigolle et al. 2014].
vec3 octahedral(uint packed) {
  const vec2 e = unpackSnorm2x16(packed);
  vec3 v = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (v.z < 0.0) v.xy = (1.0 - abs(v.yx)) * vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0);
  return normalize(v);
}

// Moves a ray's origin off the surface by some units in the last place of its coordinates, so that the offset scales with
// their magnitude [Waechter and Binder 2019, Ray Tracing Gems, ch. 6]. That bounds the error of `p` itself; the intersector's
// grows with the triangle's coordinates, `reach` at most, however small p's are (a point at the middle of a 1 km plane).
vec3 offsetOrigin(vec3 p, vec3 n, float reach) {
  p += n * (reach * 5e-7);
  const float kOrigin = 1.0 / 32.0;
  const float kFloatScale = 1.0 / 65536.0;
  const float kIntScale = 256.0;
  const ivec3 of_i = ivec3(kIntScale * n);
  const vec3 p_i = vec3(intBitsToFloat(floatBitsToInt(p.x) + (p.x < 0.0 ? -of_i.x : of_i.x)),
                        intBitsToFloat(floatBitsToInt(p.y) + (p.y < 0.0 ? -of_i.y : of_i.y)),
                        intBitsToFloat(floatBitsToInt(p.z) + (p.z < 0.0 ? -of_i.z : of_i.z)));
  return vec3(abs(p.x) < kOrigin ? p.x + kFloatScale * n.x : p_i.x, abs(p.y) < kOrigin ? p.y + kFloatScale * n.y : p_i.y,
              abs(p.z) < kOrigin ? p.z + kFloatScale * n.z : p_i.z);
}

vec3 cosineHemisphere(vec2 u) {
  const float r = sqrt(u.x);
  const float phi = 2.0 * kPi * u.y;
  return vec3(r * cos(phi), r * sin(phi), sqrt(max(0.0, 1.0 - u.x)));
}

#endif
