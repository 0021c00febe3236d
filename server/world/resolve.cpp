#include "world/resolve.h"

#include <algorithm>
#include <cmath>

#include <spdlog/fmt/fmt.h>

#include "scene/city.h"
#include "world/validate.h"

namespace helio::world {
namespace {

Error overLimit(const std::string& field, uint64_t value, uint64_t limit, const std::string& what) {
  return {ErrorKind::limit, fmt::format("{}: {} {}, at most {} are allowed", field, value, what, limit), field,
          fmt::format("{}", value), fmt::format("{}", limit)};
}

Error emptyList(const std::string& field, const std::string& what) {
  return invalid(field, "0", fmt::format("{} is empty: name at least one {}", field, what));
}

Error unknown(const std::string& field, const std::string& value, const std::string& why) {
  return {ErrorKind::not_found, fmt::format("{} is {}: {}", field, value, why), field, value, {}};
}

}  // namespace

Resolver::Resolver(Present present) : present_(std::move(present)), live_(present_.table.liveCount()) {}

Result<Batch> Resolver::resolve(std::span<const Edit> edits) {
  if (edits.empty()) return emptyList("edits", "edit");
  if (edits.size() > present_.limits.max_edits_per_batch) {
    return overLimit("edits", edits.size(), present_.limits.max_edits_per_batch, "edits in a batch");
  }
  Batch batch;
  batch.edits.reserve(edits.size());
  for (size_t i = 0; i < edits.size(); ++i) {
    const std::string path = fmt::format("edits[{}]", i);
    Result<ResolvedEdit> resolved = std::visit([&](const auto& edit) { return resolveEdit(edit, path); }, edits[i]);
    if (!resolved) return resolved.error();
    batch.edits.push_back(std::move(*resolved));
  }
  return batch;
}

Result<ResolvedEdit> Resolver::resolveEdit(const Build& build, const std::string& path) {
  const std::string field = path + ".build.prefab";
  const auto entry = present_.prefab_by_name.find(build.prefab);
  if (entry == present_.prefab_by_name.end()) {
    return unknown(field, "\"" + build.prefab + "\"",
                   "this world has no such prefab, list its prefabs to see what it has");
  }
  const uint32_t prefab = entry->second;
  if (!present_.scene.prefabs[prefab].buildable) {
    return invalid(field, build.prefab, fmt::format("{} is \"{}\": users may not build it", field, build.prefab));
  }

  const std::string list = path + ".build.poses";
  const size_t count = build.poses.size();
  if (count == 0) return emptyList(list, "pose");
  poses_ += count;
  if (poses_ > present_.limits.max_poses_per_batch) {
    return overLimit(list, poses_, present_.limits.max_poses_per_batch, "poses in a batch");
  }
  if (live_ + count > present_.limits.max_instances) {
    return overLimit(list, live_ + count, present_.limits.max_instances, "instances in the world");
  }
  live_ += count;

  ResolvedBuild resolved{prefab, present_.next_id, {}};
  resolved.poses.reserve(count);
  for (size_t k = 0; k < count; ++k) {
    const Result<Pose> pose = checkedPose(build.poses[k], present_.limits.max_coordinate);
    if (!pose) return at(fmt::format("{}[{}]", list, k), pose.error());
    resolved.poses.push_back(*pose);
    overlay(present_.next_id++, centreXz(present_.scene, prefab, pose->matrix()));
  }
  return ResolvedEdit(std::move(resolved));
}

Result<ResolvedEdit> Resolver::resolveEdit(const Destroy& edit, const std::string& path) {
  const std::string list = path + ".destroy.ids";
  if (edit.ids.empty()) return emptyList(list, "id");
  for (size_t k = 0; k < edit.ids.size(); ++k) {
    const Result<const Instance*> instance = changeable(edit.ids[k], fmt::format("{}[{}]", list, k));
    if (!instance) return instance.error();
    destroy(edit.ids[k]);
  }
  return ResolvedEdit(ResolvedDestroy{edit.ids});
}

Result<ResolvedEdit> Resolver::resolveEdit(const DestroyRegion& region, const std::string& path) {
  const std::string name = path + ".destroy_region";
  if (++regions_ > present_.limits.max_regions_per_batch) {
    return overLimit(name, regions_, present_.limits.max_regions_per_batch, "regions in a batch");
  }
  const glm::vec2& c = region.centre_xz;
  if (!std::isfinite(c.x) || !std::isfinite(c.y)) {
    return at(name, invalid("centre", fmt::format("({}, {})", c.x, c.y), "must be two finite numbers of metres"));
  }
  if (!std::isfinite(region.radius) || region.radius <= 0.0f) {
    const std::string value = fmt::format("{}", region.radius);
    return at(name, invalid("radius", value, "is " + value + ": it must be a finite number of metres greater than 0"));
  }

  ResolvedDestroy resolved;
  present_.table.grid().visitDisc(c, region.radius, [&](uint32_t slot) {
    const Instance& instance = present_.table.at(slot);
    const bool as_before = destroyed_.count(instance.id) == 0 && overlay_of_.count(instance.id) == 0;
    if (as_before && present_.scene.prefabs[instance.prefab].buildable) resolved.ids.push_back(instance.id);
  });
  overlay_grid_.visitDisc(c, region.radius, [&](uint32_t item) { resolved.ids.push_back(overlay_ids_[item]); });
  std::sort(resolved.ids.begin(), resolved.ids.end());
  for (InstanceId id : resolved.ids) destroy(id);
  return ResolvedEdit(std::move(resolved));
}

Result<ResolvedEdit> Resolver::resolveEdit(const Move& move, const std::string& path) {
  const Result<const Instance*> instance = changeable(move.id, path + ".move.id");
  if (!instance) return instance.error();
  const Result<Pose> pose = checkedPose(move.pose, present_.limits.max_coordinate);
  if (!pose) return at(path + ".move.pose", pose.error());
  overlay(move.id, centreXz(present_.scene, (*instance)->prefab, pose->matrix()));
  return ResolvedEdit(ResolvedMove{move.id, *pose});
}

Result<ResolvedEdit> Resolver::resolveEdit(const SetSun& set, const std::string& path) {
  const Result<scene::Sun> sun = checkedSun(set.sun);
  if (!sun) return at(path + ".set_sun", sun.error());
  present_.environment.sun = *sun;
  if (set.daylight) {
    const glm::vec3 towards = -sun->direction;
    const float elevation = std::asin(std::clamp(towards.y, -1.0f, 1.0f));
    const float azimuth =
        std::atan2(towards.x + 0.0f, towards.z + 0.0f);  // + 0: a sun in the zenith has azimuth 0, not pi
    present_.environment.sky = scene::daylight(elevation, azimuth).sky;
  }
  return ResolvedEdit(ResolvedEnvironment{present_.environment});
}

Result<ResolvedEdit> Resolver::resolveEdit(const SetTime& set, const std::string& path) {
  const std::string field = path + ".set_time";
  if (!set.paused && !set.rate && !set.seek)
    return invalid(field, "empty", field + " is empty: give paused, rate or seek");
  Clock clock = present_.clock;
  clock.paused = set.paused.value_or(clock.paused);
  clock.rate = set.rate.value_or(clock.rate);
  clock.time = set.seek.value_or(clock.time);
  if (auto valid = checkClock(clock); !valid) return at(field, valid.error());
  present_.clock = clock;
  return ResolvedEdit(ResolvedTime{clock});
}

Result<const Instance*> Resolver::changeable(InstanceId id, const std::string& field) const {
  const std::string value = fmt::format("{}", id);
  if (destroyed_.count(id) != 0)
    return unknown(field, value, "an earlier entry of this batch destroys it, name it once");
  const Instance* instance = present_.table.find(id);
  if (instance == nullptr) return unknown(field, value, "this world has no such instance");
  const scene::Prefab& prefab = present_.scene.prefabs[instance->prefab];
  if (!prefab.buildable) {
    return invalid(field, value, fmt::format("{} is {}, a \"{}\": users may not change it", field, value, prefab.name));
  }
  return instance;
}

void Resolver::overlay(InstanceId id, glm::vec2 xz) {
  const auto [entry, added] = overlay_of_.emplace(id, static_cast<uint32_t>(overlay_ids_.size()));
  if (added) {
    overlay_ids_.push_back(id);
  } else {
    overlay_grid_.remove(entry->second);
  }
  overlay_grid_.insert(entry->second, xz);
}

void Resolver::destroy(InstanceId id) {
  destroyed_.insert(id);
  --live_;
  const auto entry = overlay_of_.find(id);
  if (entry == overlay_of_.end()) return;
  overlay_grid_.remove(entry->second);
  overlay_of_.erase(entry);
}

}  // namespace helio::world
