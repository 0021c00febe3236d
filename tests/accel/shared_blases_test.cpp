// The cache of BLASes that instances share: what is needed comes within budgets, what is not goes, and nothing is left.
#include "accel/shared_blases.h"
#include "accel/lipac_fixture.h"

namespace helio::accel {
namespace {

using namespace shared;

/// Three meshes, the first of which has a coarser level: records 0, 1, 2 and 3.
class SharedBlasCache : public LipacFixture {
 protected:
  static constexpr uint32_t kTriangles = 600;

  gpu::Buffer input(const char* name, std::span<const std::byte> bytes) {
    gpu::Buffer buffer(*device, {name, bytes.size(), gpu::MemoryCategory::raster, gpu::Placement::device,
                                 VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR});
    commands.begin();
    commands.upload(buffer, 0, bytes);
    submit();
    return buffer;
  }
  void SetUp() override {
    std::vector<glm::vec3> corners;
    std::vector<uint32_t> corner_numbers;
    for (uint32_t i = 0; i < 3 * kTriangles; ++i) {
      corners.emplace_back(i % 7, i % 11, i % 13);
      corner_numbers.push_back(i);
    }
    positions = input("positions", std::as_bytes(std::span(corners)));
    indices = input("indices", std::as_bytes(std::span(corner_numbers)));
  }
  SharedBlases make() {
    std::vector<MeshRecord> records(4);
    std::vector<SharedShape> shapes(4);
    for (uint32_t r = 0; r < 4; ++r) {
      const uint32_t triangles = r == 3 ? kTriangles / 2 : kTriangles;
      records[r].first_geometry = r;
      shapes[r] = {
          "shape", r % 3, {{positions.address(), 3 * kTriangles, indices.address(), triangles, true}}, triangles};
    }
    records[0].coarser = 3;
    return {*device, std::move(records), std::move(shapes)};
  }
  /// One tick in which nothing is needed but `needed`; the first in the order of records are the most urgent.
  SharedBlasFigures tick(SharedBlases& blases, std::initializer_list<uint32_t> needed, const BuildBudget& budget = {}) {
    for (const uint32_t record : needed) blases.want(record);
    batch.begin(budget);
    blases.plan(++ticks, batch);
    commands.begin();
    blases.upload(commands);
    batch.record(commands);
    blases.record(commands);
    barrier();
    blases.readBack(commands);
    submit();
    return blases.figures();
  }
  std::vector<MeshRecord> table(const SharedBlases& blases) { return read<MeshRecord>(blases.tableBuffer(), 4); }

  gpu::Buffer positions, indices;
  BlasBatch batch{*device};
  uint64_t ticks = 0;
};

TEST_F(SharedBlasCache, ComeWithinTheBudgetAndAnotherLevelStandsIn) {
  SharedBlases blases = make();
  const BuildBudget one{1, 1'000'000};
  SharedBlasFigures figures = tick(blases, {3, 0, 1}, one);
  EXPECT_EQ(figures.built, 1u);
  EXPECT_EQ(figures.waiting, 2u);
  EXPECT_EQ(figures.triangles, kTriangles);
  std::vector<MeshRecord> records = table(blases);
  EXPECT_NE(records[0].blas, 0u);
  EXPECT_EQ(records[3].blas, records[0].blas);  // the finer level stands in for the coarser
  EXPECT_EQ(records[3].first_geometry, 0u);
  EXPECT_EQ(records[0].coarser, 3u);
  EXPECT_EQ(records[1].blas, 0u);
  EXPECT_EQ(tick(blases, {3, 0, 1}, one).waiting, 1u);
  figures = tick(blases, {3, 0, 1}, one);
  EXPECT_EQ(figures.waiting, 0u);
  EXPECT_EQ(figures.resident, 3u);
  records = table(blases);
  EXPECT_EQ(records[3].first_geometry, 3u);
  EXPECT_NE(records[3].blas, records[0].blas);
  EXPECT_FALSE(blases.resident(2));  // nobody asked
}

TEST_F(SharedBlasCache, WhatIsLargerThanTheBudgetGetsItsTurn) {
  SharedBlases blases = make();
  EXPECT_EQ(tick(blases, {0, 1}, {1024, 100}).built, 1u);
  EXPECT_EQ(tick(blases, {0, 1}, {1024, 100}).built, 1u);
  EXPECT_EQ(tick(blases, {0, 1}, {1024, 100}).waiting, 0u);
}

TEST_F(SharedBlasCache, AgeAndComeAgain) {
  SharedBlases blases = make();
  blases.set({1u << 30, 3});
  const uint64_t before = device->memoryInUse(gpu::MemoryCategory::ray_tracing);
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(tick(blases, {1}).built, 1u) << round;
    for (int i = 0; i < 3; ++i) EXPECT_EQ(tick(blases, {}).resident, 1u);
    const SharedBlasFigures figures = tick(blases, {});
    EXPECT_EQ(figures.evicted, 1u);
    EXPECT_EQ(figures.resident, 0u);
    EXPECT_EQ(blases.bytes(), 0u);
    EXPECT_EQ(table(blases)[1].blas, 0u);
  }
  EXPECT_EQ(device->memoryInUse(gpu::MemoryCategory::ray_tracing) - batch.scratchBytes(), before);
}

TEST_F(SharedBlasCache, TheOldestMakesRoomAndWhatIsNeededStays) {
  SharedBlases blases = make();
  (void)tick(blases, {0});
  (void)tick(blases, {0});  // compacted by now, if that saves anything
  const uint64_t one =
      gpu::blasSizes(
          *device,
          std::vector<gpu::BlasGeometry>{{positions.address(), 3 * kTriangles, indices.address(), kTriangles, true}},
          gpu::BlasKind::still)
          .structure;
  blases.set({2 * one + one / 2, 1000});
  (void)tick(blases, {0, 1});
  (void)tick(blases, {1});
  SharedBlasFigures figures = tick(blases, {1, 2});
  EXPECT_EQ(figures.evicted, 1u);
  EXPECT_FALSE(blases.resident(0));
  EXPECT_TRUE(blases.resident(1) && blases.resident(2));
  for (int i = 0; i < 3; ++i) figures = tick(blases, {0, 1, 2});
  EXPECT_LE(blases.bytes(), 2 * one + one / 2);
  if (blases.bytes() + one > 2 * one + one / 2) {  // compaction did not make room for all
    EXPECT_EQ(figures.waiting, 1u);
    EXPECT_EQ(figures.evicted, 0u);
  }
}

TEST_F(SharedBlasCache, AllAtOnceIsTheSameAsOneByOne) {
  SharedBlases at_once = make(), in_turn = make();
  at_once.planAll(1, commands);
  EXPECT_EQ(at_once.figures().resident, 4u);
  EXPECT_EQ(at_once.needs(), 0u);  // nobody asks
  for (int i = 0; i < 6; ++i) (void)tick(in_turn, {0, 1, 2, 3}, {1, 1'000'000});
  EXPECT_EQ(in_turn.bytes(), at_once.bytes());
  EXPECT_EQ(in_turn.compactionSaved(), at_once.compactionSaved());
  EXPECT_NE(in_turn.needs(), 0u);
}

TEST_F(SharedBlasCache, WhatAFailedTickBuiltWasNeverBuilt) {
  SharedBlases blases = make();
  (void)tick(blases, {0});
  (void)tick(blases, {0});
  blases.want(1);
  batch.begin({});
  blases.plan(++ticks, batch);
  EXPECT_TRUE(blases.resident(1));
  blases.forget();  // before it was recorded
  EXPECT_FALSE(blases.resident(1));
  EXPECT_TRUE(blases.resident(0));
  EXPECT_EQ(tick(blases, {0, 1}).built, 1u);
}

}  // namespace
}  // namespace helio::accel
