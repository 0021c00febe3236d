#include "load/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "load/page.h"

namespace helio::load {
namespace {

constexpr double kBuckets = 240;    // points of a line in a plot
constexpr size_t kMostDots = 1500;  // of a plot of single events
constexpr double kSpike = 3;        // a frame interval beyond so many times the median

/// Three decimals of a millisecond are all that the clocks are worth.
Json rounded(double value) { return std::round(value * 1000) / 1000; }
Json orNull(const std::optional<double>& value) { return value ? rounded(*value) : Json(); }

Json summary(const std::vector<double>& sorted) {
  Json out = {{"count", sorted.size()}};
  for (const char* name : kStatisticNames) out[name] = orNull(statistic(sorted, name));
  return out;
}

// ---- What the page plots: figures a bucket of time, over all clients

struct Bucket {
  std::vector<double> intervals, latencies;
  std::array<double, kStages.size()> stages{};
  double frames = 0, bytes = 0;
};

std::vector<Bucket> bucketsOf(const RunResult& run, double width) {
  std::vector<Bucket> buckets(static_cast<size_t>(run.seconds / width) + 1);
  const auto at = [&](const Sample& sample) -> Bucket& {
    return buckets[std::min(static_cast<size_t>(std::max(0.0f, sample.t) / width), buckets.size() - 1)];
  };
  for (const auto& client : run.clients) {
    const Record& record = *client.record;
    for (const Sample& frame : record.frames()) {
      at(frame).bytes += double(frame.value);
      at(frame).frames += 1;
    }
    for (const Sample& sample : record.series(kFrameInterval)) at(sample).intervals.push_back(double(sample.value));
    for (const Sample& sample : record.series(kMotionToPhoton)) at(sample).latencies.push_back(double(sample.value));
    for (size_t i = 0; i < kStages.size(); ++i)
      for (const Sample& sample : record.series(kStages[i])) at(sample).stages[i] += double(sample.value);
  }
  return buckets;
}

Json timelineOf(const RunResult& run) {
  const double width = std::max(0.5, run.seconds / kBuckets);
  Json out = {{"bucket_seconds", width}, {"t", Json::array()}};
  for (const char* name :
       {"frames_per_second", "megabits_per_second", "interval_p50", "interval_p99", "latency_p50", "latency_p99"})
    out[name] = Json::array();
  out["stages"] = Json::object();
  for (const Series stage : kStages) out["stages"][kSeriesNames[stage]] = Json::array();
  auto buckets = bucketsOf(run, width);
  buckets.pop_back();  // it is not full
  for (size_t i = 0; i < buckets.size(); ++i) {
    auto& bucket = buckets[i];
    std::sort(bucket.intervals.begin(), bucket.intervals.end());
    std::sort(bucket.latencies.begin(), bucket.latencies.end());
    out["t"].push_back(rounded(double(i) * width));
    out["frames_per_second"].push_back(rounded(bucket.frames / width));
    out["megabits_per_second"].push_back(rounded(bucket.bytes * 8e-6 / width));
    out["interval_p50"].push_back(orNull(statistic(bucket.intervals, "p50")));
    out["interval_p99"].push_back(orNull(statistic(bucket.intervals, "p99")));
    out["latency_p50"].push_back(orNull(statistic(bucket.latencies, "p50")));
    out["latency_p99"].push_back(orNull(statistic(bucket.latencies, "p99")));
    for (size_t s = 0; s < kStages.size(); ++s)
      out["stages"][kSeriesNames[kStages[s]]].push_back(bucket.frames > 0 ? rounded(bucket.stages[s] / bucket.frames)
                                                                          : Json());
  }
  out["server"] = {{"t", Json::array()}, {"memory_bytes", Json::array()}, {"ticks_per_second", Json::array()}};
  for (const auto& sample : run.server) {
    out["server"]["t"].push_back(rounded(sample.t));
    out["server"]["memory_bytes"].push_back(sample.memory_bytes);
    out["server"]["ticks_per_second"].push_back(rounded(sample.ticks_per_second));
  }
  return out;
}

/// Single events as [seconds, milliseconds], at most kMostDots: the longest always.
Json dotsOf(const RunResult& run, Series series, double above) {
  std::vector<Sample> dots;
  for (const auto& client : run.clients)
    for (const Sample& sample : client.record->series(series))
      if (double(sample.value) >= above) dots.push_back(sample);
  std::sort(dots.begin(), dots.end(), [](const Sample& a, const Sample& b) { return a.value > b.value; });
  const size_t all = dots.size();
  if (all > kMostDots) {  // half of them the longest, half spread over the rest
    std::vector<Sample> kept(dots.begin(), dots.begin() + kMostDots / 2);
    for (size_t i = 0; i < kMostDots / 2; ++i)
      kept.push_back(dots[kMostDots / 2 + i * (all - kMostDots / 2) / (kMostDots / 2)]);
    dots = std::move(kept);
  }
  Json out = {{"count", all}, {"dots", Json::array()}};
  for (const Sample& sample : dots) out["dots"].push_back({rounded(double(sample.t)), rounded(double(sample.value))});
  return out;
}

/// The latency that a share of all events does not exceed, over the share.
Json percentilesOf(const std::vector<double>& sorted) {
  Json out = Json::array();
  for (const char* p : {"p1", "p5", "p10", "p25", "p50", "p75", "p90", "p95", "p98", "p99", "p99.5", "p99.9", "p100"})
    out.push_back(orNull(statistic(sorted, p)));
  return out;
}

Json groupsOf(const Scenario& scenario, const RunResult& run) {
  Json out = Json::object();
  for (size_t g = 0; g < scenario.groups.size(); ++g) {
    const Group& group = scenario.groups[g];
    const auto clients =
        std::count_if(run.clients.begin(), run.clients.end(), [&](const auto& c) { return c.group == g; });
    if (clients == 0) continue;
    Json& json = out[group.name] = {{"clients", clients}};
    for (const char* name : kGroupCountNames) json[name] = *numberOf(scenario, run, name, group.name);
    for (const char* name : {"frames_per_second", "kilobits_per_second"})
      json[name] = summary(valuesOf(scenario, run, name, group.name));
    json["series"] = Json::object();
    for (const char* name : kSeriesNames)
      if (const auto values = valuesOf(scenario, run, name, group.name); !values.empty())
        json["series"][name] = summary(values);
  }
  return out;
}

Json runJson(const Scenario& scenario, const RunResult& run) {
  Json out = {{"variant", run.variant},
              {"round", run.round},
              {"seconds", rounded(run.seconds)},
              {"groups", groupsOf(scenario, run)},
              {"lost_edits", run.lost_edits},
              {"doubled_edits", run.doubled_edits},
              {"server_memory_mib", summary(valuesOf(scenario, run, "server_memory_mib", ""))},
              {"server_memory_drift_percent", orNull(numberOf(scenario, run, "server_memory_drift_percent", ""))},
              {"mishaps", Json::array()}};
  for (const auto& client : run.clients)
    for (const auto& mishap : client.record->mishaps())
      if (out["mishaps"].size() < 50)
        out["mishaps"].push_back(
            {{"t", rounded(mishap.t)}, {"group", scenario.groups[client.group].name}, {"what", mishap.what}});
  const auto intervals = valuesOf(scenario, run, "frame_interval_ms", "");
  const double usual = statistic(intervals, "p50").value_or(0);
  out["plots"] = {{"timeline", timelineOf(run)},
                  {"jumps", dotsOf(run, kJumpComplete, 0)},
                  {"edits", dotsOf(run, kEditToPicture, 0)},
                  {"spikes", dotsOf(run, kFrameInterval, kSpike * usual)},
                  {"percentiles", Json::object()}};
  for (const Series series :
       {kFrameInterval, kMotionToPhoton, kJump, kJumpComplete, kEdit, kEditToPicture, kFirstFrame})
    if (const auto values = valuesOf(scenario, run, kSeriesNames[series], ""); !values.empty())
      out["plots"]["percentiles"][kSeriesNames[series]] = percentilesOf(values);
  return out;
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') out += "&amp;";
    else if (c == '<') out += "&lt;";
    else if (c == '>') out += "&gt;";
    else if (c == '"') out += "&quot;";
    else if (static_cast<unsigned char>(c) >= 32) out += c;
  }
  return out;
}

std::string figure(const Json& value) {
  if (value.is_null()) return "nothing";
  char text[40];
  std::snprintf(text, sizeof text, "%.6g", value.get<double>());
  return text;
}

std::string sentence(const Json& objective) {
  std::string out = figure(objective["value"]) + (objective["at_most"].get<bool>() ? ", at most " : ", at least ") +
                    figure(objective["limit"]);
  if (const std::string note = objective["note"]; !note.empty()) out += " (" + note + ")";
  return out;
}

}  // namespace

Json reportOf(const Scenario& scenario, const std::vector<RunResult>& runs, const std::vector<Judged>& judged,
              const Provenance& provenance) {
  const bool met = std::all_of(judged.begin(), judged.end(), [](const Judged& j) { return j.met; });
  Json report = {{"schema", "heliograph.load/1"},
                 {"scenario", scenario.name},
                 {"description", scenario.description},
                 {"command", provenance.command},
                 {"date", provenance.date},
                 {"server", {{"version", runs.front().server_version}, {"device", runs.front().device}}},
                 {"seed", scenario.seed},
                 {"warm_up", scenario.warm_up},
                 {"met", met},
                 {"objectives", Json::array()},
                 {"runs", Json::array()}};
  for (const Judged& j : judged)
    report["objectives"].push_back({{"name", j.name},
                                    {"value", orNull(j.value)},
                                    {"limit", j.limit},
                                    {"at_most", j.at_most},
                                    {"met", j.met},
                                    {"note", j.note}});
  for (const RunResult& run : runs) report["runs"].push_back(runJson(scenario, run));
  return report;
}

void append(Json& report, const std::vector<Change>& changes) {
  report["baseline"] = Json::array();
  for (const Change& change : changes)
    report["baseline"].push_back({{"group", change.group},
                                  {"series", change.series},
                                  {"statistic", change.statistic},
                                  {"before", rounded(change.before)},
                                  {"now", rounded(change.now)},
                                  {"percent", rounded(change.percent())}});
}

std::string junitOf(const Json& report) {
  const auto& objectives = report["objectives"];
  const auto missed = std::count_if(objectives.begin(), objectives.end(), [](const Json& o) { return !o["met"]; });
  double seconds = 0;
  for (const auto& run : report["runs"]) seconds += run["seconds"].get<double>();
  const std::string suite = escaped(report["scenario"]);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"" + suite + "\" tests=\"" +
                    std::to_string(objectives.size()) + "\" failures=\"" + std::to_string(missed) + "\" time=\"" +
                    figure(seconds) + "\" timestamp=\"" + escaped(report["date"]) + "\">\n";
  for (const auto& objective : objectives) {
    out += "  <testcase classname=\"" + suite + "\" name=\"" + escaped(objective["name"]) + "\"";
    if (objective["met"]) out += "/>\n";
    else out += ">\n    <failure message=\"" + escaped(sentence(objective)) + "\"/>\n  </testcase>\n";
  }
  return out + "</testsuite>\n";
}

std::string pageOf(const Json& report) {
  std::string data = report.dump();
  for (size_t at = 0; (at = data.find("</", at)) != std::string::npos; at += 3) data.replace(at, 2, "<\\/");
  std::string page(kPage);
  const std::string mark = "/*REPORT*/null";
  page.replace(page.find(mark), mark.size(), data);
  return page;
}

std::string textOf(const Json& report) {
  std::string out;
  for (const auto& objective : report["objectives"])
    out += std::string(objective["met"] ? "  met     " : "  MISSED  ") + objective["name"].get<std::string>() + ": " +
           sentence(objective) + "\n";
  for (const auto& run : report["runs"])
    for (const auto& mishap : run["mishaps"]) {
      char when[32];
      std::snprintf(when, sizeof when, "%.1f s, ", mishap["t"].get<double>());
      out += "  at " + std::string(when) + mishap["group"].get<std::string>() + ": " +
             mishap["what"].get<std::string>() + "\n";
    }
  if (report.contains("baseline"))
    for (const auto& change : report["baseline"])
      out += "  against the baseline: " + change["statistic"].get<std::string>() + " of " +
             change["series"].get<std::string>() + " of " + change["group"].get<std::string>() + " " +
             figure(change["before"]) + " -> " + figure(change["now"]) + " (" + figure(change["percent"]) + " %)\n";
  return out;
}

}  // namespace helio::load
