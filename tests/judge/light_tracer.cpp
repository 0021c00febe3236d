#include "judge/light_tracer.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

namespace helio::judge {
namespace {

constexpr double kLeast = 1e-7;  // metres: nearer a particle meets the surface that it leaves
constexpr uint64_t kBatches = 64;

/// Lambert's cosine around a unit normal.
glm::dvec3 scattered(const glm::dvec3& normal, std::mt19937_64& random) {
  const glm::dvec3 t =
      glm::normalize(glm::cross(std::abs(normal.x) > 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0), normal));
  const double radius = std::sqrt(uniform(random)), phi = 2.0 * kPi * uniform(random);
  return radius * std::cos(phi) * t + radius * std::sin(phi) * glm::cross(normal, t) +
         std::sqrt(std::max(0.0, 1.0 - radius * radius)) * normal;
}

}  // namespace

LightTracer::LightTracer(scene::ScenePtr scene) : scene_(std::move(scene)), geometry_(*scene_) {
  for (const scene::Material& m : scene_->materials)
    if (!m.lambert) throw std::invalid_argument("the material '" + m.name + "' is not Lambert");
  for (uint32_t i = 0; i < geometry_.size(); ++i) {
    const Triangle& t = geometry_.triangle(i);
    const glm::dvec3 emission(scene_->materials[t.material].emission);
    if (emission == glm::dvec3(0.0)) continue;
    const glm::dvec3 a = t.p[1] - t.p[0], b = t.p[2] - t.p[0], n = glm::cross(a, b);
    lamps_.push_back({t.p[0], a, b, glm::normalize(n), emission, 0.5 * glm::length(n)});
  }
  if (lamps_.empty()) throw std::invalid_argument("nothing shines in scene '" + scene_->name + "'");
}

double LightTracer::seenBy(const scene::Camera& camera, const Picture& picture, const glm::dvec3& p,
                           const glm::dvec3& normal) const {
  const glm::dvec3 forward = glm::normalize(glm::dvec3(camera.forward));
  const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up))), up = glm::cross(right, forward);
  const double half_height = std::tan(0.5 * static_cast<double>(camera.vfov));
  const double half_width = half_height * picture.width / picture.height;
  const glm::dvec3 to_camera = glm::dvec3(camera.position) - p;
  const double distance = glm::length(to_camera);
  const glm::dvec3 direction = to_camera / distance;
  const double cos_surface = glm::dot(normal, direction), cos_camera = -glm::dot(forward, direction);
  if (cos_surface <= 0.0 || cos_camera <= 0.0) return 0.0;
  if (std::abs(glm::dot(right, direction)) > half_width * cos_camera ||
      std::abs(glm::dot(up, direction)) > half_height * cos_camera)
    return 0.0;
  const auto hit = geometry_.intersect({p, direction}, kLeast);
  if (hit && hit->t < distance) return 0.0;
  // Radiance cos / pi times solid angle over the solid angle's share of the image plane, which is 1 away.
  const double image = 4.0 * half_width * half_height;
  return cos_surface / kPi / (distance * distance) / (image * std::pow(cos_camera, 3.0));
}

glm::dvec3 LightTracer::trace(const Lamp& lamp, const glm::dvec3& face, const scene::Camera& camera,
                              const Picture& picture, std::mt19937_64& random) const {
  const double root = std::sqrt(uniform(random)), v = uniform(random);
  glm::dvec3 p = lamp.corner + root * (1.0 - v) * lamp.a + root * v * lamp.b, normal = face;
  glm::dvec3 flux = lamp.emission * kPi;  // of a square metre
  glm::dvec3 seen(0.0);
  for (uint32_t scatterings = 0;; ++scatterings) {
    seen += flux * seenBy(camera, picture, p, normal);
    if (scatterings > picture.bounces) return seen;
    const Ray ray{p, scattered(normal, random)};
    const auto hit = geometry_.intersect(ray, kLeast);
    if (!hit) return seen;
    const Triangle& t = geometry_.triangle(hit->triangle);
    p = ray.origin + hit->t * ray.direction;
    normal = glm::normalize(glm::cross(t.p[1] - t.p[0], t.p[2] - t.p[0]));
    if (glm::dot(normal, ray.direction) > 0.0) normal = -normal;
    flux *= glm::dvec3(scene_->materials[t.material].base_color);
    if (flux == glm::dvec3(0.0)) return seen;
  }
}

Estimate LightTracer::meanRadiance(const scene::Camera& camera, const Picture& picture, const glm::dvec3& facing,
                                   uint64_t particles, uint64_t seed) const {
  double area = 0.0;
  for (const Lamp& lamp : lamps_) area += lamp.area;
  const uint64_t each = std::max<uint64_t>(1, particles / kBatches);
  std::vector<glm::dvec3> means(kBatches, glm::dvec3(0.0));
  std::atomic<uint64_t> next{0};
  const auto work = [&] {
    for (uint64_t batch; (batch = next++) < kBatches;) {
      std::seed_seq sequence{seed, batch};
      std::mt19937_64 random(sequence);
      for (uint64_t i = 0; i < each; ++i) {
        double at = uniform(random) * area;
        size_t chosen = 0;
        while (chosen + 1 < lamps_.size() && at >= lamps_[chosen].area) at -= lamps_[chosen++].area;
        const Lamp& lamp = lamps_[chosen];
        const glm::dvec3 normal = glm::dot(lamp.normal, facing) > 0.0 ? lamp.normal : -lamp.normal;
        means[batch] += trace(lamp, normal, camera, picture, random) * (area / static_cast<double>(each));
      }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned i = 0; i < std::max(1u, std::thread::hardware_concurrency()); ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();

  Estimate result;
  for (const glm::dvec3& mean : means) result.mean += mean / static_cast<double>(kBatches);
  for (const glm::dvec3& mean : means) result.error += (mean - result.mean) * (mean - result.mean);
  result.error = glm::sqrt(result.error / static_cast<double>(kBatches * (kBatches - 1)));
  return result;
}

}  // namespace helio::judge
