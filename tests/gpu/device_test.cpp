// Choice of device, memory accounts, transfer, timers: on the real driver with the validation layer on.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "gpu/acceleration_structure.h"
#include "gpu/commands.h"
#include "gpu/device.h"
#include "gpu/features.h"
#include "gpu/pipelines.h"
#include "gpu/range_pool.h"

namespace helio::gpu {
namespace {

std::unique_ptr<Device> testDevice() {
  DeviceOptions options;
  options.select = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
  options.validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;
  auto device = Device::create(options);
  if (!device) throw std::runtime_error(device.error().message);
  return std::move(*device);
}

class Gpu : public testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(device->validationErrors(), 0u); }
  std::unique_ptr<Device> device = testDevice();
};

TEST(DeviceChoice, AMissingDeviceIsAnErrorThatListsTheOnesThere) {
  const auto device = Device::create({"no such device 9000", false});
  ASSERT_FALSE(device.ok());
  EXPECT_EQ(device.error().kind, ErrorKind::not_found);
  EXPECT_EQ(device.error().value, "no such device 9000");
  EXPECT_NE(device.error().message.find("there are: '"), std::string::npos) << device.error().message;
}

TEST(DeviceChoice, WhatADeviceLacksIsSaidByName) {
  Features features;
  for (const char* name : {"rayTracingPipeline", "synchronization2", "shaderBufferInt64Atomics", "shaderInt64"})
    EXPECT_NE(features.off().find(name), std::string::npos) << features.off();
  features.requireAll();
  EXPECT_EQ(features.off(), "");
}

TEST(DeviceChoice, TheEnvironmentChoosesWhereNoFlagDoes) {
  const char* before = std::getenv("HELIOGRAPH_DEVICE");
  const std::string kept = before ? before : "";
  setenv("HELIOGRAPH_DEVICE", "another missing one", 1);
  EXPECT_FALSE(Device::create({}).ok());
  if (before) setenv("HELIOGRAPH_DEVICE", kept.c_str(), 1);
  else unsetenv("HELIOGRAPH_DEVICE");
}

TEST_F(Gpu, SaysWhatItIs) {
  EXPECT_FALSE(device->name().empty());
  EXPECT_FALSE(device->driver().empty());
}

TEST_F(Gpu, CountsMemoryByCategory) {
  const uint64_t before = device->memoryInUse(MemoryCategory::path_tracing);
  {
    const Buffer buffer(*device, {"a test", 1 << 20, MemoryCategory::path_tracing});
    EXPECT_EQ(device->memoryInUse(MemoryCategory::path_tracing), before + (1 << 20));
  }
  EXPECT_EQ(device->memoryInUse(MemoryCategory::path_tracing), before);
}

TEST_F(Gpu, APoolThatEmptiesGivesItsMemoryBack) {
  constexpr uint64_t kSize = 1000, kAlignment = 256;
  RangePool pool(*device, {"a test", 1 << 20, MemoryCategory::path_tracing});
  std::vector<Range> ranges(4000);
  for (Range& range : ranges) range = pool.allocate(kSize, kAlignment);
  EXPECT_EQ(pool.bytesUsed(), kSize * ranges.size());
  EXPECT_LT(pool.bytesHeld(), pool.bytesUsed() * 5 / 4) << "the last chunk is a part of what is held";
  // Few are left in every chunk: none of them comes back until they move together.
  for (size_t i = 0; i < ranges.size(); ++i)
    if (i % 40 != 39) pool.free(ranges[i]);
  const uint64_t scattered = pool.bytesHeld();
  EXPECT_GT(scattered, 8 * pool.bytesUsed());
  for (Range& range : ranges) {
    if (!range) continue;
    const Range before = range;
    if (pool.moveForward(range, kAlignment)) { EXPECT_LT(range.chunk, before.chunk); }
    EXPECT_EQ(range.size, kSize);
    EXPECT_EQ(range.address % kAlignment, 0u);
  }
  EXPECT_EQ(pool.bytesUsed(), kSize * ranges.size() / 40);
  EXPECT_LT(pool.bytesHeld(), scattered / 6);
  for (Range& range : ranges) pool.free(range);
  EXPECT_EQ(pool.bytesHeld(), 0u);
}

TEST_F(Gpu, OutOfMemoryNamesWhatWasAskedFor) {
  try {
    const Buffer buffer(*device, {"the impossible table", uint64_t{1} << 50, MemoryCategory::raster});
    FAIL() << "a pebibyte was given";
  } catch (const Failure& failure) {
    EXPECT_NE(failure.error().message.find("the impossible table"), std::string::npos) << failure.error().message;
    EXPECT_NE(failure.error().message.find("1024.0 TiB"), std::string::npos) << failure.error().message;
  }
}

TEST_F(Gpu, UploadedBytesComeBack) {
  Commands commands(*device);
  for (const size_t count : {size_t{1000}, size_t{3} << 20}) {  // within a chunk of the ring, and beyond
    std::vector<uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 7u);
    const Buffer buffer(*device, {"numbers", count * 4});
    const Buffer back(*device, {"numbers to read back", count * 4, MemoryCategory::transfer, Placement::readback});
    commands.begin();
    commands.upload<uint32_t>(buffer, 0, numbers);
    commands.barrier(use::transfer_write, use::transfer_read);
    commands.copy(buffer, back, count * 4);
    commands.barrier(use::transfer_write, use::host_read);
    commands.submit();
    (void)commands.finish();
    back.invalidate();
    EXPECT_EQ(std::memcmp(back.mapped(), numbers.data(), count * 4), 0) << count;
  }
}

TEST_F(Gpu, TimersNameTheirPassesInOrder) {
  Commands commands(*device);
  const Buffer buffer(*device, {"zeros", 64 << 20});
  for (int frame = 0; frame < 2; ++frame) {
    commands.begin();
    commands.reserveTimers(2);
    for (const char* name : {"first", "second"}) {
      commands.beginTimer(name);
      commands.fill(buffer, 0);
      commands.endTimer();
      commands.barrier(use::transfer_write, use::transfer_write);
    }
    commands.submit();
    const std::vector<TimedPass> passes = commands.finish();
    ASSERT_EQ(passes.size(), 2u);
    EXPECT_EQ(passes[0].name, "first");
    EXPECT_EQ(passes[1].name, "second");
    for (const TimedPass& pass : passes) EXPECT_GT(pass.ms, 0.0);
  }
}

TEST_F(Gpu, AnUnknownShaderIsNamed) {
  try {
    const ComputePipeline pipeline(*device, "no/such.comp");
    FAIL();
  } catch (const Failure& failure) { EXPECT_NE(failure.error().message.find("no/such.comp"), std::string::npos); }
}

TEST_F(Gpu, BindlessSlotsAreUsedAgain) {
  const ImageDescription description{"a target", 16, 16, 1, VK_FORMAT_R32_UINT, VK_IMAGE_USAGE_STORAGE_BIT};
  uint32_t first = 0;
  {
    const Image image(*device, description);
    first = image.slot();
  }
  const Image again(*device, description);
  EXPECT_EQ(again.slot(), first);
}

TEST_F(Gpu, BuildsAnEmptyAndAFullTopLevel) {
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::vector<uint32_t> indices{0, 1, 2};
  constexpr VkBufferUsageFlags kInput = VK_BUFFER_USAGE_ACCELERATION_STRUCTURE_BUILD_INPUT_READ_ONLY_BIT_KHR;
  const Buffer position_buffer(*device, {"positions", 36, MemoryCategory::raster, Placement::device, kInput});
  const Buffer index_buffer(*device, {"indices", 12, MemoryCategory::raster, Placement::device, kInput});
  const Buffer instance_buffer(*device, {"instances", 128, MemoryCategory::ray_tracing, Placement::device, kInput});
  Commands commands(*device);
  commands.begin();
  commands.upload<float>(position_buffer, 0, positions);
  commands.upload<uint32_t>(index_buffer, 0, indices);
  commands.barrier(use::transfer_write, use::build_read);
  const std::vector<BlasInput> inputs{{"a triangle", {{position_buffer.address(), 3, index_buffer.address(), 1}}}};
  const std::vector<AccelerationStructure> blases = buildBlases(commands, inputs);
  ASSERT_EQ(blases.size(), 1u);
  EXPECT_NE(blases[0].address(), 0u);
  std::vector<VkAccelerationStructureInstanceKHR> instances(2);  // the second stays a null reference
  instances[0].transform.matrix[0][0] = instances[0].transform.matrix[1][1] = instances[0].transform.matrix[2][2] =
      1.0f;
  instances[0].mask = 0xff;
  instances[0].accelerationStructureReference = blases[0].address();
  commands.upload<VkAccelerationStructureInstanceKHR>(instance_buffer, 0, instances);
  commands.barrier(use::build_write, use::build_read);
  commands.barrier(use::transfer_write, use::build_read);
  Tlas tlas;
  const TlasInput input{&tlas, instance_buffer.address(), 2};
  buildTlases(commands, {&input, 1});
  EXPECT_NE(tlas.address(), 0u);
  commands.submit();
  (void)commands.finish();
}

}  // namespace
}  // namespace helio::gpu
