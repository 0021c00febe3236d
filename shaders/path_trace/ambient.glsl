// For path_trace.rgen: light from the sky in the place of what was scattered diffusely.

// Ambient occlusion: the sky's light by the diffuse lobe, unless something stands in its way within a radius.
Connection connectAmbient(Path path, Surface s, vec3 wo) {
  const vec3 local = cosineHemisphere(random2(kAmbientDirection)), wi = s.frame_ * local;
  if (!leaves(s, wi)) return kNoConnection;
  const vec3 reflected = s.bsdf.specular ? underCoat(s.bsdf, wo.z, local.z) * s.bsdf.diffuse : s.bsdf.diffuse;
  return connection(wi, frame.ambient_radius, path.throughput * reflected * skyRadiance(wi), packShare(vec3(1.0)), kAmbientRoulette);
}

// The same as if nothing stood in its way: what needs no ray. The mean over directions of what the coat lets through is in the
// sky's mean.
Connection openAmbient(Path path, Surface s, vec3 wo) {
  const vec3 reflected = s.bsdf.specular ? transmitted(s.bsdf, wo.z) * s.bsdf.diffuse : s.bsdf.diffuse;
  return Connection(s.frame_[2], kFar, path.throughput * reflected * openSky(s.frame_[2]), packShare(vec3(1.0)));
}
