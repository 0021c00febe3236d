// What moves, on the GPU: clips, the units that play them, and how an instance's shape differs from its mesh.
#ifndef HELIO_SHARED_ANIMATION_H
#define HELIO_SHARED_ANIMATION_H
#include "shared/types.h"

HELIO_SHARED_BEGIN

HELIO_CONSTANT kNoNode = 0xffffffffu;

// ChannelRecord.target and .interpolation: the order of scene::ChannelTarget and scene::Interpolation.
HELIO_CONSTANT kTargetTranslation = 0u;
HELIO_CONSTANT kTargetRotation = 1u;
HELIO_CONSTANT kTargetScale = 2u;
HELIO_CONSTANT kTargetWeights = 3u;
HELIO_CONSTANT kInterpolateStep = 0u;
HELIO_CONSTANT kInterpolateLinear = 1u;
HELIO_CONSTANT kInterpolateCubic = 2u;

// Affine maps are three rows.
struct ClipNode {
  vec4 rest[3];
  vec3 translation;
  vec4 rotation;  // x y z w
  vec3 scale;
  uint parent;  // a smaller index, or kNoNode
  uint first_channel;
  uint channel_count;
};

struct ChannelRecord {
  uint target;
  uint interpolation;
  uint first_time;  // in the clip's `numbers`
  uint key_count;
  uint first_value;
};

struct JointRecord {
  vec4 inverse_bind[3];
  uint node;
};

// A rig playing one of its clips.
struct ClipRecord {
  uint64_t nodes;     // ClipNode
  uint64_t channels;  // ChannelRecord: those of the nodes, node by node, then those of the weights
  uint64_t joints;    // JointRecord
  uint64_t numbers;   // float: times, values, weights at rest
  uint node_count;
  uint joint_count;
  uint weight_count;
  uint rest_weights;    // in `numbers`
  uint weight_channel;  // kNoNode: they rest
};

// Joint indices of 16 bits, weights as unorm16: they sum to 1 but for rounding, so what they sum to divides.
struct VertexSkinRecord {
  uint joints_low;  // 16 | 16 bits
  uint joints_high;
  uint weights_low;
  uint weights_high;
};

// How a mesh deforms.
struct MeshDeform {
  uint64_t skin;    // VertexSkinRecord a vertex; 0: none
  uint64_t morphs;  // of each target: vec3 a vertex for positions, then vec3 a vertex for normals
  uint morph_count;
  uint vertex_count;
  float fit_height;  // metres; 0: not fitted to the ground
};

// The ground that meshes are fitted to.
struct GroundRecord {
  uint64_t heights;  // float, rows of z
  vec2 origin;
  float spacing;
  uint columns;
  uint rows;
};

// An instance whose shape is not its mesh's at rest.
struct DeformRecord {
  uint64_t mesh;       // MeshDeform
  uint64_t ground;     // GroundRecord; 0: none
  uint64_t palette;    // three rows a joint
  uint64_t weights;    // float a morph target
  uint64_t positions;  // vec3 a vertex, deformed in this tick; 0: not in a BLAS
  uint64_t blas;       // device address; 0: rays do not meet it
  uint vertex_count;   // of `positions`: a coarse level has the first of the mesh's vertices
  // Of the tick before; 0: nobody looks back, or it has none.
  uint64_t previous_palette;
  uint64_t previous_weights;
};

// Instances whose records changed: `records[i]` goes to slot `slots[i]`.
struct MoveConstants {
  uint64_t slots;      // uint
  uint64_t records;    // InstanceRecord
  uint64_t instances;  // InstanceRecord, by slot
  uint64_t units;      // uint: of which unit record i is
  uint64_t motions;    // MotionRecord (shared/history.h) a unit: takes what is overwritten; 0: nobody looks back
  uint count;
};

// A unit to pose in this tick.
struct PoseRecord {
  uint64_t clip;              // ClipRecord
  uint64_t nodes;             // scratch: three rows a node
  uint64_t palette;           // written
  uint64_t weights;           // written
  uint64_t previous_palette;  // takes what is overwritten; 0: nobody looks back
  uint64_t previous_weights;
  float time;  // within the clip, seconds
  uint first;  // 1: there is no pose to overwrite, this is the previous one too
};

struct PoseConstants {
  uint64_t poses;  // PoseRecord
  uint count;
};

// A unit to deform in this tick, for its BLAS.
struct DeformJob {
  uint64_t rest;     // vec3 a vertex
  uint64_t output_;  // vec3 a vertex
  uint slot;
  uint vertex_count;
};

struct DeformConstants {
  uint64_t jobs;       // DeformJob, one a row of groups
  uint64_t instances;  // InstanceRecord
};

HELIO_SHARED_END
#endif
