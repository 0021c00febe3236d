// Passes on two queues: each waits for the other where it must, and pictures are the same.
#include "render/graph.h"

#include <gtest/gtest.h>

#include <cstring>

#include "gpu/device.h"
#include "scene/city.h"
#include "support/scenes.h"
#include "support/stage.h"

namespace helio::test {
namespace {

using gpu::Buffer;
using gpu::Commands;
using gpu::Queue;
using render::Graph;

std::unique_ptr<gpu::Device> openDevice() {
  auto device = gpu::Device::create(
      {std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu", std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr});
  if (!device) throw std::runtime_error(device.error().message);
  return std::move(*device);
}

// Each pass copies what another one, often of the other queue, wrote just before; then that one is overwritten.
TEST(Graph, QueuesWaitForEachOtherWherePassesTouchTheSame) {
  const auto device = openDevice();
  Commands main(*device), async(*device, Queue::async);
  constexpr uint64_t kBytes = 8 << 20;
  const Buffer a(*device, {"a", kBytes}), b(*device, {"b", kBytes}), aside(*device, {"aside", kBytes});
  const Buffer back(*device, {"what came back", kBytes, gpu::MemoryCategory::transfer, gpu::Placement::readback});
  for (uint32_t tick = 1; tick <= 3; ++tick) {
    Graph graph;
    const auto fill = [&](const char* name, const Buffer& buffer, uint32_t value, Queue queue) {
      graph.add(
          name, Graph::kShared, {{&buffer, gpu::use::transfer_write}},
          [&buffer, value](Commands& commands) { commands.fill(buffer, value); }, queue);
    };
    const auto copy = [&](const char* name, const Buffer& from, const Buffer& to, Queue queue) {
      graph.add(
          name, Graph::kShared, {{&from, gpu::use::transfer_read}, {&to, gpu::use::transfer_write}},
          [&from, &to](Commands& commands) { commands.copy(from, to, kBytes); }, queue);
    };
    fill("fill", a, tick, Queue::main);
    copy("read after write", a, b, Queue::async);
    fill("beside it", aside, 0, Queue::main);
    fill("write after read", a, 99, Queue::main);
    fill("write after write", a, tick + 100, Queue::async);
    copy("read what was read", b, back, Queue::main);
    if (tick == 3) copy("read what was written", a, back, Queue::main);
    fill("at the end", aside, 1, Queue::async);

    main.begin();
    async.begin();
    graph.record(main, &async);
    main.submit();
    const std::vector<gpu::TimedPass> times = graph.finish(main, &async);
    ASSERT_EQ(times.size(), graph.passes().size());
    for (size_t i = 0; i < times.size(); ++i) EXPECT_EQ(times[i].name, graph.passes()[i].name);
    EXPECT_GT(main.spanMs(), 0.0);

    back.invalidate();
    const auto* words = reinterpret_cast<const uint32_t*>(back.mapped());
    const uint32_t expected = tick == 3 ? tick + 100 : tick;
    for (uint64_t i = 0; i < kBytes / 4; ++i) ASSERT_EQ(words[i], expected) << tick;
  }
  EXPECT_EQ(device->validationErrors(), 0u);
}

TEST(Graph, StructuresThatAreBuiltAsideMakeTheSamePictures) {
  const scene::ScenePtr city = *scene::generateCity({1, 1'000, 60});
  render::ViewSettings settings;
  settings.width = 96;
  settings.height = 54;
  settings.bounces = 1;
  settings.primary = render::Primary::raster;
  settings.sun_shadow = render::SunShadow::rays_and_map;
  std::vector<std::vector<uint8_t>> pictures[2];
  for (const bool aside : {false, true}) {
    render::RendererOptions options;
    options.device = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
    options.strict_validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;
    options.builds_aside = aside;
    auto renderer = render::makeRenderer(options);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message;
    for (const render::Culling culling : {render::Culling::full, render::Culling::lipac}) {
      auto viewed = ViewedWorld::open(**renderer, city);
      ASSERT_TRUE(viewed.ok()) << viewed.error().message;
      ASSERT_TRUE((*renderer)->setCulling((*viewed)->handle(), culling).ok());
      for (int tick = 0; tick < 4; ++tick) {
        const auto frame = (*viewed)->tick(city->cameras.front().camera, settings);
        ASSERT_TRUE(frame.ok()) << frame.error().message;
        EXPECT_TRUE(recorded(*frame, "blas") || culling != render::Culling::full);
        pictures[aside].push_back(bytes(*frame));
      }
    }
  }
  EXPECT_EQ(pictures[0], pictures[1]);
}

}  // namespace
}  // namespace helio::test
