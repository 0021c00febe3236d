#include "render/renderer.h"

#include <atomic>
#include <map>
#include <shared_mutex>

#include "render/faults.h"
#include "render/passes.h"
#include "render/world_renderer.h"

namespace helio::render {
namespace {

/// Runs `work`; what gpu/ throws becomes an Error. A lost device is one of kind `internal`, which ends the process
/// (crash-only) where it arrives.
template <typename Work>
auto guarded(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const gpu::DeviceLost&) { throw; } catch (const gpu::Failure& failure) {
    return failure.error();
  }
}

class VulkanRenderer final : public Renderer {
 public:
  VulkanRenderer(std::shared_ptr<gpu::Device> device, const RendererOptions& options)
      : device_(std::move(device)), passes_(*device_), options_(options) {}

  DeviceInfo device() const override { return {device_->name(), device_->driver(), device_->cpu()}; }

  Result<WorldHandle> addWorld(scene::ScenePtr scene) override {
    return guarded([&]() -> Result<WorldHandle> {
      auto world = std::make_shared<WorldRenderer>(device_, passes_, std::move(scene));
      world->setOneCallABlas(options_.one_call_a_blas);
      world->setBuildsAside(options_.builds_aside);
      if (options_.culling != Culling::full) world->setCulling(options_.culling, options_.culling_settings);
      const WorldHandle handle = ++next_handle_;
      const std::unique_lock lock(mutex_);
      worlds_.emplace(handle, std::move(world));
      return handle;
    });
  }

  void removeWorld(WorldHandle world) override {
    const std::unique_lock lock(mutex_);
    worlds_.erase(world);
    std::erase_if(views_, [&](const auto& view) { return view.second == world; });
  }

  Result<ViewHandle> addView(WorldHandle world) override {
    const std::shared_ptr<WorldRenderer> renderer = find(world);
    if (!renderer) return unknown(world);
    const ViewHandle handle = ++next_handle_;
    renderer->addView(handle);
    const std::unique_lock lock(mutex_);
    views_.emplace(handle, world);
    return handle;
  }

  void removeView(ViewHandle view) override {
    std::shared_ptr<WorldRenderer> renderer;
    {
      const std::unique_lock lock(mutex_);
      const auto found = views_.find(view);
      if (found == views_.end()) return;
      renderer = worlds_.at(found->second);
      views_.erase(found);
    }
    renderer->removeView(view);
  }

  Result<void> setCulling(WorldHandle world, Culling culling, const CullingSettings& settings) override {
    if (auto valid = check(settings); !valid) return valid.error();
    const std::shared_ptr<WorldRenderer> renderer = find(world);
    if (!renderer) return unknown(world);
    return guarded([&]() -> Result<void> {
      renderer->setCulling(culling, settings);
      return {};
    });
  }

  Result<void> freezeCulling(WorldHandle world, bool frozen) override {
    const std::shared_ptr<WorldRenderer> renderer = find(world);
    if (!renderer) return unknown(world);
    renderer->freezeCulling(frozen);
    return {};
  }

  Result<std::vector<CulledInstance>> culledInstances(WorldHandle world) override {
    const std::shared_ptr<WorldRenderer> renderer = find(world);
    if (!renderer) return unknown(world);
    return guarded([&] { return renderer->culledInstances(); });
  }

  Result<std::vector<Frame>> tick(WorldHandle world, const world::ChangeSet& changes,
                                  std::span<const ViewRequest> views) override {
    const std::shared_ptr<WorldRenderer> renderer = find(world);
    if (!renderer) return unknown(world);
    const uint64_t errors_before = device_->validationErrors();
    Result<std::vector<Frame>> frames = guarded([&] { return renderer->tick(changes, views); });
    if (options_.strict_validation && device_->validationErrors() != errors_before)
      return Error{ErrorKind::internal, "the validation layer reported an error in this tick: see the log", {}, {}, {}};
    if (options_.strict_numerics && frames)
      for (size_t i = 0; i < views.size(); ++i)
        if (const FrameStats& stats = (*frames)[i].stats; stats.first_fault)
          return Error{ErrorKind::internal, describeFault(stats, views[i].settings), {}, {}, {}};
    return frames;
  }

 private:
  std::shared_ptr<WorldRenderer> find(WorldHandle world) {
    const std::shared_lock lock(mutex_);
    const auto found = worlds_.find(world);
    return found == worlds_.end() ? nullptr : found->second;
  }
  static Error unknown(WorldHandle world) {
    return {ErrorKind::not_found, "no world " + std::to_string(world), "world", std::to_string(world), {}};
  }

  std::shared_ptr<gpu::Device> device_;
  Passes passes_;
  RendererOptions options_;
  std::shared_mutex mutex_;
  std::atomic<uint64_t> next_handle_{0};
  std::map<WorldHandle, std::shared_ptr<WorldRenderer>> worlds_;
  std::map<ViewHandle, WorldHandle> views_;
};

}  // namespace

Result<void> Renderer::setCulling(WorldHandle, Culling, const CullingSettings&) {
  return Error{ErrorKind::unsupported, "this renderer knows no culling", "culling", {}, {}};
}

Result<void> Renderer::freezeCulling(WorldHandle, bool) {
  return Error{ErrorKind::unsupported, "this renderer knows no culling", "culling", {}, {}};
}

Result<std::vector<CulledInstance>> Renderer::culledInstances(WorldHandle) {
  return Error{ErrorKind::unsupported, "this renderer knows no culling", "culling", {}, {}};
}

Result<std::unique_ptr<Renderer>> makeRenderer(const RendererOptions& options) {
  if (auto valid = check(options.culling_settings); !valid) return valid.error();
  gpu::DeviceOptions device_options;
  device_options.select = options.device;
  device_options.validation = options.validation || options.strict_validation;
  auto device = gpu::Device::create(device_options);
  if (!device) return device.error();
  return guarded([&]() -> Result<std::unique_ptr<Renderer>> {
    return std::unique_ptr<Renderer>(std::make_unique<VulkanRenderer>(std::move(*device), options));
  });
}

}  // namespace helio::render
