// What every pass of a view is given: one block of constants by address, and a few push constants.
#ifndef HELIO_SHARED_FRAME_H
#define HELIO_SHARED_FRAME_H
#include "shared/faults.h"
#include "shared/types.h"

HELIO_SHARED_BEGIN

struct FrameConstants {
  // Camera. right, up and forward are orthonormal; `tangent` = tan(vfov / 2); rays leave `position`.
  vec3 position;
  float tangent;
  vec3 right;
  float aspect;
  vec3 up;
  float near_plane;  // metres
  vec3 forward;
  float lens_radius;   // metres; 0: a pinhole
  float focus;         // metres along `forward`
  float pixel_spread;  // radians a pixel: the ray cone's opening [Akenine-Moeller 2019]
  float cone_growth;   // of the opening, at bounces; both 0: textures are read at their finest level
  uint width;
  uint height;

  // Scene tables (shared/scene.h).
  uint64_t tlas;
  uint64_t instances;
  uint64_t meshes;
  uint64_t traced_meshes;  // MeshRecord: of what rays meet in each one's place
  uint64_t geometries;
  uint64_t materials;
  uint64_t emitter_instances;
  uint64_t emitter_triangles;
  uint64_t light_cells;    // LightCell: light_grid_size.x a row of z
  vec2 light_grid_origin;  // metres, x and z
  uvec2 light_grid_size;   // cells; 0: no grid
  float light_cells_per_metre;
  uint emitter_instance_count;
  float emitter_weight_sum;
  uint64_t punctual_lights;  // PunctualRecord
  float distant_irradiance;  // of the distant ones among them, as LightCell.irradiance
  uint64_t lamp_shapes;      // LampShape a mesh
  uint64_t light_memory;     // LightMemory a cell, where cells learn which lamps they see
  uint light_note_stride;    // one of so many pixels tells

  // Sun and sky. `sun_to` points towards the sun.
  vec3 sun_to;
  vec3 sun_radiance;        // of the disc: irradiance / (pi sin^2)
  float sun_one_minus_cos;  // of the disc's half angle
  vec3 sky_zenith;
  vec3 sky_ground;

  uint64_t shadow_map;  // ShadowMap (shared/shadow_map.h), where the sun's shadows ask for one

  // Path tracing.
  uint max_scatterings;  // B + 1
  uint roulette;         // 0 or 1
  float roulette_exposure;
  uint independent_samples;  // 1: random numbers instead of the low-discrepancy sequence
  uint light_sampling;       // 0: lights are only met by scattered rays (punctual lights are sampled all the same)
  uint mis;                  // 0: light that both could find counts for light sampling alone
  uint sky_sampling;         // 1: light sampling looks for the sky too
  uint lamp_samples;         // of a path's first vertex, with kManyLamps; 0: each lamp once
  uint round_surfaces;       // 1: rays leave from the surface that the vertex normals tell of [Hanika 2021]
  float least_alpha;         // of GGX lobes once a path has scattered roughly
  uint64_t ggx_albedo;       // GgxAlbedo, with kMultipleScattering
  float ambient_radius;      // metres, with kAmbientOccluded
  uint64_t indirect;         // IndirectSample a pixel (shared/technique.h), where not all follow their paths

  // Images of the bindless set, and buffers.
  uint visibility;         // rg32ui: slot | geometry << 24, primitive; primitive == kNothing where nothing was hit
  uint radiance;           // rgba32f: this sample
  uint accumulation;       // rgba32f: mean of the samples so far
  uint path_info;          // r32ui: rays of this sample by kind, 8 bits each, and what its path waits for
  uint64_t path_states;    // PathState a pixel (shared/paths.h)
  uint64_t path_pixels;    // two lists of pixels whose paths go on
  uint64_t path_launches;  // PathLaunch a vertex
  uint64_t extra_samples;  // ExtraSamples (shared/extra_samples.h), where a tick may take further paths
  uint64_t extra_tiles;    // ExtraTile a tile
  uint64_t extra_pixels;   // the list of pixels that get some
  float extra_paths;       // a pixel, as a mean over the picture, at most
  uint64_t view_state;
  uint64_t pixels;   // one RGBA8 word a pixel
  uint64_t ray_log;  // RayLogEntry: ray_log_stride a pixel
  uint ray_log_stride;

  // Light path guided culling (shared/lipac.h), with kCountHits.
  uint64_t instance_hits;  // uint, by slot
  uint64_t hitboxes;       // Hitbox, by cell
  uint64_t culling;        // LipacTick; 0: another strategy
  uint64_t counted_tlas;   // acceleration structure of what is in `tlas`, and of boxes that stand for what is not
  uint hit_weight;         // of a hit, in 1/8; 0: this view does not count in this tick
  uint hit_stride;         // of the tiles whose paths count
  uint hit_turn;           // whose turn it is among `hit_stride`
  uint64_t history;        // HistoryConstants (shared/history.h); 0: this view does not look back
};

HELIO_CONSTANT kNothing = 0xffffffffu;

// Share of light that a GGX lobe of reflectance 1 reflects in one scattering, along cos(theta) first, from 0 to 1 each
// way.
HELIO_CONSTANT kGgxAlbedoCosines = 64u;
HELIO_CONSTANT kGgxAlbedoAlphas = 32u;  // by perceptual roughness
struct GgxAlbedo {
  float share[kGgxAlbedoCosines * kGgxAlbedoAlphas];
};
HELIO_CONSTANT kHistogramBins = 256u;

// What a view keeps from tick to tick, and what the CPU reads back.
struct ViewState {
  float exposure;  // factor on radiance
  uint histogram[kHistogramBins];
  uint bounce_rays;
  uint shadow_rays;
  uint retrace_rays;
  uint extra_paths;
  // Sum over pixels of relative variance in units of 1 / kVarianceUnits, with its carry: sums of integers do not depend
  // on their order.
  uint variance_low;
  uint variance_high;
  Faults faults;
};
HELIO_CONSTANT kVarianceUnits = 65536u;

// One sample of a view: pushed to every pass.
struct SampleConstants {
  uint64_t frame;       // FrameConstants
  vec2 jitter;          // position in the pixel, [0, 1); negative: each pixel its own
  uint seed;            // of the samples that are averaged
  uint sample_index;    // among them
  uint log2_samples;    // of a pixel's block of the low-discrepancy sequence
  uint accumulated;     // samples already in the mean
  float exposure_bias;  // 2^ev
  float adaptation;     // share of the way to the new exposure, (0, 1]
  uint auto_exposure;   // 0: exposure = exposure_bias
  uint source;          // tonemap, histogram: image to read
  uint curve;           // tonemap: kCurve...
  // path_trace: this launch takes paths from their vertex `first_vertex` (the camera's aside) up to `last_vertex`.
  uint launch;
  uint first_vertex;
  uint last_vertex;
  uint tick_sample;  // samples of this tick before this one
  uint listed;       // 1: the first launch takes the pixels that get a further path (shared/extra_samples.h)
};

HELIO_CONSTANT kCurveTone = 0u;    // exposure, tone curve, sRGB
HELIO_CONSTANT kCurveColor = 1u;   // sRGB alone
HELIO_CONSTANT kCurveNone = 2u;    // values as they are
HELIO_CONSTANT kCurveSigned = 3u;  // numbers of any size and sign: 0 is middle grey

struct RayLogEntry {
  vec3 origin;
  float t_max;
  vec3 direction;
  uint kind;
};
HELIO_CONSTANT kRayEnd = 0u;
HELIO_CONSTANT kRayBounce = 1u;
HELIO_CONSTANT kRayShadow = 2u;

HELIO_SHARED_END
#endif
