// Files that are wrong: each gives an error that names what is wrong, and nothing else happens.
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gltf_malformed.h"

namespace helio::scene {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A PNG whose header asks for `width` x `height` and that ends there.
std::string pngHeader(uint32_t width, uint32_t height, char colour_type) {
  const auto big = [](uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return "\x89PNG\r\n\x1a\n" + big(13) + "IHDR" + big(width) + big(height) + std::string{8, colour_type, 0, 0, 0} +
         big(0);
}

void useImage(GltfBuilder& b, const std::string& encoded) {
  b.document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", b.image(encoded)}}}}}}};
  b.primitive()["material"] = 0;
}

void setFloat(GltfBuilder& b, size_t index, float value) { std::memcpy(b.bin.data() + 4 * index, &value, 4); }

json chain(int nodes) {
  json list = json::array();
  for (int i = 0; i < nodes; ++i) list.push_back(i + 1 < nodes ? json{{"children", {i + 1}}} : json{{"mesh", 0}});
  return list;
}

std::vector<Malformed> malformed() {
  const auto inv = ErrorKind::invalid;
  using B = GltfBuilder&;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  return {
      // Accessors, views, buffers
      {"IndexOutOfRange",
       [](B b) {
         b.primitive()["indices"] = b.indices<uint8_t>(kUnsignedByte, {0, 1, 3});
       },
       inv, "accessors[1][2] is 3: there are 3 vertices"},
      {"IndexIsRestart",
       [](B b) {
         b.primitive()["indices"] = b.indices<uint32_t>(kUnsignedInt, {0, 1, 0xffffffffu});
       },
       inv, "accessors[1][2] is 4294967295"},
      {"CountTimesStrideOverflows", [](B b) { b.document["accessors"][0]["count"] = uint64_t{1} << 53; }, inv,
       "accessors[0].count is 9007199254740992: its view has room for 3"},
      {"CountBeyondIntegers", [](B b) { b.document["accessors"][0]["count"] = 0x1555555555555556ull; }, inv,
       "accessors[0].count"},  // times 12 it is 8
      {"CountOneTooMany", [](B b) { b.document["accessors"][0]["count"] = 4; }, inv,
       "accessors[0].count is 4: its view has room for 3"},
      {"CountZero", [](B b) { b.document["accessors"][0]["count"] = 0; }, inv, "accessors[0].count is 0"},
      {"CountNegative", [](B b) { b.document["accessors"][0]["count"] = -3; }, inv, "accessors[0].count is -3"},
      {"CountFractional", [](B b) { b.document["accessors"][0]["count"] = 3.5; }, inv, "accessors[0].count is 3.5"},
      {"CountText", [](B b) { b.document["accessors"][0]["count"] = "3"; }, inv, "accessors[0].count is \"3\""},
      {"CountMissing", [](B b) { b.document["accessors"][0].erase("count"); }, inv, "accessors[0].count is missing"},
      {"OffsetPastTheEnd", [](B b) { b.document["accessors"][0]["byteOffset"] = 36; }, inv,
       "accessors[0].byteOffset is 36"},
      {"OffsetWrapsAround", [](B b) { b.document["accessors"][0]["byteOffset"] = 0xffffffffffffffffull; }, inv,
       "accessors[0].byteOffset"},
      {"OffsetNegative", [](B b) { b.document["accessors"][0]["byteOffset"] = -4; }, inv,
       "accessors[0].byteOffset is -4"},
      {"StrideTooSmall", [](B b) { b.document["bufferViews"][0]["byteStride"] = 8; }, inv, "overlap at a stride of 8"},
      {"StridePastTheEnd", [](B b) { b.document["bufferViews"][0]["byteStride"] = 252; }, inv,
       "accessors[0].count is 3: its view has room for 1"},
      {"StrideOdd", [](B b) { b.document["bufferViews"][0]["byteStride"] = 13; }, inv,
       "bufferViews[0].byteStride is 13"},
      {"ComponentTypeUnknown", [](B b) { b.document["accessors"][0]["componentType"] = 5124; }, inv,
       "accessors[0].componentType is 5124"},
      {"TypeUnknown", [](B b) { b.document["accessors"][0]["type"] = "VEC9"; }, inv, "VEC9"},
      {"PositionsOfBytes", [](B b) { b.document["accessors"][0]["componentType"] = kByte; }, inv,
       "accessors[0] does not fit its use: VEC3 of floats"},
      {"IndicesOfFloats",
       [](B b) {
         b.primitive()["indices"] = b.floats({0, 1, 2}, "SCALAR");
       },
       inv, "accessors[1] does not fit its use"},
      {"UvsNotNormalized", [](B b) { b.attributes()["TEXCOORD_0"] = b.accessor(0, 0, kUnsignedShort, 3, "VEC2"); }, inv,
       "accessors[1] does not fit its use"},
      {"FewerNormalsThanVertices",
       [](B b) {
         b.attributes()["NORMAL"] = b.floats({0, 0, 1, 0, 0, 1}, "VEC3");
       },
       inv, "attributes.NORMAL has 2 elements for 3 vertices"},
      {"AccessorWithoutView", [](B b) { b.document["accessors"][0].erase("bufferView"); }, inv,
       "accessors[0].bufferView is missing"},
      {"ViewOutOfRange", [](B b) { b.document["accessors"][0]["bufferView"] = 7; }, inv,
       "accessors[0].bufferView is 7: it must be the index of one of 1 bufferViews"},
      {"ViewNegative", [](B b) { b.document["accessors"][0]["bufferView"] = -1; }, inv,
       "accessors[0].bufferView is -1"},
      {"ViewBeyondBuffer", [](B b) { b.document["bufferViews"][0]["byteLength"] = 37; }, inv,
       "bufferViews[0].byteLength is 37"},
      {"ViewOffsetBeyondBuffer", [](B b) { b.document["bufferViews"][0]["byteOffset"] = 1000; }, inv,
       "bufferViews[0].byteOffset is 1000"},
      {"ViewWrapsAround",
       [](B b) {
         b.document["bufferViews"][0]["byteOffset"] = 36;
         b.document["bufferViews"][0]["byteLength"] = (uint64_t{1} << 53) - 35;
       },
       inv, "bufferViews[0].byteLength"},
      {"ViewOfNoBuffer", [](B b) { b.document["bufferViews"][0]["buffer"] = 1; }, inv, "bufferViews[0].buffer is 1"},
      {"BufferLongerThanFile",
       [](B b) {
         b.document["buffers"] = {{{"uri", "model.bin"}, {"byteLength", 1000}}};
       },
       inv, "model.bin"},
      {"BufferOfNothing",
       [](B b) {
         b.document["buffers"] = {{{"uri", "model.bin"}, {"byteLength", 0}}};
       },
       inv, "buffers[0].byteLength is 0"},
      {"BufferWithoutUri",
       [](B b) {
         b.document["buffers"] = {{{"byteLength", 36}}};
       },
       inv, "buffers[0].uri is missing"},
      {"BufferFileMissing",
       [](B b) {
         b.document["buffers"] = {{{"uri", "gone.bin"}, {"byteLength", 36}}};
       },
       inv, "gone.bin"},
      {"BufferDataUriShort",
       [](B b) {
         b.document["buffers"] = {{{"uri", "data:application/octet-stream;base64,AAAA"}, {"byteLength", 36}}};
       },
       inv, "Failed to decode"},
      // Numbers
      {"PositionNan", [=](B b) { setFloat(b, 4, nan); }, inv, "accessors[0][1] holds nan"},
      {"PositionInfinite", [=](B b) { setFloat(b, 8, inf); }, inv, "accessors[0][2] holds inf"},
      {"MatrixInfinite",
       [](B b) { b.document["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, 1e39, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }, inv,
       "nodes[0].matrix"},
      {"MatrixNotANumber",
       [](B b) { b.document["nodes"][0]["matrix"] = {1, 0, 0, 0, 0, nullptr, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }, inv,
       "nodes[0].matrix"},
      {"MatrixShort",
       [](B b) {
         b.document["nodes"][0]["matrix"] = {1, 0, 0, 0};
       },
       inv, "nodes[0].matrix"},
      {"MatrixPerspective",
       [](B b) { b.document["nodes"][0]["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }, inv,
       "nodes[0].matrix is not affine"},
      {"RotationZero",
       [](B b) {
         b.document["nodes"][0]["rotation"] = {0, 0, 0, 0};
       },
       inv, "nodes[0].rotation is a quaternion of length zero"},
      {"TransformOverflows",
       [](B b) {
         b.document["nodes"] = {{{"scale", {1e30, 1, 1}}, {"children", {1}}}, {{"scale", {1e30, 1, 1}}, {"mesh", 0}}};
       },
       inv, "nodes[1] has a transform that is not finite"},
      {"PlacedBeyondNumbers",
       [](B b) {
         setFloat(b, 3, 1e20f);
         b.document["nodes"][0]["scale"] = {1e30, 1, 1};
       },
       inv, "beyond what numbers can hold"},
      {"EmissionInfinite",
       [](B b) {
         b.document["materials"] = {{{"emissiveFactor", {1e300, 0, 0}}}};
       },
       inv, "materials[0].emissiveFactor"},
      {"EmissionStrengthNegative",
       [](B b) {
         b.document["materials"] = {
             {{"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", -2}}}}}}};
       },
       inv, "materials[0].emissiveStrength is -2"},
      {"JsonNumberOverflows", [](B b) { b.document["nodes"][0]["name"] = "PLACEHOLDER"; }, inv, "JSON cannot be read"},
      // Nodes and references
      {"NodeCycle",
       [](B b) {
         b.document["nodes"] = {{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}};
       },
       inv, "nodes[1] is its own ancestor: the nodes form a cycle"},
      {"NodeCycleAtTheRoot",
       [](B b) {
         b.document["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
       },
       inv, "nodes[0] is its own ancestor"},
      {"NodeItsOwnChild",
       [](B b) {
         b.document["nodes"] = {{{"mesh", 0}, {"children", {0}}}};
       },
       inv, "nodes[0] is its own ancestor"},
      {"NodeWithTwoParents",
       [](B b) {
         b.document["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
       },
       inv, "nodes[2] is a child of nodes[0] and again of nodes[1]"},
      {"NodeChainTooDeep", [](B b) { b.document["nodes"] = chain(1025); }, ErrorKind::limit,
       "nodes[1024] lies more than 1024 levels deep"},
      {"RootIsAChild",
       [](B b) {
         b.document["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"mesh", 0}}};
         b.document["scenes"][0]["nodes"] = {0, 1};
       },
       inv, "nodes[1] is listed in scenes[0].nodes"},
      {"RootTwice",
       [](B b) {
         b.document["scenes"][0]["nodes"] = {0, 0};
       },
       inv, "nodes[0] is listed in scenes[0].nodes, but twice"},
      {"RootOutOfRange", [](B b) { b.document["scenes"][0]["nodes"] = {4}; }, inv, "scenes[0].nodes[0] is 4"},
      {"SceneOutOfRange", [](B b) { b.document["scene"] = 1; }, inv, "scene is 1"},
      {"ChildOutOfRange", [](B b) { b.document["nodes"][0]["children"] = {5}; }, inv, "nodes[0].children[0] is 5"},
      {"ChildNegative", [](B b) { b.document["nodes"][0]["children"] = {-1}; }, inv, "nodes[0].children[0] is -1"},
      {"MeshOutOfRange", [](B b) { b.document["nodes"][0]["mesh"] = 1; }, inv, "nodes[0].mesh is 1"},
      {"MaterialOutOfRange", [](B b) { b.primitive()["material"] = 0; }, inv, "meshes[0].primitives[0].material is 0"},
      {"AttributeOutOfRange", [](B b) { b.attributes()["NORMAL"] = 1; }, inv,
       "meshes[0].primitives[0].attributes.NORMAL is 1"},
      {"IndicesOutOfRange", [](B b) { b.primitive()["indices"] = -1; }, inv, "meshes[0].primitives[0].indices is -1"},
      {"TextureOutOfRange",
       [](B b) {
         b.document["materials"] = {{{"normalTexture", {{"index", 3}}}}};
       },
       inv, "materials[0].normalTexture.index is 3"},
      {"ImageOutOfRange",
       [](B b) {
         b.document["textures"] = {{{"source", 0}}};
       },
       inv, "textures[0].source is 0"},
      {"ModeUnknown", [](B b) { b.primitive()["mode"] = 7; }, inv, "meshes[0].primitives[0].mode is 7"},
      {"ListThatIsNone",
       [](B b) {
         b.document["nodes"] = {{"mesh", 0}};
       },
       inv, "nodes"},
      {"EntryThatIsNoObject", [](B b) { b.document["materials"] = {1}; }, inv,
       "materials[0] is 1: it must be an object"},
      {"CornersMakeNoTriangles",
       [](B b) {
         b.primitive()["indices"] = b.indices<uint8_t>(kUnsignedByte, {0, 1, 2, 0});
       },
       inv, "meshes[0].primitives[0] has 4 corners"},
      {"OnlyPoints", [](B b) { b.primitive()["mode"] = 0; }, inv, "its scene shows no triangles"},
      {"NoPositions", [](B b) { b.attributes() = json::object(); }, inv, "its scene shows no triangles"},
      {"NothingPlaced", [](B b) { b.document["scenes"][0]["nodes"] = json::array(); }, inv,
       "its scene shows no triangles"},
      {"CameraWithoutAngle",
       [](B b) {
         b.document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 4}, {"znear", 1}}}}};
         b.document["nodes"][0]["camera"] = 0;
       },
       inv, "cameras[0].perspective.yfov is 4"},
      // Headers and extensions
      {"RequiredExtension", [](B b) { b.document["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
       ErrorKind::unsupported, "KHR_draco_mesh_compression"},
      {"VersionOne", [](B b) { b.document["asset"]["version"] = "1.0"; }, inv, "asset.version is \"1.0\""},
      {"VersionMissing", [](B b) { b.document.erase("asset"); }, inv, "asset.version is missing"},
      {"ExtrasNestedTooDeep",
       [](B b) {
         json deep = 1;
         for (int i = 0; i < 200; ++i) deep = json::array({std::move(deep)});
         b.document["extras"] = deep;
       },
       ErrorKind::limit, "nested more than 100 levels deep"},
      // Images
      {"ImageHugeGrey", [](B b) { useImage(b, pngHeader(30'000, 30'000, 0)); }, ErrorKind::limit,
       "images[0]: it has 30000 x 30000 texels, at most 16384 a side"},
      {"ImageHugeRgba", [](B b) { useImage(b, pngHeader(30'000, 30'000, 6)); }, ErrorKind::limit,
       "images[0]: it has 30000 x 30000 texels, at most 16384 a side"},
      {"ImageTruncated", [](B b) { useImage(b, pngHeader(16, 16, 6)); }, inv, "images[0]: it is damaged"},
      {"ImageIsNone", [](B b) { useImage(b, "this is text"); }, inv, "images[0]: it is no PNG or JPEG"},
      {"ImageFileMissing",
       [](B b) {
         useImage(b, "x");
         b.document["images"][0] = {{"uri", "gone.png"}};
       },
       inv, "images[0] (gone.png) is missing"},
      {"ImageOfNoView",
       [](B b) {
         useImage(b, "x");
         b.document["images"][0]["bufferView"] = 99;
       },
       inv, "images[0].bufferView is 99"},
      {"ImageOfNothing",
       [](B b) {
         useImage(b, "x");
         b.document["images"][0] = json::object();
       },
       inv, "images[0] is {}: it must have either a uri or a bufferView"},
      // URIs that lead elsewhere
      {"UriUpwards",
       [](B b) {
         b.document["buffers"] = {{{"uri", "../secret.bin"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri is \"../secret.bin\""},
      {"UriUpwardsEscaped",
       [](B b) {
         b.document["buffers"] = {{{"uri", "%2e%2e%2fsecret.bin"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri is \"%2e%2e%2fsecret.bin\""},
      {"UriUpwardsInside",
       [](B b) {
         b.document["buffers"] = {{{"uri", "a/../../secret.bin"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri"},
      {"UriUpwardsBackslash",
       [](B b) {
         b.document["buffers"] = {{{"uri", "..\\secret.bin"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri"},
      {"UriAbsolute",
       [](B b) {
         b.document["buffers"] = {{{"uri", "/etc/passwd"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri is \"/etc/passwd\""},
      {"UriWithScheme",
       [](B b) {
         b.document["buffers"] = {{{"uri", "file:///etc/passwd"}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri is \"file:///etc/passwd\""},
      {"UriOfImageUpwards",
       [](B b) {
         useImage(b, "x");
         b.document["images"][0] = {{"uri", "../secret.png"}};
       },
       inv, "images[0].uri is \"../secret.png\""},
      {"UriIsNoText",
       [](B b) {
         b.document["buffers"] = {{{"uri", 5}, {"byteLength", 36}}};
       },
       inv, "buffers[0].uri is 5"},
  };
}

class GltfMalformed : public ::testing::TestWithParam<Malformed> {};

TEST_P(GltfMalformed, IsRefusedByName) { expectRefused(GetParam()); }

INSTANTIATE_TEST_SUITE_P(Files, GltfMalformed, ::testing::ValuesIn(malformed()),
                         [](const auto& info) { return info.param.name; });

Error errorOf(const std::filesystem::path& file, const GltfOptions& options = {}) {
  const Result<ScenePtr> scene = loadGltf(file, options);
  EXPECT_FALSE(scene.ok());
  return scene ? Error{} : scene.error();
}

TEST(GltfFiles, NoModelAtAll) {
  const TempFolder folder;
  EXPECT_EQ(errorOf(folder.path() / "nowhere.glb").kind, ErrorKind::not_found);
  EXPECT_THAT(errorOf(folder.path() / "nowhere.glb").message, HasSubstr("nowhere.glb: there is no such file"));
  EXPECT_THAT(errorOf(folder.path()).message, HasSubstr("it is not a file"));
  EXPECT_THAT(errorOf(folder.write("empty.gltf", "")).message, HasSubstr("it has 0 bytes"));
  EXPECT_THAT(errorOf(folder.write("text.gltf", "hello there")).message, HasSubstr("JSON cannot be read"));
  EXPECT_THAT(errorOf(folder.write("list.gltf", "[1, 2]")).message, HasSubstr("must be an object"));
}

TEST(GltfFiles, LinksOutOfTheFolderAreNotFollowed) {
  const TempFolder folder;
  GltfBuilder builder;
  folder.write("outside.bin", builder.bin);
  std::filesystem::create_directories(folder.path() / "inside");
  std::filesystem::create_symlink(folder.path() / "outside.bin", folder.path() / "inside" / "link.bin");
  builder.document["buffers"] = {{{"uri", "link.bin"}, {"byteLength", builder.bin.size()}}};
  const auto file = folder.write("inside/model.gltf", builder.document.dump());
  EXPECT_THAT(errorOf(file).message, HasSubstr("link.bin"));

  std::filesystem::remove(folder.path() / "inside" / "link.bin");
  folder.write("inside/link.bin", builder.bin);
  EXPECT_TRUE(loadGltf(file).ok());
}

TEST(GltfFiles, TheWorkingDirectoryIsNoPlaceToLook) {
  const TempFolder folder;
  GltfBuilder builder;
  builder.document["buffers"] = {{{"uri", "here.bin"}, {"byteLength", builder.bin.size()}}};
  folder.write("here.bin", builder.bin);
  const auto file = folder.write("sub/model.gltf", builder.document.dump());
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  EXPECT_THAT(errorOf(file).message, HasSubstr("here.bin"));
  std::filesystem::current_path(before);
}

TEST(GltfFiles, AMillionNodeChainIsRefusedWithoutRecursion) {
  const TempFolder folder;
  GltfBuilder builder;
  builder.document["nodes"] = json::array();
  builder.document["buffers"] = {{{"uri", "model.bin"}, {"byteLength", builder.bin.size()}}};
  folder.write("model.bin", builder.bin);
  std::string nodes = "[";
  for (int i = 1; i < 1'000'000; ++i) nodes += R"({"children":[)" + std::to_string(i) + "]},";
  nodes += R"({"mesh":0}])";
  std::string text = builder.document.dump();
  text.replace(text.find("\"nodes\":[]") + 8, 2, nodes);
  const Error error = errorOf(folder.write("model.gltf", text));
  EXPECT_EQ(error.kind, ErrorKind::limit);
  EXPECT_THAT(error.message, HasSubstr("more than 1024 levels deep"));
}

TEST(GltfFiles, DeepNestingIsRefusedWithoutRecursion) {
  const TempFolder folder;
  const std::string text =
      R"({"asset":{"version":"2.0"},"extras":)" + std::string(1'000'000, '[') + std::string(1'000'000, ']') + "}";
  EXPECT_EQ(errorOf(folder.write("model.gltf", text)).kind, ErrorKind::limit);
}

TEST(GltfFiles, LimitsOfTheOptions) {
  const TempFolder folder;
  GltfBuilder builder;
  builder.attributes()["POSITION"] = builder.floats(std::vector<float>(3 * 3 * 4, 0.0f), "VEC3");  // 4 triangles
  const auto file = builder.save(folder);
  GltfOptions options;
  options.max_triangles = 4;
  EXPECT_TRUE(loadGltf(file, options).ok());
  options.max_triangles = 3;
  const Error error = errorOf(file, options);
  EXPECT_EQ(error.kind, ErrorKind::limit);
  EXPECT_EQ(error.value, "4");
  EXPECT_EQ(error.limit, "3");

  useImage(builder, pngHeader(64, 64, 6));
  options = {};
  options.max_texture_bytes = 64 * 64 * 4 - 1;
  EXPECT_EQ(errorOf(builder.save(folder), options).kind, ErrorKind::limit);
  options.max_texture_size = 63;
  EXPECT_THAT(errorOf(builder.save(folder), options).message, HasSubstr("64 x 64 texels, at most 63 a side"));
}

TEST(GltfFiles, OnePositionArrayManyTimesStaysWithinTheTriangleLimit) {
  const TempFolder folder;
  GltfBuilder builder;
  builder.primitive()["indices"] = builder.indices<uint8_t>(kUnsignedByte, std::vector<uint8_t>(3000, 1));
  const json primitive = builder.primitive();
  for (int i = 0; i < 999; ++i)
    builder.document["meshes"][0]["primitives"].push_back(primitive);  // a million triangles of 3 kB
  GltfOptions options;
  options.max_triangles = 999'999;
  EXPECT_EQ(errorOf(builder.save(folder), options).kind, ErrorKind::limit);
}

TEST(GltfFiles, EveryTruncationOfAGlbIsRefused) {
  const TempFolder folder;
  const std::string whole = GltfBuilder{}.glb();
  for (size_t length = 0; length < whole.size(); ++length) {
    ASSERT_FALSE(loadGltf(folder.write("model.glb", whole.substr(0, length))).ok()) << length;
  }
  EXPECT_THAT(errorOf(folder.write("model.glb", whole.substr(0, whole.size() - 4))).message,
              HasSubstr("GLB: truncated"));
  EXPECT_TRUE(loadGltf(folder.write("model.glb", whole)).ok());
}

TEST(GltfFiles, ChunksThatEndPastAGlbAreRefused) {
  const TempFolder folder;
  const GltfBuilder builder;
  const std::string whole = builder.glb();
  const auto with = [&](size_t offset, uint32_t value) {
    std::string bytes = whole;
    std::memcpy(bytes.data() + offset, &value, 4);
    return folder.write("model.glb", bytes);
  };
  const size_t bin_header = whole.size() - builder.bin.size() - 8;
  for (uint32_t too_many : {4u, 8u, 12u, 0xffffffd8u}) {
    EXPECT_THAT(errorOf(with(bin_header, static_cast<uint32_t>(builder.bin.size()) + too_many)).message,
                HasSubstr("GLB"))
        << too_many;
  }
  EXPECT_THAT(errorOf(with(12, 0xfffffff0u)).message, HasSubstr("its JSON chunk needs"));
  EXPECT_THAT(errorOf(with(8, 0xffffffffu)).message, HasSubstr("its length needs"));
  EXPECT_THAT(errorOf(with(4, 1)).message, HasSubstr("GLB.version is 1"));
}

TEST(GltfFiles, RandomDamageNeverCrashes) {
  const TempFolder folder;
  GltfBuilder builder;
  builder.attributes()["NORMAL"] = builder.floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  builder.primitive()["indices"] = builder.indices<uint16_t>(kUnsignedShort, {0, 1, 2});
  useImage(builder, pngHeader(4, 4, 2));
  const std::string whole = builder.glb();
  std::mt19937 random(99);
  const auto below = [&](size_t n) { return std::uniform_int_distribution<size_t>(0, n - 1)(random); };
  int refused = 0;
  for (int round = 0; round < 3000; ++round) {
    std::string bytes = whole;
    for (size_t mutations = 1 + below(3); mutations > 0; --mutations) {
      const size_t at = below(bytes.size());
      if (const size_t choice = below(3); choice == 0) {
        bytes[at] = static_cast<char>(below(256));
      } else if (choice == 1) {
        bytes[at] = "0123456789-[]{},\":"[below(18)];
      } else if (bytes[at] >= '0' && bytes[at] <= '9') {
        bytes[at] = static_cast<char>('0' + below(10));
      }
    }
    const Result<ScenePtr> scene = loadGltf(folder.write("model.glb", bytes));
    if (!scene) {
      ++refused;
      EXPECT_FALSE(scene.error().message.empty());
    }
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace helio::scene
