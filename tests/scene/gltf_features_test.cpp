// What extensions and the less usual attributes become.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "support/gltf_builder.h"

namespace helio::scene {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

ScenePtr load(const GltfBuilder& builder, ImportReport* report = nullptr, const GltfOptions& options = {}) {
  const TempFolder folder;
  Result<ScenePtr> scene = loadGltf(builder.save(folder), options, report);
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return scene ? *scene : std::make_shared<Scene>();
}

void expectNear(const glm::vec3& seen, const glm::vec3& expected, float tolerance = 1e-5f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], tolerance) << "component " << c;
}

/// One material of which `json` says all, on the triangle.
GltfBuilder withMaterial(const json& material) {
  GltfBuilder builder;
  builder.document["materials"] = {material};
  builder.primitive()["material"] = 0;
  return builder;
}

// ---- Accessors ----

TEST(GltfFeatures, SparseAccessorsReplaceElements) {
  GltfBuilder builder;
  builder.sparse(0, {1, 2}, {5, 6, 7, 8, 9, 10});
  EXPECT_THAT(load(builder)->meshes[0].positions,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(5, 6, 7), glm::vec3(8, 9, 10)));
}

TEST(GltfFeatures, SparseAccessorsWithoutAViewAreZeroElsewhere) {
  GltfBuilder builder;
  const int uvs = builder.floats({0, 0, 0, 0, 0, 0}, "VEC2");
  builder.document["accessors"].back().erase("bufferView");
  builder.sparse(uvs, {1}, {0.25f, 0.75f});
  builder.attributes()["TEXCOORD_0"] = uvs;
  EXPECT_THAT(load(builder)->meshes[0].uvs, ElementsAre(glm::vec2(0, 0), glm::vec2(0.25f, 0.75f), glm::vec2(0, 0)));
}

TEST(GltfFeatures, QuantizedAttributes) {
  GltfBuilder builder;
  builder.uses("KHR_mesh_quantization");
  builder.document["extensionsRequired"] = {"KHR_mesh_quantization"};
  builder.attributes() = {
      {"POSITION", builder.integers<int16_t>(kShort, "VEC3", false, {0, 0, -300, 100, 0, -300, 0, 100, -300})},
      {"NORMAL", builder.integers<int8_t>(kByte, "VEC3", true, {0, 0, 127, 127, 0, 0, 0, -127, 0})},
      {"TANGENT",
       builder.integers<int16_t>(kShort, "VEC4", true, {32767, 0, 0, 32767, 0, 32767, 0, -32767, 0, 0, -32768, 32767})},
      {"TEXCOORD_0", builder.integers<uint16_t>(kUnsignedShort, "VEC2", false, {0, 3, 2, 0, 65535, 1})}};
  const Mesh mesh = load(builder)->meshes[0];
  EXPECT_THAT(mesh.positions, ElementsAre(glm::vec3(0, 0, -300), glm::vec3(100, 0, -300), glm::vec3(0, 100, -300)));
  EXPECT_THAT(mesh.normals, ElementsAre(glm::vec3(0, 0, 1), glm::vec3(1, 0, 0), glm::vec3(0, -1, 0)));
  EXPECT_THAT(mesh.tangents, ElementsAre(glm::vec4(1, 0, 0, 1), glm::vec4(0, 1, 0, -1), glm::vec4(0, 0, -1, 1)));
  EXPECT_THAT(mesh.uvs, ElementsAre(glm::vec2(0, 3), glm::vec2(2, 0), glm::vec2(65535, 1)));

  builder.attributes()["POSITION"] =
      builder.integers<uint8_t>(kUnsignedByte, "VEC3", true, {0, 0, 0, 255, 0, 0, 0, 51, 0});
  EXPECT_THAT(load(builder)->meshes[0].positions,
              ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0.2f, 0)));
}

TEST(GltfFeatures, VertexColors) {
  GltfBuilder builder;
  builder.document["meshes"][0]["primitives"].push_back(builder.primitive());  // the second has none
  builder.attributes()["COLOR_0"] = builder.floats({0.5f, 1, 0, 2, -1, 0.25f, 1, 1, 1}, "VEC3");
  ScenePtr scene = load(builder);
  EXPECT_THAT(scene->meshes[0].colors, ElementsAre(glm::vec4(0.5f, 1, 0, 1), glm::vec4(1, 0, 0.25f, 1), glm::vec4(1),
                                                   glm::vec4(1), glm::vec4(1), glm::vec4(1)));

  builder.attributes()["COLOR_0"] =
      builder.integers<uint8_t>(kUnsignedByte, "VEC4", true, {255, 0, 51, 102, 0, 255, 0, 255, 0, 0, 0, 0});
  EXPECT_EQ(load(builder)->meshes[0].colors[0], glm::vec4(1, 0, 0.2f, 0.4f));
  EXPECT_TRUE(load(GltfBuilder{})->meshes[0].colors.empty());
}

// ---- Texture coordinates ----

const std::string kTexel = png(1, 1, {255, 255, 255, 255});

json textureInfo(int texture, const json& transform, int set = 0) {
  return {{"index", texture}, {"texCoord", set}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

GltfBuilder withUvs() {
  GltfBuilder builder = withMaterial(json::object());
  builder.attributes()["TEXCOORD_0"] = builder.floats({0, 0, 1, 0, 0, 1}, "VEC2");
  builder.attributes()["TEXCOORD_1"] = builder.floats({0.5f, 0.5f, 0.25f, 0.5f, 0.5f, 0.25f}, "VEC2");
  builder.uses("KHR_texture_transform");
  return builder;
}

TEST(GltfFeatures, TextureTransformsScaleThenRotateThenMove) {
  GltfBuilder builder = withUvs();
  const double quarter = 2 * std::atan(1.0);
  builder.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] =
      textureInfo(builder.image(kTexel), {{"scale", {2, 3}}, {"rotation", quarter}, {"offset", {10, 20}}});
  const ScenePtr scene = load(builder);
  const Mesh& mesh = scene->meshes[0];
  // A quarter turn counter-clockwise, v running down: u goes to -v, v to u.
  const glm::vec2 expected[] = {{10, 20}, {10, 18}, {13, 20}};
  for (size_t v = 0; v < 3; ++v) EXPECT_LT(glm::distance(mesh.uvs[v], expected[v]), 1e-5f) << v;
  EXPECT_TRUE(mesh.more_uvs.empty());
  EXPECT_EQ(scene->materials[0].channel(TextureSlot::base_color), 0);
}

TEST(GltfFeatures, EveryMappingIsAChannelAndEqualOnesAreOne) {
  GltfBuilder builder = withUvs();
  const int image = builder.image(kTexel);
  builder.document["materials"][0] = {
      {"pbrMetallicRoughness",
       {{"baseColorTexture", textureInfo(image, {{"offset", {1, 0}}})},
        {"metallicRoughnessTexture", textureInfo(image, {{"texCoord", 1}, {"offset", {0, 0}}})}}},  // overrides set 0
      {"normalTexture", textureInfo(image, {{"offset", {1, 0}}})},
      {"emissiveTexture", textureInfo(image, {{"scale", {4, 4}}})},
      {"emissiveFactor", {1, 1, 1}},
      {"extensions",
       {{"KHR_materials_specular",
         {{"specularTexture", textureInfo(image, {{"offset", {0, 5}}}, 1)},
          {"specularColorTexture", textureInfo(image, json::object(), 1)}}}}}};
  const ScenePtr scene = load(builder);
  const Material& material = scene->materials[0];
  EXPECT_EQ(material.channel(TextureSlot::emissive), 0);  // what light sampling reads
  EXPECT_EQ(material.channel(TextureSlot::base_color), material.channel(TextureSlot::normal));
  EXPECT_EQ(material.channel(TextureSlot::metallic_roughness), material.channel(TextureSlot::specular_color));
  const Mesh& mesh = scene->meshes[0];
  ASSERT_EQ(mesh.more_uvs.size(), 3u);
  const auto uv = [&](TextureSlot slot) {
    const uint8_t channel = material.channel(slot);
    return channel == 0 ? mesh.uvs.at(1) : mesh.more_uvs.at(channel - 1u).at(1);
  };
  EXPECT_EQ(uv(TextureSlot::emissive), glm::vec2(4, 0));
  EXPECT_EQ(uv(TextureSlot::base_color), glm::vec2(2, 0));
  EXPECT_EQ(uv(TextureSlot::metallic_roughness), glm::vec2(0.25f, 0.5f));
  EXPECT_EQ(uv(TextureSlot::specular), glm::vec2(0.25f, 5.5f));
}

TEST(GltfFeatures, TangentsFollowTheNormalMapsCoordinates) {
  GltfBuilder builder = withUvs();
  const int image = builder.image(kTexel);
  builder.document["materials"][0] = {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", image}}}}},
                                      {"normalTexture", textureInfo(image, {{"rotation", 2 * std::atan(1.0)}})}};
  const Mesh mesh = load(builder)->meshes[0];
  expectNear(glm::vec3(mesh.tangents[0]), {0, 1, 0});  // v is now what u was: along y
}

// Two triangles whose textures are mirrored along their common edge: each side has a tangent of its own.
TEST(GltfFeatures, MirroredSeamsAreSplit) {
  GltfBuilder builder = withMaterial(json::object());
  builder.attributes() = {{"POSITION", builder.floats({0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0, 0}, "VEC3")},
                          {"NORMAL", builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")},
                          {"TEXCOORD_0", builder.floats({0, 1, 0, 0, 1, 1, 1, 1}, "VEC2")}};
  builder.primitive()["indices"] = builder.indices<uint8_t>(kUnsignedByte, {0, 3, 1, 0, 1, 2});
  EXPECT_EQ(load(builder)->meshes[0].positions.size(), 4u);  // without a normal map nothing needs tangents

  builder.document["materials"][0]["normalTexture"]["index"] = builder.image(kTexel);
  const Mesh mesh = load(builder)->meshes[0];
  ASSERT_EQ(mesh.positions.size(), 6u);
  for (size_t corner = 0; corner < 6; ++corner) {
    const uint32_t v = mesh.indices[corner];
    const float side = corner < 3 ? 1.0f : -1.0f;  // u grows to +x on the right, to -x on the left
    expectNear(glm::vec3(mesh.tangents[v]), {side, 0, 0});
    EXPECT_EQ(mesh.tangents[v].w, side) << corner;
  }
}

// ---- Materials ----

TEST(GltfFeatures, IorAndSpecular) {
  GltfBuilder builder =
      withMaterial({{"extensions",
                     {{"KHR_materials_ior", {{"ior", 1.33}}},
                      {"KHR_materials_specular", {{"specularFactor", 0.25}, {"specularColorFactor", {2, 0.5, 0}}}}}}});
  const int image = builder.image(kTexel);
  json& specular = builder.document["materials"][0]["extensions"]["KHR_materials_specular"];
  specular["specularTexture"]["index"] = image;
  specular["specularColorTexture"]["index"] = image;
  const ScenePtr scene = load(builder);
  const Material& material = scene->materials[0];
  EXPECT_FLOAT_EQ(material.ior, 1.33f);
  EXPECT_EQ(material.specular, 0.25f);
  EXPECT_EQ(material.specular_color, glm::vec3(2, 0.5f, 0));
  ASSERT_NE(material.specular_texture, kNone);
  ASSERT_NE(material.specular_color_texture, kNone);
  EXPECT_FALSE(scene->textures[material.specular_texture].srgb);
  EXPECT_TRUE(scene->textures[material.specular_color_texture].srgb);
  EXPECT_TRUE(material.hasOwnSpecular());

  EXPECT_FALSE(load(withMaterial(json::object()))->materials[0].hasOwnSpecular());
  EXPECT_EQ(load(withMaterial({{"extensions", {{"KHR_materials_ior", {{"ior", 0}}}}}}))->materials[0].ior, 0.0f);
}

TEST(GltfFeatures, UnlitKeepsItsBaseColourAlone) {
  GltfBuilder builder = withMaterial({{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 1}}}},
                                      {"emissiveFactor", {1, 1, 1}},
                                      {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  const ScenePtr scene = load(builder);
  EXPECT_TRUE(scene->materials[0].unlit);
  EXPECT_EQ(scene->materials[0].emission, glm::vec3(0.0f));
  EXPECT_EQ(scene->materials[0].base_color, glm::vec4(0.1f, 0.2f, 0.3f, 1.0f));
  EXPECT_FALSE(scene->materials[1].unlit);
}

// ---- Nodes ----

json instancing(const json& attributes) { return {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}; }

TEST(GltfFeatures, InstancesArePlacedInTheirNode) {
  GltfBuilder builder;
  builder.uses("EXT_mesh_gpu_instancing");
  const int translations = builder.floats({1, 0, 0, 0, 2, 0, 0, 0, 3}, "VEC3");
  const int rotations =  // the second: a half turn about y
      builder.integers<int16_t>(kShort, "VEC4", true, {0, 0, 0, 32767, 0, 32767, 0, 0, 0, 0, 0, 32767});
  const int scales = builder.floats({1, 1, 1, 2, 2, 2, -1, 1, 1}, "VEC3");
  const int ids = builder.floats({7, 8, 9}, "SCALAR");
  builder.document["nodes"] = {
      {{"mesh", 0},
       {"translation", {100, 0, 0}},
       {"scale", {10, 10, 10}},
       {"children", {1}},
       {"extensions",
        instancing({{"TRANSLATION", translations}, {"ROTATION", rotations}, {"SCALE", scales}, {"_ID", ids}})}},
      {{"mesh", 0}}};
  ImportReport report;
  const ScenePtr scene = load(builder, &report);
  ASSERT_EQ(scene->placements.size(), 4u);
  const auto map = [&](size_t i, glm::vec3 p) { return scene->placements[i].transform * glm::vec4(p, 1); };
  expectNear(map(0, {1, 1, 1}), {120, 10, 10}, 1e-3f);
  expectNear(map(1, {1, 1, 1}), {80, 40, -20}, 1e-3f);
  expectNear(map(2, {1, 1, 1}), {90, 10, 40}, 1e-3f);   // mirrored
  expectNear(map(3, {1, 1, 1}), {110, 10, 10}, 1e-3f);  // children are not repeated
  EXPECT_EQ(report.instances, 4u);
}

TEST(GltfFeatures, InstancesAreLimited) {
  GltfBuilder builder;
  const int scales = builder.floats({1, 1, 1, 1, 1, 1}, "VEC3");
  builder.document["nodes"] = {{{"mesh", 0}, {"extensions", instancing({{"SCALE", scales}})}}, {{"mesh", 0}}};
  builder.document["scenes"][0]["nodes"] = {0, 1};
  GltfOptions options;
  options.max_instances = 3;
  EXPECT_EQ(load(builder, nullptr, options)->placements.size(), 3u);
  options.max_instances = 2;
  const TempFolder folder;
  const Result<ScenePtr> refused = loadGltf(builder.save(folder), options);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().kind, ErrorKind::limit);
  EXPECT_THAT(refused.error().message, ::testing::HasSubstr("nodes[1] brings the model to 3 instances"));
}

TEST(GltfFeatures, PunctualLights) {
  GltfBuilder builder;
  builder.uses("KHR_lights_punctual");
  builder.document["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"name", "sun"}, {"color", {1, 0.5, 0.25}}, {"intensity", 1000}},
      {{"type", "point"}, {"intensity", 40}, {"range", 12}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}},
      {{"type", "spot"}, {"spot", json::object()}}};
  const double half = std::sqrt(0.5);
  const auto light = [](int index) { return json{{"KHR_lights_punctual", {{"light", index}}}}; };
  builder.document["nodes"] = {{{"mesh", 0}, {"children", {1, 2, 3, 4}}, {"scale", {2, 2, 2}}},
                               {{"extensions", light(0)}, {"rotation", {-half, 0, 0, half}}},  // -z turns to -y
                               {{"extensions", light(1)}, {"translation", {1, 2, 3}}, {"name", "bulb"}},
                               {{"extensions", light(2)}, {"translation", {0, 5, 0}}, {"rotation", {0, 1, 0, 0}}},
                               {{"extensions", light(3)}}};
  ImportReport report;
  const ScenePtr scene = load(builder, &report);
  ASSERT_EQ(scene->lights.size(), 4u);
  const PunctualLight &sun = scene->lights[0], &bulb = scene->lights[1], &spot = scene->lights[2];
  EXPECT_EQ(sun.type, PunctualLight::Type::directional);
  EXPECT_EQ(sun.name, "sun");
  EXPECT_EQ(sun.color, glm::vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(sun.intensity, 1000.0f);
  expectNear(sun.direction, {0, -1, 0});
  EXPECT_EQ(bulb.type, PunctualLight::Type::point);
  EXPECT_EQ(bulb.name, "bulb");
  EXPECT_EQ(bulb.position, glm::vec3(2, 4, 6));
  EXPECT_EQ(bulb.intensity, 40.0f);  // scale does not touch it
  EXPECT_EQ(bulb.range, 12.0f);
  EXPECT_EQ(bulb.color, glm::vec3(1.0f));
  EXPECT_EQ(spot.type, PunctualLight::Type::spot);
  EXPECT_EQ(spot.position, glm::vec3(0, 10, 0));
  expectNear(spot.direction, {0, 0, 1});
  EXPECT_EQ(spot.intensity, 1.0f);
  EXPECT_FALSE(std::isfinite(spot.range));
  EXPECT_FLOAT_EQ(spot.inner_cone, 0.25f);
  EXPECT_FLOAT_EQ(spot.outer_cone, 0.5f);
  EXPECT_EQ(scene->lights[3].inner_cone, 0.0f);
  EXPECT_FLOAT_EQ(scene->lights[3].outer_cone, std::atan(1.0f));
  EXPECT_EQ(report.lights, 4u);
}

// ---- The report ----

TEST(GltfFeatures, TheReportCountsAndSaysWhatIsMissing) {
  GltfBuilder builder = withMaterial({{"alphaMode", "BLEND"}});
  const int image = builder.image(kTexel);
  builder.document["materials"][0]["occlusionTexture"]["index"] = image;
  builder.document["materials"].push_back({{"alphaMode", "MASK"}, {"emissiveTexture", {{"index", image}}}});
  builder.document["samplers"] = {{{"wrapS", 33071}}};
  builder.document["textures"][0]["sampler"] = 0;
  json lines = builder.primitive();
  lines["mode"] = 1;
  builder.document["meshes"][0]["primitives"].push_back(lines);
  builder.document["meshes"][0]["primitives"].push_back(builder.primitive());
  builder.document["extensionsUsed"] = {"KHR_materials_ior", "KHR_materials_clearcoat"};
  builder.document["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}}, {{"mesh", 0}}, {{"mesh", 0}, {"scale", {0, 0, 0}}}};
  ImportReport report;
  load(builder, &report);
  EXPECT_THAT(report.file, ::testing::EndsWith("model.gltf"));
  EXPECT_EQ(report.meshes, 1u);
  EXPECT_EQ(report.primitives, 2u);
  EXPECT_EQ(report.triangles, 2u);
  EXPECT_EQ(report.materials, 2u);
  EXPECT_EQ(report.textures, 1u);
  EXPECT_EQ(report.instances, 2u);
  EXPECT_EQ(report.cameras, 0u);
  EXPECT_THAT(report.extensions, ElementsAre("KHR_materials_ior", "KHR_materials_clearcoat"));
  std::vector<std::string> lines_told;
  for (const ImportReport::Ignored& ignored : report.ignored) lines_told.push_back(line(ignored));
  EXPECT_THAT(lines_told,
              ::testing::UnorderedElementsAre("KHR_materials_clearcoat ignored: this extension is not supported",
                                              "alpha blending ignored: the surface is opaque",
                                              "occlusion textures ignored: paths of light find what is occluded",
                                              "points and lines ignored: only triangles have surfaces",
                                              "instances scaled to a point ignored: they cannot be seen"));
  EXPECT_EQ(summary(report),
            "1 mesh (2 primitives, 2 triangles), 2 materials, 1 texture, 2 instances, 0 lights, 0 cameras; "
            "extensions: KHR_materials_ior, KHR_materials_clearcoat");
}

}  // namespace
}  // namespace helio::scene
