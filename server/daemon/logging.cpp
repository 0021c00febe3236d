#include "daemon/logging.h"

#include <spdlog/formatter.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <nlohmann/json.hpp>

namespace helio::daemon {
namespace {

class JsonLine final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
    spdlog::memory_buf_t time;
    time_.format(message, time);
    const auto level = spdlog::level::to_string_view(message.level);
    const nlohmann::ordered_json line = {{"time", std::string(time.data(), time.size())},
                                         {"level", std::string(level.data(), level.size())},
                                         {"message", std::string(message.payload.data(), message.payload.size())}};
    // What is no UTF-8 is replaced: a log line is never worth a crash.
    const std::string text = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLine>(); }

 private:
  spdlog::pattern_formatter time_{"%Y-%m-%dT%H:%M:%S.%eZ", spdlog::pattern_time_type::utc, ""};
};

}  // namespace

void configureLogs(const std::string& level, const std::string& format) {
  if (format == "json") {
    auto logger = std::make_shared<spdlog::logger>("heliographd", std::make_shared<spdlog::sinks::stdout_sink_mt>());
    spdlog::set_default_logger(std::move(logger));
    spdlog::set_formatter(std::make_unique<JsonLine>());
  }
  spdlog::set_level(spdlog::level::from_str(level));
}

}  // namespace helio::daemon
