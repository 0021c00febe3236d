// Access to the shared tables by address, and the push constants of a view's passes.
#ifndef HELIO_TABLES_GLSL
#define HELIO_TABLES_GLSL
#include "shared/frame.h"
#include "shared/scene.h"

layout(buffer_reference, scalar) readonly buffer FrameRef { FrameConstants constants; };
layout(buffer_reference, scalar) readonly buffer InstanceTable { InstanceRecord items[]; };
layout(buffer_reference, scalar) readonly buffer MeshTable { MeshRecord items[]; };
layout(buffer_reference, scalar) readonly buffer GeometryTable { GeometryRecord items[]; };
layout(buffer_reference, scalar) readonly buffer MaterialTable { MaterialRecord items[]; };
layout(buffer_reference, scalar) readonly buffer EmitterInstanceTable { EmitterInstance items[]; };
layout(buffer_reference, scalar) readonly buffer EmitterTriangleTable { EmitterTriangle items[]; };
layout(buffer_reference, scalar) readonly buffer PunctualTable { PunctualRecord items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer GgxAlbedoRef { GgxAlbedo albedo; };
layout(buffer_reference, scalar) readonly buffer LightCellTable { LightCell items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer LampShapeTable { LampShape items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer SpecularRef { SpecularRecord specular; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer VertexExtrasRef { VertexExtras extras; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer UvTable { vec2 items[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ColorTable { uvec2 items[]; };
layout(buffer_reference, scalar) readonly buffer PositionTable { vec3 items[]; };
layout(buffer_reference, scalar) readonly buffer AttributeTable { VertexAttributes items[]; };
layout(buffer_reference, scalar) readonly buffer IndexTable { uint items[]; };
layout(buffer_reference, scalar) buffer ViewStateRef { ViewState state; };
layout(buffer_reference, scalar) buffer PixelTable { uint items[]; };
layout(buffer_reference, scalar) buffer RayLog { RayLogEntry items[]; };

#ifndef HELIO_OWN_PUSH
layout(push_constant, scalar) uniform Push { SampleConstants push; };

#define frame FrameRef(push.frame).constants
#endif

#endif
