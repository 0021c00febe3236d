// What surfaces of glTF files look like: texture coordinates, vertex colours, unlit, ior and specular, normal maps
// under mirroring. Each scene's radiance is known.
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "scene/gltf.h"
#include "support/gltf_builder.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using nlohmann::json;

constexpr float kPi = 3.14159265f;

void expectNear(const glm::vec3& seen, const glm::vec3& expected, float tolerance, const std::string& what = "") {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen[c], expected[c], tolerance) << what << " channel " << c;
}

/// Straight down at (x, 0, z) from close by: the picture is a point.
scene::Camera above(float x, float z) { return lookAt({x, 2, z}, {x, 0, z}, 0.002f); }

glm::vec3 seenBy(Stage& stage, const scene::Camera& camera, uint32_t samples = 1,
                 render::MaterialOverride materials = render::MaterialOverride::none) {
  render::ViewSettings settings = referenceSettings(16, 16);
  settings.materials = materials;
  return mean(stage.accumulate(camera, settings, samples));
}

/// A quad under a sky of radiance 1.
scene::ScenePtr quadUnderSky(const scene::Material& material, const std::vector<glm::vec4>& colors = {}) {
  SceneBuilder b;
  scene::Mesh mesh = quad(2.0f);
  mesh.colors = colors;
  b.place(b.prefab("quad", mesh, b.material(material)));
  b.environment().sky = {glm::vec3(1.0f), glm::vec3(1.0f)};
  return b.build();
}

glm::vec3 seenUnderSky(const scene::Material& material, const scene::Camera& camera = above(0, 0),
                       uint32_t samples = 1) {
  Stage stage(quadUnderSky(material));
  return seenBy(stage, camera, samples);
}

// ---- Texture coordinates ----

/// Red, green; blue, white.
const std::vector<uint8_t> kFourTexels = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255};
constexpr float kFiltered = 0.01f;  // off a texel's centre by a little, linear filtering mixes in its neighbours
const glm::vec3 kRed(1, 0, 0), kGreen(0, 1, 0), kBlue(0, 0, 1), kWhite(1);

/// A file with one quad from (-1, 0, -1) to (1, 0, 1), uv set 0 from 0 to 1 along x and z, set 1 a quarter of that.
scene::GltfBuilder quadFile(const json& material) {
  scene::GltfBuilder b;
  b.attributes() = {{"POSITION", b.floats({-1, 0, -1, -1, 0, 1, 1, 0, 1, 1, 0, -1}, "VEC3")},
                    {"NORMAL", b.floats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3")},
                    {"TEXCOORD_0", b.floats({0, 0, 0, 1, 1, 1, 1, 0}, "VEC2")},
                    {"TEXCOORD_1", b.floats({0.25f, 0.25f, 0.25f, 0.5f, 0.5f, 0.5f, 0.5f, 0.25f}, "VEC2")}};
  b.primitive()["indices"] = b.indices<uint8_t>(scene::kUnsignedByte, {0, 1, 2, 0, 2, 3});
  b.document["materials"] = {material};
  b.primitive()["material"] = 0;
  b.image(scene::png(2, 2, kFourTexels));
  return b;
}

/// The file's scene under a sky of radiance 1 alone.
scene::ScenePtr underSky(const scene::GltfBuilder& file) {
  const scene::TempFolder folder;
  Result<scene::ScenePtr> loaded = scene::loadGltf(file.save(folder));
  if (!loaded) throw std::runtime_error(loaded.error().message);
  auto changed = std::make_shared<scene::Scene>(**loaded);
  changed->environment = {{}, {glm::vec3(1.0f), glm::vec3(1.0f)}};
  return changed;
}

json texture(const json& transform, int set = 0) {
  return {{"index", 0}, {"texCoord", set}, {"extensions", {{"KHR_texture_transform", transform}}}};
}

TEST(Surface, TextureTransformsPickTheRightTexel) {
  struct Case {
    const char* what;
    json info;
    glm::vec3 expected;  ///< at (-0.5, -0.5), which is uv (0.25, 0.25): the red texel's centre
  };
  const Case cases[] = {
      {"identity", texture(json::object()), kRed},
      {"moved along u", texture({{"offset", {0.5, 0}}}), kGreen},
      {"moved along v", texture({{"offset", {0, 0.5}}}), kBlue},
      {"scaled", texture({{"scale", {3, 3}}}), kWhite},
      {"scaled, then moved", texture({{"scale", {3, 1}}, {"offset", {0.5, 0.5}}}), kBlue},
      // Counter-clockwise, v running down: (0.25, 0.25) turns to (0.25, -0.25), in the next repetition (0.25, 0.75).
      {"turned", texture({{"rotation", 0.5 * double{kPi}}}), kBlue},
      {"turned back", texture({{"rotation", -0.5 * double{kPi}}}), kGreen},
      // Set 1 has (0.3125, 0.3125) there; four times that is (1.25, 1.25).
      {"second set", texture({{"scale", {4, 4}}}, 1), kRed},
      {"second set by the transform", texture({{"texCoord", 1}, {"scale", {4, 4}}, {"offset", {0.5, 0.5}}}), kWhite},
  };
  for (const Case& c : cases) {
    Stage stage(underSky(quadFile({{"pbrMetallicRoughness", {{"baseColorTexture", c.info}}},
                                   {"extensions", {{"KHR_materials_unlit", json::object()}}}})));
    expectNear(seenBy(stage, above(-0.5f, -0.5f)), c.expected, kFiltered, c.what);
  }
}

// Emission by one mapping, base colour by another: the emissive channel is read by light sampling too.
TEST(Surface, EachTextureHasItsOwnCoordinates) {
  const json material = {{"pbrMetallicRoughness", {{"baseColorTexture", texture({{"offset", {0.5, 0}}})}}},
                         {"emissiveTexture", texture({{"offset", {0, 0.5}}})},
                         {"emissiveFactor", {0.5, 0.5, 0.5}}};
  Stage stage(underSky(quadFile(material)));
  constexpr auto kLambert = render::MaterialOverride::lambert;
  // Lambert under a sky of 1: emission plus base colour.
  expectNear(seenBy(stage, above(-0.5f, -0.5f), 4, kLambert), 0.5f * kBlue + kGreen, kFiltered);
  expectNear(seenBy(stage, above(0.5f, -0.5f), 4, kLambert), 0.5f * kWhite + kRed, kFiltered);
  expectNear(seenBy(stage, above(0.5f, 0.5f), 4, kLambert), 0.5f * kGreen + kBlue, kFiltered);
}

// Six textures with six mappings are the same as their values, where these are those of one texel.
TEST(Surface, SixChannels) {
  scene::GltfBuilder file = quadFile(json::object());
  // In the red texel (191, 153, 102, 204), in the others what would show.
  const scene::TempFolder folder;
  const int image = file.image(scene::png(2, 2, {191, 153, 102, 204, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 0}));
  int moved = 0;
  const auto info = [&] {  // every one moves by other whole repetitions: a mapping of its own, the same texel
    ++moved;
    return json{{"index", image}, {"extensions", {{"KHR_texture_transform", {{"offset", {moved, -moved}}}}}}};
  };
  json material = {{"emissiveFactor", {0.25, 0.25, 0.25}}};
  material["emissiveTexture"] = info();
  material["pbrMetallicRoughness"] = {{"baseColorTexture", info()}, {"metallicRoughnessTexture", info()}};
  material["normalTexture"] = info();
  material["extensions"]["KHR_materials_specular"] = {{"specularTexture", info()}, {"specularColorTexture", info()}};
  file.document["materials"][0] = material;
  const scene::ScenePtr textured = underSky(file);
  ASSERT_EQ(textured->meshes[0].more_uvs.size(), 5u);

  // The same with one texel and one mapping.
  auto plain = std::make_shared<scene::Scene>(*textured);
  for (scene::Texture& t : plain->textures) {
    t.width = t.height = 1;
    t.rgba = {191, 153, 102, 204};
  }
  plain->meshes[0].more_uvs.clear();
  plain->materials[0].uv_channel = {};
  Stage a(textured), b(plain);
  const scene::Camera camera = above(-0.5f, -0.5f);
  const glm::vec3 expected = seenBy(b, camera, 16);
  EXPECT_GT(expected.x, 0.1f);
  expectNear(seenBy(a, camera, 16), expected, 1e-3f);
}

// ---- Vertex colours ----

TEST(Surface, VertexColorsMultiplyTheBaseColor) {
  Stage one(quadUnderSky(lambert({0.5f, 0.5f, 0.8f}), std::vector<glm::vec4>(4, {0.5f, 1.0f, 0.25f, 1.0f})));
  expectNear(seenBy(one, above(0.3f, 0.1f)), {0.25f, 0.5f, 0.2f}, 1e-3f);
  // Interpolated in the linear: white at x = -1, black at x = 1.
  Stage ramp(quadUnderSky(lambert(glm::vec3(1.0f)), {glm::vec4(1), glm::vec4(1), glm::vec4(0), glm::vec4(0)}));
  for (const float x : {-0.5f, 0.0f, 0.75f})
    expectNear(seenBy(ramp, above(x, 0.2f)), glm::vec3(0.5f - 0.5f * x), 2e-3f);
}

// ---- Unlit ----

scene::Material unlit(const glm::vec3& color) {
  scene::Material m;
  m.base_color = glm::vec4(color, 1.0f);
  m.unlit = true;
  return m;
}

TEST(Surface, UnlitShowsItsColorInAnyLight) {
  const glm::vec3 color(0.25f, 0.5f, 0.75f);
  for (const float light : {0.0f, 5.0f}) {
    SceneBuilder b;
    b.place(b.prefab("quad", quad(2.0f), b.material(unlit(color))));
    b.environment().sky = {glm::vec3(light), glm::vec3(light)};
    b.environment().sun.irradiance = glm::vec3(light);
    Stage stage(b.build());
    expectNear(seenBy(stage, above(0, 0)), color, 1e-6f);
    expectNear(seenBy(stage, lookAt({0, -2, 0}, {0, 0, 0}, 0.01f)), color, 1e-6f, "from below");
  }
}

// A black unlit quad between sun and floor: the floor's middle gets nothing, beside the shadow it gets albedo E / pi.
TEST(Surface, UnlitCastsShadows) {
  SceneBuilder b;
  b.place(b.prefab("floor", quad(20.0f), b.material(lambert(glm::vec3(0.5f)))));
  b.place(b.prefab("shade", quad(1.0f), b.material(unlit(glm::vec3(0.0f)))), at({0, 1, 0}));
  b.environment().sun.irradiance = glm::vec3(kPi);
  Stage stage(b.build());
  expectNear(seenBy(stage, lookAt({3, 0.5f, 0}, {0, 0, 0}, 0.01f)), glm::vec3(0.0f), 1e-6f);
  expectNear(seenBy(stage, lookAt({3, 0.5f, 0}, {2, 0, 0}, 0.01f), 4), glm::vec3(0.5f), 2e-3f);
}

// Inside an unlit box a Lambert surface shows albedo times the box's colour: scattered rays find what shines.
TEST(Surface, UnlitLightsWhatItSurrounds) {
  SceneBuilder b;
  b.place(b.prefab("box", cube(), b.material(unlit(glm::vec3(0.5f)))), at({0, 0, 0}, 10.0f));
  b.place(b.prefab("floor", quad(2.0f), b.material(lambert(glm::vec3(0.8f)))));
  Stage stage(b.build());
  expectNear(seenBy(stage, above(0, 0), 4), glm::vec3(0.4f), 1e-3f);
}

// ---- Index of refraction, specular ----

scene::Material blackGlaze(float ior) {
  scene::Material m;
  m.base_color = {0, 0, 0, 1};
  m.roughness = 0.0f;
  m.ior = ior;
  return m;
}

// A smooth black dielectric under a sky of 1 shows its reflectance: ((ior - 1) / (ior + 1))^2 straight down.
TEST(Surface, IorSetsTheReflectance) {
  for (const float ior : {1.33f, 1.5f, 2.0f, 3.0f}) {
    const float r = (ior - 1) / (ior + 1);
    expectNear(seenUnderSky(blackGlaze(ior)), glm::vec3(r * r), 1e-4f, std::to_string(ior));
  }
  expectNear(seenUnderSky(blackGlaze(0.0f)), glm::vec3(1.0f), 1e-4f);  // glTF: infinite
}

TEST(Surface, IorOneAndSpecularZeroReflectNothing) {
  const scene::Camera grazing = lookAt({2, 0.1f, 0}, {0, 0, 0}, 0.002f);
  scene::Material no_specular = blackGlaze(1.5f);
  no_specular.specular = 0.0f;
  for (scene::Material m : {blackGlaze(1.0f), no_specular}) {
    for (const float roughness : {0.0f, 0.5f}) {
      m.roughness = roughness;
      for (const scene::Camera& camera : {above(0, 0), grazing})
        expectNear(seenUnderSky(m, camera, 4), glm::vec3(0.0f), 1e-6f);
    }
    // What is left is Lambert.
    m.base_color = {0.8f, 0.5f, 0.2f, 1};
    expectNear(seenUnderSky(m, grazing, 4), {0.8f, 0.5f, 0.2f}, 1e-3f);
  }
  EXPECT_GT(seenUnderSky(blackGlaze(1.5f), grazing).x, 0.3f);  // where the default shines
}

// Ior 1.5 said by the record of a scene that has such effects, and by the constant of one that has not.
TEST(Surface, IorOneAndAHalfIsTheDefault) {
  scene::Material said;
  said.base_color = {0.6f, 0.3f, 0.1f, 1};
  said.roughness = 0.4f;
  scene::Material almost = said;
  almost.specular = 0.9999999f;  // enough to have a record
  ASSERT_FALSE(said.hasOwnSpecular());
  ASSERT_TRUE(almost.hasOwnSpecular());
  const scene::Camera camera = lookAt({2, 1, 0}, {0, 0, 0}, 0.002f);
  expectNear(seenUnderSky(almost, camera, 16), seenUnderSky(said, camera, 16), 1e-4f);
}

TEST(Surface, SpecularWeighsAndTintsTheReflection) {
  scene::Material m = blackGlaze(2.0f);  // reflects 1/9
  m.specular = 0.5f;
  m.specular_color = {1.0f, 0.25f, 0.0f};
  expectNear(seenUnderSky(m), glm::vec3(1.0f, 0.25f, 0.0f) / 18.0f, 1e-4f);
  m.specular_color = glm::vec3(100.0f);  // what would reflect more than there is
  expectNear(seenUnderSky(m), glm::vec3(0.5f), 1e-4f);
  m.metallic = 1.0f;  // a metal has none of it
  m.base_color = {0.9f, 0.6f, 0.3f, 1};
  expectNear(seenUnderSky(m), {0.9f, 0.6f, 0.3f}, 1e-3f);
}

// Under a sky of 1 nothing reflects more than it gets, and the diffuse part keeps its hue under a tinted glaze.
TEST(Surface, TintedSpecularConservesEnergy) {
  scene::Material m;
  m.base_color = {1, 1, 1, 1};
  m.roughness = 0.3f;
  m.ior = 2.0f;
  m.specular_color = {1.0f, 0.0f, 0.0f};
  const glm::vec3 seen = seenUnderSky(m, above(0, 0), 64);
  EXPECT_NEAR(seen.x, 1.0f, 0.02f);
  EXPECT_NEAR(seen.y, 8.0f / 9.0f, 0.02f);
  EXPECT_NEAR(seen.z, seen.y, 0.005f);
}

// ---- Mirroring ----

constexpr uint8_t kMap[3] = {191, 166, 230};  // a normal that leans along both axes

/// A quad, Lambert but for its normal map, whose bumps lean towards the tangent x and, handedness 1, -z.
scene::ScenePtr bumps(float handedness, const glm::mat4x3& transform, const glm::vec3& sun) {
  SceneBuilder b;
  scene::Material m;
  m.base_color = glm::vec4(1.0f);
  m.specular = 0.0f;
  m.normal_texture = b.texture({"bumps", 1, 1, {kMap[0], kMap[1], kMap[2], 255}, false});
  scene::Mesh mesh = quad(2.0f);
  mesh.tangents.assign(4, glm::vec4(1, 0, 0, handedness));
  b.place(b.prefab("quad", mesh, b.material(m)), transform);
  b.environment().sun = {glm::normalize(sun), glm::vec3(kPi), 0.0093f};
  return b.build();
}

/// The normal of those bumps in object space: cross((0, 1, 0), (1, 0, 0)) = (0, 0, -1).
glm::vec3 bumpNormal(float handedness) {
  const glm::vec3 m = glm::vec3(kMap[0], kMap[1], kMap[2]) / 127.5f - 1.0f;
  return glm::normalize(glm::vec3(m.x, m.z, -m.y * handedness));
}

TEST(Surface, NormalMapsWithMirroredTangents) {
  const glm::vec3 sun(-0.4f, -1.0f, 0.5f);
  for (const float handedness : {1.0f, -1.0f}) {
    const float expected = glm::dot(bumpNormal(handedness), -glm::normalize(sun));
    Stage stage(bumps(handedness, glm::mat4x3(1.0f), sun));
    expectNear(seenBy(stage, above(0, 0), 8), glm::vec3(expected), 3e-3f, std::to_string(handedness));
  }
  EXPECT_GT(std::abs(bumpNormal(1.0f).z - bumpNormal(-1.0f).z), 0.5f);  // or the test would see no difference
}

// A mirrored instance in mirrored light is the mirror image; seen from behind, bumps are dents.
TEST(Surface, MirroredInstancesShadeLikeUnmirrored) {
  const glm::vec3 sun(-0.4f, -1.0f, 0.5f);
  for (const glm::vec3 mirror : {glm::vec3(-1, 1, 1), glm::vec3(1, 1, -1), glm::vec3(-2, 3, 0.5f), glm::vec3(1, -1, 1),
                                 glm::vec3(-1, -1, -1), glm::vec3(-1, 1, -1)}) {
    const glm::mat4x3 transform(glm::vec3(mirror.x, 0, 0), glm::vec3(0, mirror.y, 0), glm::vec3(0, 0, mirror.z),
                                glm::vec3(0.0f));
    // Tangents go with the map, normals with its inverse: bumps lean as much against their own surface.
    const glm::vec3 side = glm::sign(mirror);
    for (const float from : {1.0f, -1.0f}) {  // the front, and from behind
      const glm::vec3 light = from * side * sun;
      const float expected = glm::dot(side * bumpNormal(1.0f), -glm::normalize(light)) * from;
      Stage stage(bumps(1.0f, transform, light));
      const scene::Camera camera = lookAt({0, 2.0f * from * side.y, 0}, {0, 0, 0}, 0.002f);
      expectNear(seenBy(stage, camera, 8), glm::vec3(expected), 3e-3f,
                 fmt::format("scale {} {} {}, side {}", mirror.x, mirror.y, mirror.z, from));
    }
  }
}

// Rasterised primary hits of a tick share one point of their pixel, be there one sample or several: what is seen there
// is read over the same footprint. Where samples spread over the pixel, each reads a part of it.
TEST(Surface, SeveralSamplesOfOnePointReadTexturesAsOneDoes) {
  SceneBuilder b;
  scene::Texture checks{"checks", 64, 64, {}, true, {}};
  for (uint32_t y = 0; y < 64; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const auto value = static_cast<uint8_t>((x + y) % 2 ? 255 : 0);
      checks.rgba.insert(checks.rgba.end(), {value, value, value, 255});
    }
  scene::Material material;
  material.unlit = true;
  material.base_color_texture = b.texture(checks);
  b.place(b.prefab("floor", quad(8.0f), b.material(material)));
  const scene::ScenePtr scene = b.build();
  render::ViewSettings settings;
  settings.width = 96;
  settings.height = 54;
  settings.accumulate = false;
  settings.auto_exposure = false;
  settings.keep_radiance = true;
  const scene::Camera camera = lookAt({0.0f, 1.0f, 4.5f}, {0.0f, 0.0f, 0.0f}, 0.9f);
  const render::Frame one = Stage(scene).tick(camera, settings);
  settings.samples = 4;
  const render::Frame four = Stage(scene).tick(camera, settings);
  settings.primary = render::Primary::traced;
  const render::Frame spread = Stage(scene).tick(camera, settings);
  double apart = 0.0, spread_apart = 0.0;
  for (size_t i = 0; i < one.radiance.size(); ++i) {
    apart = std::max<double>(apart, std::abs(one.radiance[i] - four.radiance[i]));
    spread_apart = std::max<double>(spread_apart, std::abs(one.radiance[i] - spread.radiance[i]));
  }
  EXPECT_LT(apart, 1e-3);
  EXPECT_GT(spread_apart, 0.05);
}

}  // namespace
}  // namespace helio::test
