#include "judge/path_tracer.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <thread>

namespace helio::judge {
namespace {

/// Nearer than this a ray meets the surface that it leaves, metres.
constexpr double kLeast = 1e-7;
/// A shading normal is bent towards a viewer who would see less than this of its front.
constexpr double kFacing = 1e-3;

/// Tangent and bitangent of a unit vector.
glm::dmat3 frameOf(const glm::dvec3& n) {
  const glm::dvec3 t = glm::normalize(glm::cross(std::abs(n.x) > 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), n));
  return {t, glm::cross(n, t), n};
}

Ray cameraRay(const scene::Camera& camera, const Picture& picture, double x, double y) {
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.forward));
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up)));
  const glm::dvec3 up = glm::cross(right, forward);
  const double half_height = std::tan(0.5 * static_cast<double>(camera.vfov));
  const double half_width = half_height * picture.width / picture.height;
  const double across = (2.0 * x / picture.width - 1.0) * half_width,
               down = (2.0 * y / picture.height - 1.0) * half_height;
  return {glm::dvec3(camera.position), glm::normalize(forward + across * right - down * up)};
}

}  // namespace

PathTracer::PathTracer(scene::ScenePtr scene) : scene_(std::move(scene)), geometry_(*scene_) {
  for (const scene::Material& m : scene_->materials) {
    if (m.base_color_texture != scene::kNone || m.normal_texture != scene::kNone ||
        m.metallic_roughness_texture != scene::kNone || m.emissive_texture != scene::kNone)
      throw std::invalid_argument("the material '" + m.name + "' has a texture; the judge knows none");
    materials_.push_back(
        {glm::dvec3(m.base_color), static_cast<double>(m.metallic), static_cast<double>(m.roughness), m.lambert});
  }
}

PathTracer::Surface PathTracer::surfaceAt(const Ray& ray, const Intersection& hit) const {
  const Triangle& t = geometry_.triangle(hit.triangle);
  Surface s{ray.origin + hit.t * ray.direction, glm::normalize(glm::cross(t.p[1] - t.p[0], t.p[2] - t.p[0])),
            glm::normalize((1.0 - hit.u - hit.v) * t.normal[0] + hit.u * t.normal[1] + hit.v * t.normal[2]),
            t.material};
  if (glm::dot(s.geometric_normal, ray.direction) > 0.0) s.geometric_normal = -s.geometric_normal;
  if (glm::dot(s.normal, s.geometric_normal) < 0.0) s.normal = -s.normal;
  const double facing = -glm::dot(s.normal, ray.direction);
  if (facing < kFacing) s.normal = glm::normalize(s.normal - (kFacing - facing) * ray.direction);
  return s;
}

glm::dvec3 PathTracer::fromInfinity(const glm::dvec3& direction, bool scattered) const {
  const scene::Environment& environment = scene_->environment;
  glm::dvec3 light =
      glm::mix(glm::dvec3(environment.sky.ground), glm::dvec3(environment.sky.zenith), 0.5 + 0.5 * direction.y);
  // The sun's disc is not shown to the camera. Its radiance L gives the irradiance L pi sin^2.
  const glm::dvec3 towards = -glm::normalize(glm::dvec3(environment.sun.direction));
  const double half_angle = 0.5 * static_cast<double>(environment.sun.angular_diameter);
  if (scattered && std::acos(std::clamp(glm::dot(direction, towards), -1.0, 1.0)) < half_angle)
    light += glm::dvec3(environment.sun.irradiance) / (kPi * std::pow(std::sin(half_angle), 2.0));
  return light;
}

glm::dvec3 PathTracer::radiance(Ray ray, uint32_t bounces, std::mt19937_64& random) const {
  glm::dvec3 gathered(0.0), throughput(1.0);
  for (uint32_t scatterings = 0;; ++scatterings) {
    const std::optional<Intersection> hit = geometry_.intersect(ray, kLeast);
    if (!hit) return gathered + throughput * fromInfinity(ray.direction, scatterings > 0);
    const Surface s = surfaceAt(ray, *hit);
    gathered += throughput * glm::dvec3(scene_->materials[s.material].emission);
    if (scatterings > bounces) return gathered;

    const glm::dmat3 frame = frameOf(s.normal);
    const Sample scattered = sample(materials_[s.material], -ray.direction * frame, random);
    throughput *= scattered.weight;
    if (throughput == glm::dvec3(0.0)) return gathered;
    ray = {s.position, frame * scattered.wi};
    if (glm::dot(ray.direction, s.geometric_normal) <= 0.0) return gathered;
  }
}

std::vector<std::vector<double>> PathTracer::render(const scene::Camera& camera, const Picture& picture,
                                                    uint32_t samples, uint32_t batches, uint64_t seed) const {
  std::vector<std::vector<double>> result(batches, std::vector<double>(size_t{3} * picture.width * picture.height));
  std::atomic<uint32_t> next{0};
  const auto work = [&] {
    for (uint32_t batch; (batch = next++) < batches;) {
      std::seed_seq sequence{seed, uint64_t{batch}};
      std::mt19937_64 random(sequence);
      for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x) {
          glm::dvec3 sum(0.0);
          for (uint32_t i = 0; i < samples; ++i) {
            const double px = x + uniform(random), py = y + uniform(random);
            sum += radiance(cameraRay(camera, picture, px, py), picture.bounces, random);
          }
          for (int c = 0; c < 3; ++c)
            result[batch][3 * (size_t{y} * picture.width + x) + static_cast<size_t>(c)] = sum[c] / samples;
        }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  return result;
}

}  // namespace helio::judge
