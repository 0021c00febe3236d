// For path_trace.rgen: light of the sun, which denoisers do not see where it shines on the surface that the path shows.

// As if no shadow map stood in its way; without roulette, to be known whole.
Connection connectOpenSun(Path path, Surface s, vec3 wo) {
  const vec3 wi = sampleSun(random2(kSunPoint));
  if (!leaves(s, wi)) return kNoConnection;
  float weight;
  const vec3 f = lightSampleBsdf(s.bsdf, wo, wi * s.frame_, sunPdf(), weight);
  return Connection(wi, kFar, path.throughput * f * frame.sun_radiance * (weight / sunPdf()), diffuseShare(s.bsdf, wo, wi * s.frame_, f));
}

Connection connectSun(Path path, Surface s, vec3 wo) {
  const Connection c = connectOpenSun(path, s, wo);
  const float through = kUsesShadowMap ? sunThroughMap(s.position, s.geometric_normal) : 1.0;
  return connection(c.direction, c.distance, c.contribution * through, c.diffuse_share, kSunRoulette);
}

// The sun's light on the surface that the path shows: what is open to it, and what of it arrives, go their own ways.
void resolveSun(inout Path path, vec3 normal, Connection open, float through) {
  float arrived = maxComponent(open.contribution) <= 0.0 ? 0.0 : through;
  if (arrived > 0.0 && kSunShadow != kSunShadowMap) {
    countShadowRay(path);
    logRay(kRayShadow, path.origin, open.direction, open.distance);
    if (!arrives(path, open)) arrived = 0.0;
  }
  path.radiance += arrived * open.contribution;
  const float cosine = dot(frame.sun_to, normal), sampled_cosine = dot(open.direction, normal);
  storeSunlight(ivec2(pixel_), open.contribution, open.diffuse_share, cosine > 0.0 && sampled_cosine > 0.0 ? cosine / sampled_cosine : 1.0, arrived);
}
