// The scene on the GPU: tables of meshes, geometries, materials, instances and emitters.
//
// Contract: an instance's slot is its index in the instance table, its custom index in the TLAS, and what the
// visibility image holds. `MeshRecord.first_geometry + gl_GeometryIndexEXT` is the geometry record of a hit, or the
// first of several that are one geometry of the BLAS, one behind the other (inSubmesh, lib/surface.glsl).
#ifndef HELIO_SHARED_SCENE_H
#define HELIO_SHARED_SCENE_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kNoTexture = 0xffffffffu;
HELIO_CONSTANT kNoMesh = 0xffffffffu;

// MaterialRecord.flags
HELIO_CONSTANT kMaterialLambert = 1u;         // two-sided Lambert, no specular lobe
HELIO_CONSTANT kMaterialUnlit = 2u;           // shines with its base colour, reflects nothing
HELIO_CONSTANT kMaterialTintedSpecular = 4u;  // a dielectric whose reflection has a colour
HELIO_CONSTANT kMaterialMasked = 8u;          // has no surface where its alpha is below the cutoff
// From this bit on: three bits a texture slot, the channel of texture coordinates that it reads.
HELIO_CONSTANT kUvChannelShift = 8u;
HELIO_CONSTANT kUvChannelBits = 3u;
HELIO_CONSTANT kSlotBaseColor = 0u;
HELIO_CONSTANT kSlotNormal = 1u;
HELIO_CONSTANT kSlotMetallicRoughness = 2u;
HELIO_CONSTANT kSlotEmissive = 3u;  // always channel 0
HELIO_CONSTANT kSlotSpecular = 4u;
HELIO_CONSTANT kSlotSpecularColor = 5u;
HELIO_CONSTANT kTextureSlots = 6u;

// Visibility masks of rays and instances.
HELIO_CONSTANT kMaskSolid = 1u;
HELIO_CONSTANT kMaskCell = 8u;      // boxes that stand for what is culled in a cell
HELIO_CONSTANT kMaskOmitted = 16u;  // bounds that stand for an instance
HELIO_CONSTANT kMaskAll = 0xe7u;    // all that has a surface

// Hit groups of an instance in the TLAS.
HELIO_CONSTANT kHitGroupSurface = 0u;
HELIO_CONSTANT kHitGroupCell = 1u;
HELIO_CONSTANT kHitGroupOmitted = 2u;

// One vertex beside its position. Octahedral snorm16 pairs; the tangent's handedness is the lowest bit of `tangent`.
struct VertexAttributes {
  uint normal;
  uint tangent;
  vec2 uv;
};

// What only some meshes have, by address: 0 where this one has not.
struct VertexExtras {
  uint64_t colors;                  // uvec2 a vertex: RGBA as unorm16
  uint64_t uvs[kTextureSlots - 1];  // of channel 1 and up: vec2 a vertex
};

// The triangles of one submesh.
struct GeometryRecord {
  uint64_t positions;   // float3 a vertex
  uint64_t attributes;  // VertexAttributes a vertex
  uint64_t indices;     // uint, three a triangle
  uint64_t extras;      // VertexExtras; 0: none
  uint material;
  uint emitter_offset;  // of this geometry's first triangle among its mesh's emissive triangles; kNoTexture: not
                        // emissive
  uint triangle_count;
};

// There are two tables of these, alike but for levels of detail whose BLASes are not there: the mesh table, and that of
// what rays meet, which has another level in their places.
struct MeshRecord {
  uint64_t blas;  // device address, in the table of what rays meet; 0: nothing of the mesh is there
  uint first_geometry;
  uint geometry_count;
  uint first_emitter;  // in the table of emissive triangles
  uint emitter_count;  // 0: nothing shines
  uint coarser;        // the mesh's level 1 in the mesh table, with the further ones behind it
  float error;         // metres that this level may be off
};

// Levels of detail of a mesh, the finest with them.
HELIO_CONSTANT kMostLevels = 4u;
// In the second word of the visibility image, above the primitive: the level that was rasterised, or this where a ray
// met what is in the BLAS. 15 belongs to kNothing.
HELIO_CONSTANT kVisibilityLevelShift = 28u;
HELIO_CONSTANT kLevelInBlas = 14u;

struct MaterialRecord {
  vec4 base_color;  // a: over the alpha cutoff, so that there is no surface where it comes below 1 (kMaterialMasked)
  vec3 emission;    // W/(sr m^2)
  float metallic;
  float roughness;  // perceptual
  float normal_scale;
  uint base_color_texture;
  uint normal_texture;
  uint metallic_roughness_texture;
  uint emissive_texture;
  uint flags;
  uint specular;  // bytes from the material table's first to this material's SpecularRecord; 0: a dielectric of ior 1.5
};

// A dielectric's reflection where it is not that of ior 1.5 [KHR_materials_ior, KHR_materials_specular]. Lies behind
// the material table.
struct SpecularRecord {
  vec3 f0;    // along the normal, before `weight`; clamped to 1 behind the texture
  float f90;  // at grazing angles, before `weight`
  float weight;
  uint texture;        // A multiplies the weight
  uint color_texture;  // RGB multiplies f0
};

// Rows of the object-to-world matrix: what VkTransformMatrixKHR holds too.
struct InstanceRecord {
  vec4 rows[3];
  uint mesh;             // kNoMesh: a free slot
  float emitter_weight;  // its power, up to a factor common to all; over FrameConstants.emitter_weight_sum: its
                         // probability
  uint64_t deform;       // DeformRecord (shared/animation.h); 0: as its mesh is
  uint level;            // of its mesh's levels of detail: the one that rays meet
};

// Entry of a table for Walker's alias method: take `index` itself with probability `keep`, else `alias`.
struct EmitterInstance {
  uint slot;  // or kPunctualLight and an index
  uint alias;
  float keep;
};

// In the place of an instance's slot: what is left is an index of the table of punctual lights.
HELIO_CONSTANT kPunctualLight = 0x80000000u;

HELIO_CONSTANT kLightDirectional = 0u;
HELIO_CONSTANT kLightPoint = 1u;
HELIO_CONSTANT kLightSpot = 2u;

// A light without extent [KHR_lights_punctual].
struct PunctualRecord {
  vec3 position;        // directional: the direction towards it
  uint type;            // kLight...
  vec3 direction;       // unit, the way light travels
  float inverse_range;  // 0: unlimited
  vec3 intensity;       // W/sr; directional: W/m^2
  float weight;         // as InstanceRecord.emitter_weight
  // A spot's share at an angle with cosine c: clamp(c cone_scale + cone_offset, 0, 1)^2.
  float cone_scale;
  float cone_offset;
};

// The emissive instances that matter most to one cell of the ground plane, by power over squared distance. `cdf` ends
// in 1.
HELIO_CONSTANT kLightsPerCell = 12u;
struct LightCell {
  uint count;
  uint found;        // the first of them: what no shadow ray has found hidden (shared/light_lists.h)
  float irradiance;  // sum of power over squared distance
  uint slots[kLightsPerCell];
  float cdf[kLightsPerCell];
};

// What is left of a mesh's emissive triangles when they are seen as one lamp without extent, object space.
struct LampShape {
  vec3 centre;     // of power
  float flatness;  // 0: shines alike to all sides, 1: as a plane does
  vec3 normal;     // of that plane
  vec3 colour;     // of the light, of luminance 1
};

// An emissive triangle of a mesh, chosen in proportion to its power among the mesh's.
struct EmitterTriangle {
  uint geometry;  // within the mesh
  uint primitive;
  uint alias;  // within the mesh
  float keep;
  float pmf;
};

HELIO_SHARED_END
#endif
