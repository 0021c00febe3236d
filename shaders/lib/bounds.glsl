// Bounding spheres of instances.
#ifndef HELIO_BOUNDS_GLSL
#define HELIO_BOUNDS_GLSL
#include "shared/scene.h"

// The largest stretch of an instance's transform is no more than this [Gershgorin]; exact where its axes are perpendicular.
float largestStretch(InstanceRecord instance) {
  const mat3 rows = mat3(instance.rows[0].xyz, instance.rows[1].xyz, instance.rows[2].xyz);
  const mat3 gram = rows * transpose(rows);
  return sqrt(max(max(dot(abs(gram[0]), vec3(1.0)), dot(abs(gram[1]), vec3(1.0))), dot(abs(gram[2]), vec3(1.0))));
}

vec3 placed(InstanceRecord instance, vec3 p) {
  const vec4 h = vec4(p, 1.0);
  return vec3(dot(instance.rows[0], h), dot(instance.rows[1], h), dot(instance.rows[2], h));
}

#endif
