#include "probe.h"

#include <cstdlib>
#include <random>

#include "shaders/embedded.h"

namespace helio::test {
namespace {

std::unique_ptr<gpu::Device> testDevice() {
  gpu::DeviceOptions options;
  options.select = std::getenv("HELIOGRAPH_DEVICE") ? "" : "cpu";
  options.validation = std::getenv("HELIOGRAPH_TEST_WITHOUT_VALIDATION") == nullptr;  // the bundle has no layers
  auto device = gpu::Device::create(options);
  if (!device) throw std::runtime_error(device.error().message);
  return std::move(*device);
}

gpu::Buffer mapped(gpu::Device& device, const std::string& name, uint64_t bytes, gpu::Placement placement) {
  return {device, {name, bytes, gpu::MemoryCategory::transfer, placement}};
}

}  // namespace

Probe::Probe() : device_(testDevice()), commands_(*device_) {
  constexpr size_t kNumbers = kSamples * sizeof(shared::RandomNumbers) / sizeof(float);
  randoms_ = mapped(*device_, "random numbers", kNumbers * sizeof(float), gpu::Placement::upload);
  std::mt19937 generator(20240611);
  auto* number = reinterpret_cast<float*>(randoms_.mapped());
  for (size_t i = 0; i < kNumbers; ++i) number[i] = static_cast<float>(generator() >> 8) * 0x1p-24f;
}

void Probe::dispatch(const std::string& shader, shared::ProbeConstants constants, std::span<const std::byte> questions,
                     uint32_t count, std::span<std::byte> answers) {
  auto found = pipelines_.find(shader);
  if (found == pipelines_.end())
    found = pipelines_.emplace(shader, gpu::ComputePipeline(*device_, shader, shaders::find(shader))).first;

  const gpu::Buffer in = mapped(*device_, "the questions of " + shader, questions.size(), gpu::Placement::upload);
  const gpu::Buffer out = mapped(*device_, "the answers of " + shader, answers.size(), gpu::Placement::readback);
  std::memcpy(in.mapped(), questions.data(), questions.size());
  constants.questions = in.address();
  constants.answers = out.address();
  constants.randoms = randoms_.address();
  constants.count = count;
  commands_.begin();
  commands_.bind(found->second);
  commands_.push(constants);
  commands_.dispatch((count + shared::kProbeGroup - 1) / shared::kProbeGroup);
  commands_.barrier(gpu::use::compute_write, gpu::use::host_read);
  commands_.submit();
  (void)commands_.finish();
  out.invalidate();
  std::memcpy(answers.data(), out.mapped(), answers.size());
  if (device_->validationErrors() > 0) throw std::runtime_error("the validation layer found errors; see the log");
}

Probe& probe() {
  static Probe instance;
  return instance;
}

}  // namespace helio::test
