#include "telemetry/metrics.h"

#include <prometheus/text_serializer.h>

namespace helio::telemetry {

using prometheus::BuildCounter;
using prometheus::BuildGauge;
using prometheus::BuildHistogram;

prometheus::Gauge& Metrics::gauge(const char* name, const char* help) {
  return BuildGauge().Name(name).Help(help).Register(registry_).Add({});
}

prometheus::Counter& Metrics::counter(const char* name, const char* help) {
  return BuildCounter().Name(name).Help(help).Register(registry_).Add({});
}

prometheus::Histogram& Metrics::seconds(const char* name, const char* help) {
  // From below a frame at 240/s to what a person calls broken.
  const prometheus::Histogram::BucketBoundaries bounds = {0.001, 0.002, 0.004, 0.008, 0.016, 0.033, 0.066,
                                                          0.125, 0.25,  0.5,   1,     2,     4,     8};
  return BuildHistogram().Name(name).Help(help).Register(registry_).Add({}, bounds);
}

Metrics::Metrics(const std::string& version)
    : worlds_(BuildGauge().Name("heliograph_worlds").Help("Worlds by state.").Register(registry_)),
      calls_(BuildCounter()
                 .Name("heliograph_calls_total")
                 .Help("Calls that have ended, streams too, by method and gRPC status.")
                 .Register(registry_)) {
  BuildGauge()
      .Name("heliograph_build_info")
      .Help("Always 1; the label has the version.")
      .Register(registry_)
      .Add({{"version", version}})
      .Set(1);
}

void Metrics::setWorlds(const std::string& state, double count) { worlds_.Add({{"state", state}}).Set(count); }

void Metrics::called(const std::string& method, const std::string& code) {
  calls_.Add({{"method", method}, {"code", code}}).Increment();
}

std::string Metrics::text() const { return prometheus::TextSerializer().Serialize(registry_.Collect()); }

}  // namespace helio::telemetry
