// Light path guided culling without a scene: tests write its tables and read them back.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "accel/lipac.h"
#include "shared/scene.h"
#include "support/scenes.h"

namespace helio::accel {

class LipacFixture : public testing::Test {
 protected:
  static std::unique_ptr<gpu::Device> testDevice() {
    gpu::DeviceOptions options;
    options.select = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
    options.validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;
    auto device = gpu::Device::create(options);
    if (!device) throw std::runtime_error(device.error().message);
    return std::move(*device);
  }
  void TearDown() override { EXPECT_EQ(device->validationErrors(), 0u); }

  /// One mesh: a cube of edge 1.
  static scene::ScenePtr cubes() {
    test::SceneBuilder builder;
    builder.place(builder.prefab("cube", test::cube(), builder.material(test::lambert(glm::vec3(0.5f)))));
    return builder.build();
  }

  template <typename T>
  gpu::Buffer table(const char* name, const std::vector<T>& items) {
    gpu::Buffer buffer(*device, {name, items.size() * sizeof(T), gpu::MemoryCategory::ray_tracing});
    commands.begin();
    commands.upload<T>(buffer, 0, items);
    submit();
    return buffer;
  }
  template <typename T>
  std::vector<T> read(const gpu::Buffer& buffer, size_t count) {
    gpu::Buffer back(*device,
                     {"read back", count * sizeof(T), gpu::MemoryCategory::transfer, gpu::Placement::readback});
    commands.begin();
    commands.barrier(gpu::use::everything, gpu::use::everything);
    commands.copy(buffer, back, count * sizeof(T));
    commands.barrier(gpu::use::transfer_write, gpu::use::host_read);
    submit();
    back.invalidate();
    std::vector<T> items(count);
    std::memcpy(items.data(), back.mapped(), count * sizeof(T));
    return items;
  }
  void barrier() { commands.barrier(gpu::use::everything, gpu::use::everything); }
  void submit() {
    commands.submit();
    (void)commands.finish();
  }

  std::unique_ptr<gpu::Device> device = testDevice();
  gpu::Commands commands{*device};
};

}  // namespace helio::accel
