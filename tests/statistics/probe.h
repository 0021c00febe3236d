// Puts questions to the GLSL functions of shaders/lib on the test device: one compute invocation an item.
#pragma once

#include <cstring>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "gpu/commands.h"
#include "gpu/device.h"
#include "gpu/pipelines.h"
#include "shaders/probe.h"

namespace helio::test {

/// Samples behind each chi-square test.
inline constexpr size_t kSamples = 1'000'000;

class Probe {
 public:
  Probe();

  gpu::Device& device() { return *device_; }

  /// Answers of tests/shaders/<shader> to `questions`, in their order. Of `constants`, only what describes the question
  /// need be set.
  template <typename Answer, typename Question>
  std::vector<Answer> ask(const std::string& shader, shared::ProbeConstants constants,
                          std::span<const Question> questions) {
    std::vector<Answer> answers(questions.size());
    dispatch(shader, constants, std::as_bytes(questions), static_cast<uint32_t>(questions.size()),
             std::as_writable_bytes(std::span(answers)));
    return answers;
  }

 private:
  void dispatch(const std::string& shader, shared::ProbeConstants constants, std::span<const std::byte> questions,
                uint32_t count, std::span<std::byte> answers);

  std::unique_ptr<gpu::Device> device_;
  gpu::Commands commands_;
  std::map<std::string, gpu::ComputePipeline> pipelines_;
  gpu::Buffer randoms_;  // kSamples items of the Mersenne Twister: samplers are judged without the renderer's generator
};

/// The process's probe, with the validation layer on unless HELIOGRAPH_TEST_WITHOUT_VALIDATION is set.
Probe& probe();

}  // namespace helio::test
