// What glTF files become.
#include "scene/gltf.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/gltf_builder.h"

namespace helio::scene {
namespace {

using nlohmann::json;
using ::testing::ElementsAre;

ScenePtr load(const std::filesystem::path& file, const GltfOptions& options = {}) {
  Result<ScenePtr> scene = loadGltf(file, options);
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return scene ? *scene : std::make_shared<Scene>();
}

ScenePtr load(const GltfBuilder& builder, const GltfOptions& options = {}) {
  const TempFolder folder;
  return load(builder.save(folder), options);
}

/// Everything that the contract of scene.h promises.
void expectSound(const Scene& scene) {
  ASSERT_FALSE(scene.cameras.empty());
  for (const Mesh& mesh : scene.meshes) {
    const size_t vertices = mesh.positions.size();
    ASSERT_EQ(mesh.normals.size(), vertices);
    ASSERT_EQ(mesh.tangents.size(), vertices);
    ASSERT_EQ(mesh.uvs.size(), vertices);
    for (size_t v = 0; v < vertices; ++v) {
      ASSERT_NEAR(glm::length(mesh.normals[v]), 1.0f, 1e-4f) << mesh.name;
      ASSERT_NEAR(glm::length(glm::vec3(mesh.tangents[v])), 1.0f, 1e-4f) << mesh.name;
      ASSERT_EQ(std::fabs(mesh.tangents[v].w), 1.0f);
    }
    for (uint32_t index : mesh.indices) ASSERT_LT(index, vertices);
    uint32_t covered = 0;
    for (const Submesh& part : mesh.submeshes) {
      ASSERT_EQ(part.first_index, covered);
      ASSERT_EQ(part.index_count % 3, 0u);
      ASSERT_LT(part.material, scene.materials.size());
      covered += part.index_count;
    }
    ASSERT_EQ(covered, mesh.indices.size());
    ASSERT_FALSE(mesh.bounds.empty());
  }
  for (const Material& material : scene.materials) {
    for (uint32_t texture : {material.base_color_texture, material.normal_texture, material.metallic_roughness_texture,
                             material.emissive_texture}) {
      ASSERT_TRUE(texture == kNone || texture < scene.textures.size());
    }
  }
  for (const Texture& texture : scene.textures)
    ASSERT_EQ(texture.rgba.size(), size_t{4} * texture.width * texture.height);
  for (const Placement& placement : scene.placements) ASSERT_LT(placement.prefab, scene.prefabs.size());
}

TEST(Gltf, OneTriangle) {
  const ScenePtr scene = load(GltfBuilder{});
  expectSound(*scene);
  EXPECT_EQ(scene->name, "model");
  ASSERT_EQ(scene->meshes.size(), 1u);
  EXPECT_THAT(scene->meshes[0].positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)));
  EXPECT_THAT(scene->meshes[0].indices, ElementsAre(0, 1, 2));
  for (const glm::vec3& normal : scene->meshes[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  ASSERT_EQ(scene->prefabs.size(), 1u);
  EXPECT_EQ(scene->prefabs[0].name, "mesh_0");
  EXPECT_EQ(scene->prefabs[0].category, "model");
  EXPECT_TRUE(scene->prefabs[0].buildable);
  ASSERT_EQ(scene->placements.size(), 1u);
  EXPECT_EQ(scene->placements[0].transform, glm::mat4x3(1.0f));

  const Material& material = scene->materials[scene->meshes[0].submeshes[0].material];
  EXPECT_EQ(material.metallic, 1.0f);  // the specification's default material
  EXPECT_EQ(material.roughness, 1.0f);
  EXPECT_GT(scene->environment.sun.irradiance.x, 0.0f);
}

TEST(Gltf, GlbIsTheSameAsGltf) {
  const TempFolder folder;
  const GltfBuilder builder;
  const ScenePtr text = load(builder.save(folder)), binary = load(folder.write("model.glb", builder.glb()));
  expectSound(*binary);
  EXPECT_EQ(binary->meshes[0].positions, text->meshes[0].positions);
}

TEST(Gltf, BuffersMayBeDataUris) {
  GltfBuilder builder;  // the triangle's nine floats in base64
  builder.document["buffers"] = {
      {{"byteLength", 36},
       {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
  EXPECT_EQ(load(builder)->meshes[0].positions[2], glm::vec3(0, 1, 0));
}

TEST(Gltf, FilesBelowTheFolderMayBeNamedWithEscapes) {
  const TempFolder folder;
  GltfBuilder builder;
  folder.write("parts of it/a.bin", builder.bin);
  builder.document["buffers"] = {{{"byteLength", builder.bin.size()}, {"uri", "parts%20of%20it/a.bin"}}};
  EXPECT_EQ(load(builder.save(folder))->meshes[0].positions.size(), 3u);
}

TEST(Gltf, IndicesOfEverySize) {
  for (int size = 0; size < 3; ++size) {
    GltfBuilder builder;
    builder.primitive()["indices"] = size == 0   ? builder.indices<uint8_t>(kUnsignedByte, {2, 0, 1})
                                     : size == 1 ? builder.indices<uint16_t>(kUnsignedShort, {2, 0, 1})
                                                 : builder.indices<uint32_t>(kUnsignedInt, {2, 0, 1});
    EXPECT_THAT(load(builder)->meshes[0].positions,
                ElementsAre(glm::vec3(0, 1, 0), glm::vec3(0, 0, 0), glm::vec3(1, 0, 0)));
  }
}

TEST(Gltf, InterleavedAndStridedAccessors) {
  GltfBuilder builder;
  std::vector<float> interleaved;  // position, normal, uv, one float of padding
  for (int v = 0; v < 3; ++v)
    interleaved.insert(interleaved.end(), {float(v), float(v * v), 0, 0, 2, 0, 0.25f * float(v), 0.5f, NAN});
  const int view = builder.view(bytesOf(interleaved));
  builder.document["bufferViews"][view]["byteStride"] = 36;
  builder.attributes() = {{"POSITION", builder.accessor(view, 0, kFloat, 3, "VEC3")},
                          {"NORMAL", builder.accessor(view, 12, kFloat, 3, "VEC3")},
                          {"TEXCOORD_0", builder.accessor(view, 24, kFloat, 3, "VEC2")}};
  const ScenePtr scene = load(builder);
  expectSound(*scene);
  const Mesh& mesh = scene->meshes[0];
  EXPECT_THAT(mesh.positions, ElementsAre(glm::vec3(0, 0, 0), glm::vec3(1, 1, 0), glm::vec3(2, 4, 0)));
  EXPECT_THAT(mesh.normals, ElementsAre(glm::vec3(0, 1, 0), glm::vec3(0, 1, 0), glm::vec3(0, 1, 0)));  // normalised
  EXPECT_THAT(mesh.uvs, ElementsAre(glm::vec2(0, 0.5f), glm::vec2(0.25f, 0.5f), glm::vec2(0.5f, 0.5f)));
}

TEST(Gltf, NormalizedIntegerUvs) {
  GltfBuilder builder;
  const int bytes = builder.accessor(builder.view(bytesOf<uint8_t>({0, 255, 0, 0, 51, 0, 0, 0, 255, 102, 0, 0})), 0,
                                     kUnsignedByte, 3, "VEC2");
  builder.document["bufferViews"].back()["byteStride"] = 4;
  builder.document["accessors"][bytes]["normalized"] = true;
  builder.attributes()["TEXCOORD_0"] = bytes;
  EXPECT_THAT(load(builder)->meshes[0].uvs, ElementsAre(glm::vec2(0, 1), glm::vec2(0.2f, 0), glm::vec2(1, 0.4f)));

  const int shorts =
      builder.accessor(builder.view(bytesOf<uint16_t>({0, 65535, 13107, 0, 65535, 0})), 0, kUnsignedShort, 3, "VEC2");
  builder.document["accessors"][shorts]["normalized"] = true;
  builder.attributes()["TEXCOORD_0"] = shorts;
  EXPECT_THAT(load(builder)->meshes[0].uvs, ElementsAre(glm::vec2(0, 1), glm::vec2(0.2f, 0), glm::vec2(1, 0)));
}

TEST(Gltf, StripsAndFansKeepTheirOrientation) {
  for (int mode : {5, 6}) {
    GltfBuilder builder;
    const std::vector<float> strip = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0},
                             fan = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0};
    builder.attributes()["POSITION"] = builder.floats(mode == 5 ? strip : fan, "VEC3");
    builder.primitive()["mode"] = mode;
    const ScenePtr scene = load(builder);
    ASSERT_EQ(scene->meshes[0].indices.size(), 9u) << mode;
    for (const glm::vec3& normal : scene->meshes[0].normals) EXPECT_EQ(normal, glm::vec3(0, 0, 1)) << mode;
  }
}

TEST(Gltf, MissingNormalsAreFlat) {
  GltfBuilder builder;  // a tent of two faces that share an edge
  builder.attributes()["POSITION"] = builder.floats({0, 0, 0, 0, 1, 1, 1, 0, 0, -1, 0, 0}, "VEC3");
  builder.attributes()["TANGENT"] = builder.floats(std::vector<float>(16, NAN), "VEC4");  // ignored without normals
  builder.primitive()["indices"] = builder.indices<uint8_t>(kUnsignedByte, {0, 2, 1, 0, 1, 3});
  const ScenePtr scene = load(builder);
  expectSound(*scene);
  const Mesh& mesh = scene->meshes[0];
  ASSERT_EQ(mesh.positions.size(), 6u);  // no vertex is shared
  for (int face = 0; face < 2; ++face) {
    for (int corner = 0; corner < 3; ++corner)
      EXPECT_EQ(mesh.normals[size_t(3 * face + corner)], mesh.normals[size_t(3 * face)]);
  }
}

TEST(Gltf, GivenTangentsAreKept) {
  GltfBuilder builder;
  builder.attributes()["NORMAL"] = builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  builder.attributes()["TANGENT"] = builder.floats({0, 3, 0, -1, 0, 1, 0, -1, 0, 1, 0, -1}, "VEC4");
  EXPECT_EQ(load(builder)->meshes[0].tangents[0], glm::vec4(0, 1, 0, -1));
}

TEST(Gltf, PrimitivesTakeOnlyTheVerticesThatTheyUse) {
  GltfBuilder builder;
  std::vector<float> positions, normals;
  for (int v = 0; v < 1000; ++v) {
    positions.insert(positions.end(), {float(v), float(v % 7), 0});
    normals.insert(normals.end(), {0, 0, 1});
  }
  builder.attributes() = {{"POSITION", builder.floats(positions, "VEC3")}, {"NORMAL", builder.floats(normals, "VEC3")}};
  builder.primitive()["indices"] = builder.indices<uint16_t>(kUnsignedShort, {900, 100, 500, 500, 100, 901});
  const ScenePtr scene = load(builder);
  const Mesh& mesh = scene->meshes[0];
  EXPECT_THAT(mesh.positions,
              ElementsAre(glm::vec3(100, 2, 0), glm::vec3(500, 3, 0), glm::vec3(900, 4, 0), glm::vec3(901, 5, 0)));
  EXPECT_THAT(mesh.indices, ElementsAre(2, 0, 1, 1, 0, 3));
}

TEST(Gltf, EveryPrimitiveIsASubmesh) {
  GltfBuilder builder;
  builder.document["materials"] = {{{"name", "a"}}, {{"name", "b"}}};
  json first = builder.primitive(), lines = first;
  builder.primitive()["material"] = 1;
  lines["mode"] = 1;  // left out
  builder.document["meshes"][0]["primitives"].push_back(lines);
  builder.document["meshes"][0]["primitives"].push_back(first);
  const ScenePtr scene = load(builder);
  expectSound(*scene);
  ASSERT_EQ(scene->meshes[0].submeshes.size(), 2u);
  EXPECT_EQ(scene->materials[scene->meshes[0].submeshes[0].material].name, "b");
  EXPECT_EQ(scene->materials[scene->meshes[0].submeshes[1].material].name, "default");
  EXPECT_THAT(scene->meshes[0].indices, ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(Gltf, NodesCompose) {
  GltfBuilder builder;
  const float half = std::sqrt(0.5f);
  builder.document["nodes"] = {
      {{"translation", {10, 0, 0}},
       {"rotation", {0, 2 * half, 0, 2 * half}},
       {"children", {1, 2}}},  // a quarter turn, not of unit length
      {{"translation", {0, 0, 5}}, {"scale", {-2, 2, 2}}, {"mesh", 0}},
      {{"matrix", {1, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 7, 8, 9, 1}}, {"mesh", 0}},
      {{"mesh", 0}},  // in no scene
  };
  const ScenePtr scene = load(builder);
  ASSERT_EQ(scene->placements.size(), 2u);
  const auto map = [&](size_t placement, glm::vec3 p) {
    return scene->placements[placement].transform * glm::vec4(p, 1);
  };
  const auto near = [](glm::vec3 a, glm::vec3 b) { return glm::distance(a, b) < 1e-5f; };
  EXPECT_TRUE(near(map(0, {0, 0, 0}), {15, 0, 0}));  // z turns to x
  EXPECT_TRUE(near(map(0, {1, 0, 0}), {15, 0, 2}));  // mirrored x turns to +z
  EXPECT_TRUE(near(map(1, {0, 1, 0}), {19, 11, -7}));
  EXPECT_LT(glm::determinant(glm::mat3(scene->placements[0].transform)), 0.0f);
}

TEST(Gltf, WithoutScenesEveryRootIsShown) {
  GltfBuilder builder;
  builder.document.erase("scenes");
  builder.document.erase("scene");
  builder.document["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"mesh", 0}}};
  EXPECT_EQ(load(builder)->placements.size(), 2u);
}

TEST(Gltf, NodesScaledToAPointAreLeftOut) {
  GltfBuilder builder;
  builder.document["nodes"] = {
      {{"children", {1, 2}}}, {{"mesh", 0}, {"scale", {0, 0, 0}}}, {{"mesh", 0}, {"scale", {1, 0, 1}}}};
  EXPECT_EQ(load(builder)->placements.size(), 1u);
}

TEST(Gltf, PrefabNamesAreUnique) {
  GltfBuilder builder;
  json mesh = builder.document["meshes"][0];
  mesh["name"] = "house";
  builder.document["meshes"] = {mesh, mesh, mesh};
  builder.document["meshes"][1]["name"] = "house_2";
  const ScenePtr scene = load(builder);
  ASSERT_EQ(scene->prefabs.size(), 3u);
  EXPECT_EQ(scene->prefabs[0].name, "house");
  EXPECT_EQ(scene->prefabs[1].name, "house_2");
  EXPECT_EQ(scene->prefabs[2].name, "house_3");
}

GltfBuilder materials() {
  GltfBuilder builder;
  const int image = builder.image(png(2, 1, {255, 0, 0, 255, 0, 128, 255, 7}));
  builder.document["materials"] = {
      {{"name", "rich"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.5, 0.25, 1, 0.75}},
         {"metallicFactor", 0.125},
         {"roughnessFactor", 0.375},
         {"baseColorTexture", {{"index", image}}},
         {"metallicRoughnessTexture", {{"index", image}}}}},
       {"normalTexture", {{"index", image}, {"scale", 0.5}}},
       {"emissiveTexture", {{"index", image}}},
       {"emissiveFactor", {1, 0.5, 0}},
       {"alphaMode", "BLEND"},
       {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 12.5}}}}}}};
  builder.document["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  builder.document["extensionsRequired"] = {"KHR_materials_emissive_strength"};
  builder.primitive()["material"] = 0;
  return builder;
}

TEST(Gltf, MaterialsAndTheirTextures) {
  const ScenePtr scene = load(materials());
  expectSound(*scene);
  const Material& material = scene->materials[0];
  EXPECT_EQ(material.name, "rich");
  EXPECT_EQ(material.base_color, glm::vec4(0.5f, 0.25f, 1.0f, 0.75f));
  EXPECT_EQ(material.metallic, 0.125f);
  EXPECT_EQ(material.roughness, 0.375f);
  EXPECT_EQ(material.emission, glm::vec3(12.5f, 6.25f, 0.0f));
  EXPECT_EQ(material.normal_scale, 0.5f);

  ASSERT_EQ(scene->textures.size(), 2u);  // one image: once as colour, once as data
  EXPECT_EQ(material.base_color_texture, material.emissive_texture);
  EXPECT_EQ(material.normal_texture, material.metallic_roughness_texture);
  EXPECT_TRUE(scene->textures[material.base_color_texture].srgb);
  EXPECT_FALSE(scene->textures[material.normal_texture].srgb);
  EXPECT_EQ(scene->textures[0].width, 2u);
  EXPECT_EQ(scene->textures[0].height, 1u);
  EXPECT_THAT(scene->textures[0].rgba, ElementsAre(255, 0, 0, 255, 0, 128, 255, 7));
}

TEST(Gltf, CamerasComeAlong) {
  GltfBuilder builder;
  builder.document["cameras"] = {
      {{"type", "perspective"}, {"name", "eye"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 1}, {"znear", 0}}}}};
  builder.document["nodes"] = {{{"mesh", 0}, {"children", {1, 2}}},
                               {{"camera", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, 1, 0, 0}}},
                               {{"camera", 1}}};
  const ScenePtr scene = load(builder);
  ASSERT_EQ(scene->cameras.size(), 1u);
  const NamedCamera& eye = scene->cameras[0];
  EXPECT_EQ(eye.name, "eye");
  EXPECT_EQ(eye.camera.position, glm::vec3(1, 2, 3));
  EXPECT_NEAR(eye.camera.forward.z, 1.0f, 1e-6f);  // a half turn about y
  EXPECT_FLOAT_EQ(eye.camera.vfov, 0.5f);
  EXPECT_EQ(eye.environment.sun.irradiance, scene->environment.sun.irradiance);
}

TEST(Gltf, TheDefaultCameraSeesTheWholeModel) {
  GltfBuilder builder;
  builder.document["nodes"][0]["matrix"] = {300, 0, 0, 0, 0, 20, 0, 0, 0, 0, 1, 0, 1000, -50, 400, 1};
  const ScenePtr scene = load(builder);
  ASSERT_EQ(scene->cameras.size(), 1u);
  const Camera& camera = scene->cameras[0].camera;
  const glm::vec3 right = glm::normalize(glm::cross(camera.forward, camera.up)), up = glm::cross(right, camera.forward);
  const Aabb bounds = scene->bounds();
  for (int corner = 0; corner < 8; ++corner) {
    const glm::vec3 p{corner & 1 ? bounds.max.x : bounds.min.x, corner & 2 ? bounds.max.y : bounds.min.y,
                      corner & 4 ? bounds.max.z : bounds.min.z};
    const glm::vec3 d = p - camera.position;
    const float edge = std::tan(0.5f * camera.vfov) * glm::dot(d, camera.forward);
    EXPECT_LE(std::fabs(glm::dot(d, up)), edge);
    EXPECT_LE(std::fabs(glm::dot(d, right)), edge);
  }
}

// ---- Models that a checkout need not have ----

const std::filesystem::path kAssets = HELIOGRAPH_SHARED_ASSETS;

uint64_t placedTriangles(const Scene& scene) {
  uint64_t triangles = 0;
  for (const Placement& placement : scene.placements)
    triangles += scene.meshes[scene.prefabs[placement.prefab].mesh].indices.size() / 3;
  return triangles;
}

TEST(GltfAssets, KnownModelsHaveTheirTriangles) {
  const std::vector<std::pair<const char*, uint64_t>> known = {{"cornell/cornell.gltf", 32},
                                                               {"atrium/atrium.gltf", 564'358},
                                                               {"calib_plane/calib_plane.gltf", 2},
                                                               {"furnace_sphere/furnace_sphere.gltf", 16'128}};
  for (const auto& [name, triangles] : known) {
    if (!std::filesystem::exists(kAssets / name)) GTEST_SKIP() << "left out: " << name << " is not in ../shared/assets";
    const ScenePtr scene = load(kAssets / name);
    expectSound(*scene);
    EXPECT_EQ(placedTriangles(*scene), triangles) << name;
  }
}

TEST(GltfAssets, EveryModelIsImported) {
  if (!std::filesystem::exists(kAssets)) GTEST_SKIP() << "left out: there is no ../shared/assets";
  int models = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(kAssets)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    SCOPED_TRACE(entry.path().filename().string());
    expectSound(*load(entry.path()));
    ++models;
  }
  std::printf("imported %d models\n", models);
  EXPECT_GT(models, 0);
}

}  // namespace
}  // namespace helio::scene
