// For path_trace.rgen: light from the sky in the place of what was scattered diffusely.

// Ambient occlusion: the sky's light by the diffuse lobe, unless something stands in its way within a radius.
Connection connectAmbient(Path path, Surface s, vec3 wo) {
  const vec3 local = cosineHemisphere(random2(kAmbientDirection)), wi = s.frame_ * local;
  if (!leaves(s, wi)) return kNoConnection;
  const vec3 reflected = s.bsdf.specular ? underCoat(s.bsdf, wo.z, local.z) * s.bsdf.diffuse : s.bsdf.diffuse;
  const vec3 contribution = path.throughput * reflected * skyRadiance(wi);
  // Where it goes apart a sample tells of the sky, and roulette must not.
  if (kAmbientApart && vertex_ == shown_vertex_) return Connection(wi, frame.ambient_radius, contribution, 0u);
  return connection(wi, frame.ambient_radius, contribution, packShare(vec3(1.0)), kAmbientRoulette);
}

// The same as if nothing stood in its way: what needs no ray. The mean over directions of what the coat lets through is in the
// sky's mean.
Connection openAmbient(Path path, Surface s, vec3 wo) {
  const vec3 reflected = s.bsdf.specular ? transmitted(s.bsdf, wo.z) * s.bsdf.diffuse : s.bsdf.diffuse;
  return Connection(s.frame_[2], kFar, path.throughput * reflected * openSky(s.frame_[2]), packShare(vec3(1.0)));
}

// What the coat leaves of it, [0, 1]; 0: there is no diffuse lobe.
float throughCoat(Surface s, vec3 wo) {
  if (maxComponent(s.bsdf.diffuse) < kLeastAlbedo) return 0.0;
  return s.bsdf.specular ? luminance(transmitted(s.bsdf, wo.z)) : 1.0;
}

// Whether the sky is seen goes its own way, as what stands before the sun does.
void resolveAmbient(inout Path path, Connection ambient, float through) {
  bool open = maxComponent(ambient.contribution) > 0.0;
  if (open) {
    countShadowRay(path);
    logRay(kRayShadow, path.origin, ambient.direction, ambient.distance);
    open = arrives(path, ambient);
  }
  if (open) path.radiance += ambient.contribution;
  storeOcclusion(ivec2(pixel_), open, through);
}

// Light without noise, which no filter need see.
void receiveExactly(inout Path path, Connection c) {
  path.radiance += c.contribution;
  split_.emission += c.contribution;
}
