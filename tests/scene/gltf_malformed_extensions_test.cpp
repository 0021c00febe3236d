// What extensions and the less usual accessors can get wrong: each gives an error that names it.
#include <limits>

#include "gltf_malformed.h"

namespace helio::scene {
namespace {

using nlohmann::json;

std::vector<Malformed> malformedExtensions() {
  const auto inv = ErrorKind::invalid;
  using B = GltfBuilder&;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto material = [](const json& extensions) {
    return [extensions](B b) { b.document["materials"] = {{{"extensions", extensions}}}; };
  };
  const auto transform = [](const json& transform) {
    return [transform](B b) {
      b.document["materials"] = {
          {{"normalTexture",
            {{"index", b.image("no image")}, {"extensions", {{"KHR_texture_transform", transform}}}}}}};
    };
  };
  const auto instances = [](const json& attributes) {
    return [attributes](B b) {
      b.floats({0, 0, 0, 1, 1, 1}, "VEC3");                           // accessor 1
      b.floats({0, 0, 0, 1, 0, 0, 0, 0}, "VEC4");                     // 2: the second is no rotation
      b.integers<int16_t>(kShort, "VEC3", true, {1, 2, 3, 4, 5, 6});  // 3
      b.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", attributes}};
    };
  };
  const auto light = [](const json& light) {
    return [light](B b) {
      b.document["extensions"]["KHR_lights_punctual"]["lights"] = {light};
      b.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
    };
  };
  return {
      // Sparse accessors
      {"SparseIndexOutOfRange",
       [](B b) {
         b.sparse(0, {1, 3}, {0, 0, 0, 0, 0, 0});
       },
       inv, "accessors[0].sparse.indices[1] is 3: the accessor has 3 elements"},
      {"SparseIndicesFall",
       [](B b) {
         b.sparse(0, {2, 1}, {0, 0, 0, 0, 0, 0});
       },
       inv, "accessors[0].sparse.indices[1] is 1: it must be more than the 2 before it"},
      {"SparseIndexTwice",
       [](B b) {
         b.sparse(0, {1, 1}, {0, 0, 0, 0, 0, 0});
       },
       inv, "accessors[0].sparse.indices[1] is 1"},
      {"SparseValuesShort",
       [](B b) {
         b.sparse(0, {0, 1}, {0, 0, 0});
       },
       inv, "accessors[0].sparse.values.count is 2: its view has room for 1"},
      {"SparseValuesNan",
       [=](B b) {
         b.sparse(0, {1}, {0, nan, 0});
       },
       inv, "accessors[0][1] holds nan"},
      {"SparseIndicesShort",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0, 0, 0, 0, 0, 0, 0});
         b.document["accessors"][0]["sparse"]["count"] = 3;
       },
       inv, "accessors[0].sparse.indices.count is 3"},
      {"SparseMoreThanThereAre",
       [](B b) {
         b.sparse(0, {0, 1, 2}, {0, 0, 0, 0, 0, 0, 0, 0, 0});
         b.document["accessors"][0]["sparse"]["count"] = 4;
       },
       inv, "accessors[0].sparse.count is 4: it must be an integer in [1, 3]"},
      {"SparseIndicesOfFloats",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0});
         b.document["accessors"][0]["sparse"]["indices"]["componentType"] = kFloat;
       },
       inv, "accessors[0].sparse.indices.componentType is 5126"},
      {"SparseOfNoView",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0});
         b.document["accessors"][0]["sparse"]["values"]["bufferView"] = 9;
       },
       inv, "accessors[0].sparse.values.bufferView is 9"},
      {"SparseWithoutValues",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0});
         b.document["accessors"][0]["sparse"].erase("values");
       },
       inv, "accessors[0].sparse.values.bufferView is missing"},
      {"SparseIsNoObject", [](B b) { b.document["accessors"][0]["sparse"] = 1; }, inv, "accessors[0].sparse is 1"},
      {"SparseOffsetBeyondTheView",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0});
         b.document["accessors"][0]["sparse"]["indices"]["byteOffset"] = 2;
       },
       inv, "accessors[0].sparse.indices.byteOffset is 2"},
      {"SparseOfNothingIsEndless",
       [](B b) {
         b.sparse(0, {0}, {0, 0, 0});
         b.document["accessors"][0].erase("bufferView");
         b.document["accessors"][0]["count"] = uint64_t{3} << 50;
       },
       ErrorKind::limit, "brings the model to 1125899906842624 triangles"},
      // Quantized attributes
      {"PositionsQuantizedWithoutTheExtension",
       [](B b) {
         b.attributes()["POSITION"] = b.integers<int16_t>(kShort, "VEC3", false, {0, 0, 0, 1, 0, 0, 0, 1, 0});
       },
       inv, "accessors[1] does not fit its use: VEC3 of floats are needed"},
      {"NormalsQuantizedWithoutTheExtension",
       [](B b) {
         b.attributes()["NORMAL"] = b.integers<int8_t>(kByte, "VEC3", true, {0, 0, 127, 0, 0, 127, 0, 0, 127});
       },
       inv, "accessors[1] does not fit its use: VEC3 of floats are needed"},
      {"UvsQuantizedWithoutTheExtension",
       [](B b) {
         b.attributes()["TEXCOORD_0"] = b.integers<int16_t>(kShort, "VEC2", true, {0, 0, 1, 0, 0, 1});
       },
       inv, "accessors[1] does not fit its use: VEC2 of floats or of normalized unsigned bytes or shorts"},
      {"NormalsQuantizedUnsigned",
       [](B b) {
         b.uses("KHR_mesh_quantization");
         b.attributes()["NORMAL"] = b.integers<uint8_t>(kUnsignedByte, "VEC3", true, {0, 0, 1, 0, 0, 1, 0, 0, 1});
       },
       inv, "accessors[1] does not fit its use: VEC3 of floats or of normalized signed bytes or shorts"},
      {"PositionsOfIntsNeverFit",
       [](B b) {
         b.uses("KHR_mesh_quantization");
         b.attributes()["POSITION"] = b.integers<uint32_t>(kUnsignedInt, "VEC3", false, {0, 0, 0, 1, 0, 0, 0, 1, 0});
       },
       inv, "accessors[1] does not fit its use: VEC3 of floats or of bytes or shorts"},
      // Vertex colours
      {"ColorsOfIntegers",
       [](B b) {
         b.attributes()["COLOR_0"] = b.integers<uint8_t>(kUnsignedByte, "VEC4", false, std::vector<uint8_t>(12));
       },
       inv, "accessors[1] does not fit its use: VEC3 or VEC4 of floats or of normalized unsigned bytes or shorts"},
      {"ColorsOfPairs",
       [](B b) {
         b.attributes()["COLOR_0"] = b.floats({0, 0, 0, 0, 0, 0}, "VEC2");
       },
       inv, "accessors[1] does not fit its use: VEC3 or VEC4"},
      {"FewerColorsThanVertices",
       [](B b) {
         b.attributes()["COLOR_0"] = b.floats({0, 0, 0}, "VEC3");
       },
       inv, "attributes.COLOR_0 has 1 elements for 3 vertices"},
      // Texture transforms
      {"TransformOffsetNan", transform({{"offset", {nan, 0}}}), inv,
       "materials[0].normalTexture.extensions.KHR_texture_transform.offset is [null,0]: it must be 2 finite numbers"},
      {"TransformRotationNan", transform({{"rotation", nan}}), inv, "KHR_texture_transform.rotation is null"},
      {"TransformScaleInfinite", transform({{"scale", {1, 1e300}}}), inv, "KHR_texture_transform.scale is [1,1e+300]"},
      {"TransformScaleOfOne", transform({{"scale", 2}}), inv, "KHR_texture_transform.scale is 2"},
      {"TransformOfNegativeSet", transform({{"texCoord", -1}}), inv, "KHR_texture_transform.texCoord is -1"},
      {"TransformIsNoObject", transform(3), inv, "KHR_texture_transform is 3: it must be an object"},
      {"TransformBeyondNumbers",
       [](B b) {
         b.document["materials"] = {{{"emissiveTexture",
                                      {{"index", b.image(png(1, 1, {0, 0, 0, 255}))},
                                       {"extensions", {{"KHR_texture_transform", {{"scale", {3e38, 1}}}}}}}}}};
         b.primitive()["material"] = 0;
         b.attributes()["TEXCOORD_0"] = b.floats({0, 0, 9, 0, 0, 9}, "VEC2");
       },
       inv, "the texture transform of its material takes TEXCOORD_0 beyond what numbers can hold"},
      {"TextureOfNegativeSet",
       [](B b) {
         b.document["materials"] = {{{"occlusionTexture", {{"index", b.image("no image")}, {"texCoord", -1}}}}};
       },
       inv, "materials[0].occlusionTexture.texCoord is -1"},
      // Materials
      {"IorBetweenZeroAndOne", material({{"KHR_materials_ior", {{"ior", 0.5}}}}), inv,
       "materials[0].extensions.KHR_materials_ior.ior is 0.5: it must be 0, or 1 or more"},
      {"IorNan", material({{"KHR_materials_ior", {{"ior", nan}}}}), inv, "KHR_materials_ior.ior is null"},
      {"IorText", material({{"KHR_materials_ior", {{"ior", "glass"}}}}), inv, "KHR_materials_ior.ior is \"glass\""},
      {"SpecularAboveOne", material({{"KHR_materials_specular", {{"specularFactor", 1.5}}}}), inv,
       "KHR_materials_specular.specularFactor is 1.5: it must be a number in [0, 1]"},
      {"SpecularColorNegative", material({{"KHR_materials_specular", {{"specularColorFactor", {1, -1, 1}}}}}), inv,
       "KHR_materials_specular.specularColorFactor is [1,-1,1]: it must be 3 finite numbers, 0 or more"},
      {"SpecularTextureOutOfRange", material({{"KHR_materials_specular", {{"specularTexture", {{"index", 0}}}}}}), inv,
       "KHR_materials_specular.specularTexture.index is 0: it must be the index of one of 0 textures"},
      {"ExtensionsAreNoObject", material(json::array({1})), inv,
       "materials[0].extensions is [1]: it must be an object"},
      {"UnlitIsNoObject", material({{"KHR_materials_unlit", true}}), inv, "KHR_materials_unlit is true"},
      {"ExtensionsUsedIsNoList", [](B b) { b.document["extensionsUsed"] = "all"; }, inv, "extensionsUsed is \"all\""},
      // Instances
      {"InstanceCountsDiffer", instances({{"SCALE", 0}, {"TRANSLATION", 1}}), inv,
       "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.TRANSLATION has 2 elements, accessors[0] has 3"},
      {"InstanceRotationZero", instances({{"ROTATION", 2}}), inv,
       "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.ROTATION[1] is a quaternion of length zero"},
      {"InstanceTranslationsOfShorts", instances({{"TRANSLATION", 3}}), inv,
       "accessors[3] does not fit its use: VEC3 of floats"},
      {"InstanceRotationsOfTriples", instances({{"ROTATION", 1}}), inv, "accessors[1] does not fit its use: VEC4"},
      {"InstanceAttributeOutOfRange", instances({{"TRANSLATION", 4}}), inv,
       "nodes[0].extensions.EXT_mesh_gpu_instancing.attributes.TRANSLATION is 4"},
      {"InstancesOfNothing", instances(json::object()), inv, "it must hold TRANSLATION, ROTATION or SCALE"},
      {"InstancesWithoutAttributes",
       [](B b) { b.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json::object(); }, inv,
       "EXT_mesh_gpu_instancing.attributes is missing"},
      {"InstanceTranslationNan",
       [=](B b) {
         const int translations = b.floats({0, 0, 0, 0, nan, 0}, "VEC3");
         b.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = translations;
       },
       inv, "accessors[1][1] holds nan"},
      {"InstancesEndless",
       [](B b) {
         const int scales = b.floats({1, 1, 1}, "VEC3");
         b.sparse(scales, {0}, {1, 1, 1});
         b.document["accessors"].back().erase("bufferView");
         b.document["accessors"].back()["count"] = uint64_t{1} << 50;
         b.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] = scales;
       },
       ErrorKind::limit, "makes 1125899906842624 instances, at most 1000000 are allowed"},
      // Lights
      {"LightOfUnknownType", light({{"type", "area"}}), inv,
       "extensions.KHR_lights_punctual.lights[0].type is \"area\""},
      {"LightIntensityNegative", light({{"type", "point"}, {"intensity", -1}}), inv,
       "lights[0].intensity is -1: it must be a finite number, 0 or more"},
      {"LightRangeZero", light({{"type", "point"}, {"range", 0}}), inv, "lights[0].range is 0: it must be above 0"},
      {"LightColorOfTwo", light({{"type", "point"}, {"color", {1, 1}}}), inv, "lights[0].color is [1,1]"},
      {"SpotWithoutCone", light({{"type", "spot"}}), inv, "lights[0].spot is missing"},
      {"SpotInsideOut", light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.7}, {"outerConeAngle", 0.5}}}}), inv,
       "lights[0].spot.innerConeAngle is 0.7: it must be less than the outerConeAngle of 0.5"},
      {"SpotTooWide", light({{"type", "spot"}, {"spot", {{"outerConeAngle", 2}}}}), inv,
       "lights[0].spot.outerConeAngle is 2"},
      {"LightOutOfRange", [](B b) { b.document["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }, inv,
       "nodes[0].extensions.KHR_lights_punctual.light is 0: it must be the index of one of 0 lights"},
      {"LightsAreNoList", [](B b) { b.document["extensions"]["KHR_lights_punctual"]["lights"] = 2; }, inv,
       "extensions.KHR_lights_punctual.lights is 2: it must be an array"},
  };
}

class GltfMalformedExtensions : public ::testing::TestWithParam<Malformed> {};

TEST_P(GltfMalformedExtensions, IsRefusedByName) { expectRefused(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Files, GltfMalformedExtensions, ::testing::ValuesIn(malformedExtensions()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace helio::scene
