#version 460
#extension GL_GOOGLE_include_directive : require
// Gives every young pixel its further paths, in whole numbers by chance, and counts them.
#include "lib/bindless.glsl"
#include "lib/extra_samples.glsl"
#include "lib/history.glsl"
#include "lib/random.glsl"

layout(local_size_x = kExtraTile, local_size_y = kExtraTile) in;

shared uint wanted[kMostExtraPaths + 1u];

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uvec2 pixel = gl_GlobalInvocationID.xy;
  const ExtraTile tile = ExtraTileTable(frame.extra_tiles).items[gl_WorkGroupID.y * extraTiles().x + gl_WorkGroupID.x];
  if ((tile.young[0] | tile.young[1]) == 0u) return;
  if (thread <= kMostExtraPaths) wanted[thread] = 0u;
  barrier();
  ExtraSamplesRef extra = ExtraSamplesRef(frame.extra_samples);
  if ((tile.young[thread / 32u] >> thread % 32u & 1u) != 0u) {
    const float paths = extraPaths(extra.samples.share, tile.noise >> 8u * extraKind(pixel) & 0xffu);
    const uint whole = min(uint(paths + randomAt(pixel, history.tick, 32u).x), kMostExtraPaths);
    if (whole > 0u) {
      atomicAdd(wanted[whole], 1u);
      const uint info = imageLoad(images_r32ui[frame.path_info], ivec2(pixel)).x;
      imageStore(images_r32ui[frame.path_info], ivec2(pixel), uvec4(info | whole << kExtraPathsShift));
    }
  }
  barrier();
  if (thread == 0u || thread > kMostExtraPaths || wanted[thread] == 0u) return;
  atomicAdd(extra.samples.wanted[thread], wanted[thread]);
  atomicMax(extra.samples.listing.groups, (tilesOfPaths() * 32u + kPathGroup - 1u) / kPathGroup);
  ViewStateRef view = ViewStateRef(frame.view_state);
  atomicAdd(view.state.extra_paths, thread * wanted[thread]);
}
