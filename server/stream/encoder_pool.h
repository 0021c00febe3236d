// Threads that compress pictures, each with a compressor of its own.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "stream/jpeg.h"

namespace helio::stream {

/// The queue is as long as there are viewers at most: each has one picture in the pool at a time.
class EncoderPool {
 public:
  using Job = std::function<void(JpegEncoder&)>;

  explicit EncoderPool(unsigned threads);
  /// Finishes what was submitted.
  ~EncoderPool();

  void submit(Job job);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<Job> jobs_;
  bool ending_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace helio::stream
