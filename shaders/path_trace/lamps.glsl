// For path_trace.rgen: the lamps of a path's first vertex, where it looks at more than one.

// The lamp of draw `lamp_` at the vertex; kNothing: it was looked at before.
uint lampOfDraw(vec3 origin) {
  if (lamp_draws_ > 0u) return drawLamp(origin);
  if (!kLightFeedback) return EmitterInstanceTable(frame.emitter_instances).items[lamp_].slot;
  const uint cell = lightCellOf(origin);
  if (lamp_ < foundIn(cell)) return LightCellTable(frame.light_cells).items[cell].slots[lamp_];
  const uint other = selectAnyEmitter(random2(kEmitterChoice));
  return foundFrom(origin, other) ? kNothing : other;
}

// Several lamps; or each once; or each once that the cell has found, and one of the others. Their shadow rays are traced one by one.
void connectLamps(inout Path path, Surface s, vec3 origin, vec3 wo) {
  const vec3 before = path.origin;
  path.origin = origin;
  lamp_draws_ = frame.lamp_samples;
  const uint each = kLightFeedback ? foundIn(lightCellOf(origin)) + 1u : frame.emitter_instance_count;
  const uint draws = frame.emitter_instance_count == 0u ? 0u : lamp_draws_ == 0u ? each : lamp_draws_;
  for (lamp_ = 0u; lamp_ < draws; ++lamp_) {
    const uint slot = lampOfDraw(origin);
    if (slot != kNothing) resolveLamp(path, connectLamp(path, s, origin, wo, slot, 1.0), slot);
  }
  lamp_ = 0u;
  lamp_draws_ = 1u;
  path.origin = before;
}
