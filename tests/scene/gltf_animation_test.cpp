// Skins, morph targets and animations of glTF files.
#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/deform.h"
#include "scene/gltf.h"
#include "support/gltf_builder.h"

namespace helio::scene {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

ScenePtr load(const GltfBuilder& builder) {
  const TempFolder folder;
  Result<ScenePtr> scene = loadGltf(builder.save(folder));
  EXPECT_TRUE(scene.ok()) << scene.error().message;
  return scene ? *scene : std::make_shared<Scene>();
}

std::string refusal(const GltfBuilder& builder) {
  const TempFolder folder;
  const Result<ScenePtr> scene = loadGltf(builder.save(folder));
  return scene.ok() ? "accepted" : scene.error().message;
}

/// Adds an animation with one channel.
void animate(GltfBuilder& b, int node, const std::string& path, const std::string& interpolation,
             const std::vector<float>& times, const std::vector<float>& values, const std::string& type) {
  const int input = b.floats(times, "SCALAR"), output = b.floats(values, type);
  json sampler = {{"input", input}, {"output", output}};
  if (!interpolation.empty()) sampler["interpolation"] = interpolation;
  b.document["animations"].push_back(
      {{"samplers", {sampler}}, {"channels", {{{"sampler", 0}, {"target", {{"node", node}, {"path", path}}}}}}});
}

/// The triangle, moved by its node's parent: node 0 carries it, node 1 is the parent at x = 10.
GltfBuilder carried() {
  GltfBuilder b;
  b.document["nodes"] = {{{"mesh", 0}, {"translation", {0, 1, 0}}}, {{"children", {0}}, {"translation", {10, 0, 0}}}};
  b.document["scenes"][0]["nodes"] = {1};
  animate(b, 1, "translation", "", {0, 2}, {10, 0, 0, 10, 0, 8}, "VEC3");
  return b;
}

TEST(GltfAnimation, ANodesAncestorsMoveItRelativeToWhereItRests) {
  const ScenePtr scene = load(carried());
  ASSERT_EQ(scene->placements.size(), 1u);
  EXPECT_EQ(scene->placements[0].transform[3], glm::vec3(10, 1, 0));
  const Prefab& prefab = scene->prefabs[scene->placements[0].prefab];
  ASSERT_NE(prefab.rig, kNone);
  ASSERT_NE(prefab.node, kNone);
  EXPECT_FALSE(scene->meshes[prefab.mesh].deforms());
  const Rig& rig = scene->rigs[prefab.rig];
  ASSERT_EQ(rig.clips.size(), 1u);
  EXPECT_EQ(rig.clips[0].duration, 2.0f);
  const auto placeAt = [&](float time) {
    return concatenate(scene->placements[0].transform, nodesAt(rig, rig.clips[0], time)[prefab.node])[3];
  };
  EXPECT_NEAR(glm::distance(placeAt(0.0f), glm::vec3(10, 1, 0)), 0.0f, 1e-5f);
  EXPECT_NEAR(glm::distance(placeAt(1.0f), glm::vec3(10, 1, 4)), 0.0f, 1e-5f);
}

TEST(GltfAnimation, FurtherClipsCanBeBuilt) {
  GltfBuilder b = carried();
  animate(b, 0, "scale", "STEP", {0.5f}, {2, 2, 2}, "VEC3");
  b.document["animations"][1]["name"] = "grow";
  const ScenePtr scene = load(b);
  ASSERT_EQ(scene->prefabs.size(), 2u);
  EXPECT_EQ(scene->prefabs[1].name, "mesh_0:grow");
  EXPECT_EQ(scene->prefabs[1].clip, 1u);
  EXPECT_EQ(scene->prefabs[1].mesh, scene->prefabs[0].mesh);
  EXPECT_TRUE(scene->prefabs[1].buildable);
}

/// The triangle on two joints: its third corner on the second, which turns about z by up to 90 degrees.
GltfBuilder skinned() {
  GltfBuilder b;
  b.document["nodes"] = {
      {{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}}, {{"children", {2}}}, {{"translation", {0, 1, 0}}}};
  b.document["scenes"][0]["nodes"] = {0, 1};
  b.attributes()["JOINTS_0"] = b.integers<uint8_t>(kUnsignedByte, "VEC4", false, {0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0});
  b.attributes()["WEIGHTS_0"] = b.floats({1, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0}, "VEC4");
  std::vector<float> matrices(32, 0.0f);
  for (const size_t i : {0u, 5u, 10u, 15u, 16u, 21u, 26u, 31u}) matrices[i] = 1.0f;
  matrices[16 + 13] = -1.0f;  // the second joint rests at y = 1
  const int inverse = b.accessor(b.view(helio::scene::bytesOf(matrices)), 0, kFloat, 2, "MAT4");
  b.document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
  const float h = std::sqrt(0.5f);
  animate(b, 2, "rotation", "LINEAR", {0, 1}, {0, 0, 0, 1, 0, 0, h, h}, "VEC4");
  animate(b, 1, "translation", "STEP", {0}, {0, 0, 5}, "VEC3");
  return b;
}

TEST(GltfAnimation, SkinsFollowTheirJointsAndNotTheirNode) {
  const ScenePtr scene = load(skinned());
  ASSERT_EQ(scene->placements.size(), 1u);
  EXPECT_EQ(scene->placements[0].transform[3], glm::vec3(0.0f));
  const Prefab& prefab = scene->prefabs[scene->placements[0].prefab];
  const Mesh& mesh = scene->meshes[prefab.mesh];
  const Rig& rig = scene->rigs[prefab.rig];
  EXPECT_TRUE(mesh.deforms());
  EXPECT_EQ(prefab.node, kNone);
  EXPECT_EQ(rig.clips.size(), 2u);
  EXPECT_EQ(mesh.skin[2].weights, glm::vec4(1, 0, 0, 0));  // normalised
  const auto turned = deformedPositions(mesh, rig, rig.clips[0], 1.0f);
  EXPECT_NEAR(glm::distance(turned[1], glm::vec3(1, 0, 0)), 0.0f, 1e-5f);
  EXPECT_NEAR(glm::distance(turned[2], glm::vec3(0, 1, 0)), 0.0f, 1e-5f);  // at the joint itself: it stays
  const auto moved = deformedPositions(mesh, rig, rig.clips[1], 0.0f);
  EXPECT_NEAR(glm::distance(moved[2], glm::vec3(0, 1, 5)), 0.0f, 1e-5f);
  EXPECT_GE(mesh.bounds.max.z, 5.0f);
}

TEST(GltfAnimation, MorphTargetsFollowTheirWeights) {
  GltfBuilder b;
  const int target = b.floats({0, 0, 0, 0, 0, 0, 0, 2, 0}, "VEC3"),
            other = b.floats(std::vector<float>(9, 1.0f), "VEC3");
  b.primitive()["targets"] = {{{"POSITION", target}}, {{"POSITION", other}}};
  b.document["meshes"][0]["weights"] = {0.0, 0.25};
  animate(b, 0, "weights", "LINEAR", {0, 1}, {0, 0, 1, 0.5f}, "SCALAR");
  const ScenePtr scene = load(b);
  const Prefab& prefab = scene->prefabs[0];
  const Mesh& mesh = scene->meshes[0];
  ASSERT_EQ(mesh.morph_targets.size(), 2u);
  const Rig& rig = scene->rigs[prefab.rig];
  EXPECT_EQ(rig.weights, (std::vector<float>{0.0f, 0.25f}));
  const auto half = deformedPositions(mesh, rig, rig.clips[0], 0.5f);
  EXPECT_NEAR(glm::distance(half[2], glm::vec3(0.25f, 2.25f, 0.25f)), 0.0f, 1e-5f);
  EXPECT_NEAR(glm::distance(half[0], glm::vec3(0.25f)), 0.0f, 1e-5f);
}

TEST(GltfAnimation, WhatNothingMovesStaysRigid) {
  GltfBuilder b;
  b.primitive()["targets"] = {{{"POSITION", 0}}};
  const ScenePtr still = load(b);
  EXPECT_FALSE(still->meshes[0].deforms());
  EXPECT_EQ(still->prefabs[0].rig, kNone);
  EXPECT_TRUE(still->rigs.empty());
}

TEST(GltfAnimation, RefusesWhatMakesNoSense) {
  const auto broken = [](auto&& change, GltfBuilder b = skinned()) {
    change(b);
    return refusal(b);
  };
  EXPECT_THAT(broken([](auto& b) { b.document["skins"][0]["joints"] = {1, 9}; }), HasSubstr("skins[0].joints[1]"));
  EXPECT_THAT(broken([](auto& b) { b.document["skins"][0]["joints"] = json::array(); }), HasSubstr("skins[0].joints"));
  EXPECT_THAT(broken([](auto& b) { b.document["skins"][0]["joints"] = {1}; }), HasSubstr("joint 1"));
  EXPECT_THAT(broken([](auto& b) { b.document["skins"][0]["inverseBindMatrices"] = 0; }), HasSubstr("accessors[0]"));
  EXPECT_THAT(broken([](auto& b) { b.document["nodes"][0]["skin"] = 3; }), HasSubstr("nodes[0].skin"));
  EXPECT_THAT(broken([](auto& b) { b.document["animations"][0]["channels"][0]["sampler"] = 1; }),
              HasSubstr("animations[0].channels[0].sampler"));
  EXPECT_THAT(broken([](auto& b) { b.document["animations"][0]["samplers"][0]["input"] = 99; }),
              HasSubstr("animations[0].samplers[0].input"));
  EXPECT_THAT(broken([](auto& b) { b.document["animations"][0]["samplers"][0]["interpolation"] = "BEZIER"; }),
              HasSubstr("LINEAR, STEP or CUBICSPLINE"));
  EXPECT_THAT(broken([](auto& b) { b.document["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }),
              HasSubstr("need 6"));
  EXPECT_THAT(broken([](auto& b) {
                animate(b, 1, "translation", "", {1, 1}, {0, 0, 0, 1, 1, 1}, "VEC3");
              }),
              HasSubstr("must be 0 or more, and rise"));
  EXPECT_THAT(broken([](auto& b) {
                animate(b, 1, "scale", "", {0, 1}, {0, 0, 0, NAN, 1, 1}, "VEC3");
              }),
              HasSubstr("must be finite"));
  EXPECT_THAT(broken([](auto& b) {
                b.primitive()["targets"] = {{{"POSITION", 77}}};
              }),
              HasSubstr("targets[0].POSITION"));
}

/// A model of the Khronos set, if it is there.
ScenePtr khronos(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(HELIOGRAPH_SHARED_ASSETS) / "khronos" / name;
  for (const char* extension : {".glb", ".gltf"}) {
    const std::filesystem::path file = folder / (name + extension);
    if (!std::filesystem::exists(file)) continue;
    const Result<ScenePtr> scene = loadGltf(file);
    EXPECT_TRUE(scene.ok()) << scene.error().message;
    return scene ? *scene : nullptr;
  }
  return nullptr;
}

#define MODEL_OR_SKIP(scene, name)      \
  const ScenePtr scene = khronos(name); \
  if (!(scene)) GTEST_SKIP() << "there is no " << HELIOGRAPH_SHARED_ASSETS << "/khronos/" << (name)

TEST(KhronosAnimation, FoxHasThreeGaits) {
  MODEL_OR_SKIP(fox, "Fox");
  ASSERT_EQ(fox->rigs.size(), 1u);
  EXPECT_EQ(fox->rigs[0].clips.size(), 3u);
  EXPECT_EQ(fox->rigs[0].joints.size(), 24u);
  EXPECT_EQ(fox->prefabs.size(), 3u);
  EXPECT_LT(fox->meshes[0].bounds.extent().y, 200.0f);  // it stays a fox
  EXPECT_GT(fox->meshes[0].bounds.extent().y, 60.0f);
}

TEST(KhronosAnimation, RiggedFigureAndSimpleSkinBend) {
  for (const char* name : {"RiggedFigure", "SimpleSkin"}) {
    MODEL_OR_SKIP(scene, name);
    ASSERT_EQ(scene->rigs.size(), 1u) << name;
    const Rig& rig = scene->rigs[0];
    const Mesh& mesh = scene->meshes[0];
    const auto a = deformedPositions(mesh, rig, rig.clips[0], 0.0f);
    const auto b = deformedPositions(mesh, rig, rig.clips[0], 0.4f * rig.clips[0].duration);
    float most = 0.0f;
    for (size_t v = 0; v < a.size(); ++v) most = std::max(most, glm::distance(a[v], b[v]));
    EXPECT_GT(most, 0.05f * glm::length(mesh.bounds.extent())) << name;
    EXPECT_LT(most, glm::length(mesh.bounds.extent())) << name;
  }
}

TEST(KhronosAnimation, InterpolationTestHasNineKindsOfMotion) {
  MODEL_OR_SKIP(scene, "InterpolationTest");
  EXPECT_EQ(scene->rigs.size(), 9u);
  for (const Rig& rig : scene->rigs) EXPECT_EQ(rig.clips.size(), 1u);
}

}  // namespace
}  // namespace helio::scene
