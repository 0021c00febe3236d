// Set 0: every texture and storage image of the process (gpu::Bindless).
#ifndef HELIO_BINDLESS_GLSL
#define HELIO_BINDLESS_GLSL
#extension GL_EXT_nonuniform_qualifier : require

layout(set = 0, binding = 0) uniform sampler2D textures[];
layout(set = 0, binding = 1, rgba32f) uniform image2D images_rgba32f[];
layout(set = 0, binding = 1, rgba16f) uniform image2D images_rgba16f[];
layout(set = 0, binding = 1, rg16f) uniform image2D images_rg16f[];
layout(set = 0, binding = 1, rg8) uniform image2D images_rg8[];
layout(set = 0, binding = 1, rg32ui) uniform uimage2D images_rg32ui[];
layout(set = 0, binding = 1, r32ui) uniform uimage2D images_r32ui[];

#endif
