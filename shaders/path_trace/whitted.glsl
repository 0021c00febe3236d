// Whitted's ray tracing [Whitted 1980; Lipp 2021, section 2.1.1 and algorithm 2.1], for path_trace.rgen: at each vertex the light of
// points in the middle of sun and lamps, where nothing stands in its way, and one reflected ray from what shines. Nothing is left to
// chance, so two pictures of one moment are the same to the bit. Whatever its extent, a lamp's shadow is hard.

// Smoother surfaces reflect a ray, with all light that their lobe has; rougher ones show the lights' highlights.
const float kSharpAlpha = 0.0625;  // perceptual roughness 0.25
// A ray that adds less is not followed [Hall and Greenberg 1983, adaptive tree depth].
const float kFaintRay = 0.01;

bool reflectsSharply(Bsdf b) { return b.specular && b.alpha <= kSharpAlpha; }

// f |cos| of what is not left to the reflected ray.
vec3 localBsdf(Bsdf b, vec3 wo, vec3 wi) {
  float pdf;
  const vec3 f = evaluateBsdf(b, wo, wi, pdf);
  return reflectsSharply(b) ? max(f - evaluateBsdf(glossyPart(b), wo, wi, pdf), vec3(0.0)) : f;
}

// The lamp does not stand in its own light.
bool litBy(vec3 origin, vec3 direction, float distance, uint slot) {
  Hit hit;
  if (kCountHits) hit = traceCounted(origin, direction, distance, gl_RayFlagsNoneEXT, startSlot(vertex_), false);
  else hit = traceWithin(origin, direction, distance);
  return hit.primitive == kNothing || hit.slot == slot;
}

void addPoint(inout Path path, Surface s, vec3 wo, vec3 direction, float distance, vec3 irradiance, uint slot) {
  if (!leaves(s, direction)) return;
  const vec3 light = path.throughput * localBsdf(s.bsdf, wo, direction * s.frame_) * irradiance;
  if (!(maxComponent(light) > 0.0)) return;
  countShadowRay(path);
  if (litBy(path.origin, direction, distance, slot)) path.radiance += light;
}

// All of a lamp's light comes from the middle of it, as much to each side as the whole lamp sends there.
void addLamp(inout Path path, Surface s, vec3 wo, uint slot) {
  if (kPunctualLights && (slot & kPunctualLight) != 0u) {
    const PunctualSample light = samplePunctual(slot, path.origin);
    addPoint(path, s, wo, light.direction, light.distance, light.irradiance, kNothing);
    return;
  }
  const InstanceRecord instance = InstanceTable(frame.instances).items[slot];
  const LampShape shape = LampShapeTable(frame.lamp_shapes).items[instance.mesh];
  const vec3 to_lamp = toWorld(instance, shape.centre) - path.origin;
  const float distance2 = dot(to_lamp, to_lamp);
  if (!(distance2 > 0.0)) return;
  const vec3 direction = to_lamp * inversesqrt(distance2);
  const vec3 normal = normalize(normalToWorld(instance, shape.normal));
  // A closed convex lamp of power W shines with W / 4 to all sides, a plane with W times the cosine to both.
  const float shown = mix(0.25, abs(dot(normal, direction)), shape.flatness);
  addPoint(path, s, wo, direction, sqrt(distance2), instance.emitter_weight * shape.colour * (shown / distance2), slot);
}

// As shade(), without chance.
bool shadeWhitted(inout Path path, Surface s, vec3 origin, vec3 wo) {
  const vec3 before = path.origin;
  path.origin = origin;
  if (kAmbient == kAmbientConstant) {
    path.radiance += openAmbient(path, s, wo).contribution;
    // The lobe that shows highlights alone has no light from the sky either.
    if (s.bsdf.specular && !reflectsSharply(s.bsdf)) path.radiance += path.throughput * glossyAlbedo(s.bsdf, wo) * openSky(s.frame_[2]);
  }
  if (kSun) {
    const float through = kUsesShadowMap ? sunThroughMap(s.position, s.geometric_normal) : 1.0;
    const vec3 irradiance = frame.sun_radiance * (through / sunPdf());
    if (kSunShadow == kSunShadowMap) {
      if (leaves(s, frame.sun_to)) path.radiance += path.throughput * localBsdf(s.bsdf, wo, frame.sun_to * s.frame_) * irradiance;
    } else {
      addPoint(path, s, wo, frame.sun_to, kFar, irradiance, kNothing);
    }
  }
  if (kLamps) {
    // The lamps of the cell's list; beyond the grid, or without lists, each of the world's.
    const uint cell = lightCellOf(origin);
    const uint count = cell == kNothing ? frame.emitter_instance_count : LightCellTable(frame.light_cells).items[cell].count;
    for (uint i = 0u; i < count; ++i)
      addLamp(path, s, wo, cell == kNothing ? EmitterInstanceTable(frame.emitter_instances).items[i].slot
                                            : LightCellTable(frame.light_cells).items[cell].slots[i]);
  }

  if (!reflectsSharply(s.bsdf)) return false;
  path.throughput *= glossyAlbedo(s.bsdf, wo);
  if (!(maxComponent(path.throughput) > kFaintRay)) return false;
  path.cone_width += path.cone_spread * distance(before, s.position);
  path.direction = s.frame_ * vec3(-wo.xy, wo.z);
  path.bsdf_pdf = path.sky_pdf = 0.0;
  return leaves(s, path.direction);
}
