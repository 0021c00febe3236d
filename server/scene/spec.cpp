#include "scene/spec.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "scene/gltf.h"

namespace helio::scene {
namespace {

using nlohmann::json;

constexpr float kSmallestSun = 1e-4f;  // radians

/// What is wrong with the file; caught in loadSpec().
struct Fault {
  std::string field, what;
};

const json& at(const json& object, const std::string& field) {
  const auto found = object.find(field);
  if (found == object.end()) throw Fault{field, "is missing"};
  return *found;
}

double number(const json& object, const std::string& field) {
  const json& value = at(object, field);
  if (!value.is_number() || !std::isfinite(value.get<double>())) throw Fault{field, "is not a number: " + value.dump()};
  return value.get<double>();
}

uint32_t count(const json& object, const std::string& field) {
  const double value = number(object, field);
  if (value < 0.0 || value > 1e9 || value != std::floor(value))
    throw Fault{field, "is " + at(object, field).dump() + ": give a whole number"};
  return static_cast<uint32_t>(value);
}

std::string text(const json& object, const std::string& field) {
  const json& value = at(object, field);
  if (!value.is_string()) throw Fault{field, "is not a string: " + value.dump()};
  return value.get<std::string>();
}

glm::vec3 vec(const json& object, const std::string& field) {
  const json& value = at(object, field);
  glm::vec3 v;
  bool good = value.is_array() && value.size() == 3;
  for (int i = 0; good && i < 3; ++i) {
    good = value[static_cast<size_t>(i)].is_number();
    if (good) v[i] = value[static_cast<size_t>(i)].get<float>();
    good = good && std::isfinite(v[i]);
  }
  if (!good) throw Fault{field, "is not a list of three numbers: " + value.dump()};
  return v;
}

Camera camera(const json& description) {
  Camera camera;
  camera.position = vec(description, "position");
  const glm::vec3 forward = vec(description, "target") - camera.position;
  if (glm::length(forward) < 1e-6f) throw Fault{"camera", "looks nowhere: position and target are the same point"};
  camera.forward = glm::normalize(forward);
  camera.up = std::abs(camera.forward.y) > 0.9999f ? glm::vec3(0, 0, -1) : glm::vec3(0, 1, 0);
  camera.vfov = glm::radians(static_cast<float>(number(description, "vfov_deg")));
  return camera;
}

Environment environment(const json& document) {
  Environment light;
  const json& suns = at(document, "suns");
  if (!suns.is_array()) throw Fault{"suns", "is not a list: " + suns.dump()};
  if (suns.size() > 1) throw Fault{"suns", "has " + std::to_string(suns.size()) + " entries: one sun is supported"};
  for (const json& sun : suns) {
    const glm::vec3 direction = vec(sun, "direction");
    if (glm::length(direction) < 1e-6f) throw Fault{"suns.direction", "has no length"};
    light.sun.direction = glm::normalize(direction);
    light.sun.irradiance = vec(sun, "irradiance");
    // A sun of size 0 becomes the smallest disc whose directions floats still tell apart.
    const auto diameter = glm::radians(static_cast<float>(number(sun, "angular_diameter_deg")));
    light.sun.angular_diameter = std::max(diameter, kSmallestSun);
  }
  const json& sky = at(document, "sky");
  const std::string type = text(sky, "type");
  if (type == "constant") {
    light.sky.zenith = light.sky.ground = vec(sky, "radiance");
  } else if (type == "gradient") {
    light.sky = {vec(sky, "zenith"), vec(sky, "ground")};
  } else {
    throw Fault{"sky.type", "is \"" + type + "\": give constant or gradient"};
  }
  return light;
}

bool lambert(const json& document) {
  if (!document.contains("materials")) return false;
  const std::string materials = text(document, "materials");
  if (materials != "gltf" && materials != "lambert")
    throw Fault{"materials", "is \"" + materials + "\": give gltf or lambert"};
  return materials == "lambert";
}

}  // namespace

Result<Spec> loadSpec(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) return Error{ErrorKind::not_found, "there is no file " + file.string(), "spec", file.string(), {}};
  try {
    const json document = json::parse(stream);
    if (!document.is_object()) throw Fault{"file", "is no JSON object"};
    Spec spec;
    spec.name = text(document, "name");
    spec.width = count(document, "width");
    spec.height = count(document, "height");
    spec.samples = count(document, "spp");
    spec.bounces = count(document, "max_bounces");
    spec.lambert = lambert(document);
    Scene scene;
    if (!at(document, "gltf").is_null()) {
      auto model = loadGltf(file.parent_path() / text(document, "gltf"));
      if (!model) return model.error();
      scene = **model;
    }
    scene.name = spec.name;
    scene.environment = environment(document);
    scene.cameras = {
        {"spec", "the camera of " + file.filename().string(), camera(at(document, "camera")), scene.environment}};
    spec.scene = std::make_shared<const Scene>(std::move(scene));
    return spec;
  } catch (const json::exception& error) {
    return invalid("spec", file.string(), file.string() + " is no JSON: " + error.what());
  } catch (const Fault& fault) {
    return invalid(fault.field, file.string(), file.string() + ": " + fault.field + " " + fault.what);
  }
}

}  // namespace helio::scene
