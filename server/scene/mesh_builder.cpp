#include "scene/mesh_builder.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/random.h"

namespace helio::scene {
namespace {

using glm::vec2;
using glm::vec3;

/// Horizontal and uphill axes of a plane.
struct PlaneAxes {
  vec3 across, up;
};
PlaneAxes planeAxes(const vec3& normal) {
  const bool level = std::abs(normal.y) > 0.9999f;
  const vec3 across = level ? vec3(1.0f, 0.0f, 0.0f) : glm::normalize(glm::cross(vec3(0.0f, 1.0f, 0.0f), normal));
  return {across, glm::cross(normal, across)};
}

/// Coordinates of the box face that `normal` looks at most.
vec2 boxProjection(const vec3& p, const vec3& normal) {
  const vec3 a = glm::abs(normal);
  if (a.y >= a.x && a.y >= a.z) return {p.x, p.z};
  return a.x >= a.z ? vec2(p.z, -p.y) : vec2(p.x, -p.y);
}

struct Icosphere {
  std::vector<vec3> points;
  std::vector<std::array<uint32_t, 3>> faces;
};

Icosphere icosphere(int levels) {
  const float golden = 0.5f * (1.0f + std::sqrt(5.0f));
  Icosphere s;
  for (float a : {-1.0f, 1.0f}) {
    for (float b : {-golden, golden}) {
      s.points.push_back(glm::normalize(vec3(a, b, 0.0f)));
      s.points.push_back(glm::normalize(vec3(0.0f, a, b)));
      s.points.push_back(glm::normalize(vec3(b, 0.0f, a)));
    }
  }
  // The faces of an icosahedron are its triples of mutually nearest corners.
  const float edge = 1.1f;
  for (uint32_t i = 0; i < 12; ++i) {
    for (uint32_t j = i + 1; j < 12; ++j) {
      for (uint32_t k = j + 1; k < 12; ++k) {
        const vec3 a = s.points[i], b = s.points[j], c = s.points[k];
        if (glm::distance(a, b) > edge || glm::distance(b, c) > edge || glm::distance(a, c) > edge) continue;
        const bool outward = glm::dot(glm::cross(b - a, c - a), a + b + c) > 0.0f;
        s.faces.push_back(outward ? std::array{i, j, k} : std::array{i, k, j});
      }
    }
  }
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> midpoints;
    const auto midpoint = [&](uint32_t a, uint32_t b) {
      const auto [entry, fresh] = midpoints.try_emplace(std::minmax(a, b), static_cast<uint32_t>(s.points.size()));
      if (fresh) s.points.push_back(glm::normalize(s.points[a] + s.points[b]));
      return entry->second;
    };
    std::vector<std::array<uint32_t, 3>> finer;
    for (const auto& [a, b, c] : s.faces) {
      const uint32_t ab = midpoint(a, b), bc = midpoint(b, c), ca = midpoint(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    s.faces = std::move(finer);
  }
  return s;
}

/// A Blob's surface; seen from its centre each direction meets it once.
struct LumpyBall {
  vec3 centre;
  std::vector<vec3> points;  // from the centre
  std::vector<vec3> normals;
  std::vector<std::array<uint32_t, 3>> faces;
};

LumpyBall makeBall(const Blob& blob) {
  Icosphere sphere = icosphere(blob.levels);
  LumpyBall ball{blob.centre, {}, std::vector<vec3>(sphere.points.size(), vec3(0.0f)), std::move(sphere.faces)};
  for (size_t i = 0; i < sphere.points.size(); ++i) {
    const float radius = 1.0f + blob.lumps * (2.0f * unitFloat(hash64(blob.seed, i)) - 1.0f);
    ball.points.push_back(sphere.points[i] * blob.radii * radius);
  }
  for (const auto& [a, b, c] : ball.faces) {
    const vec3 n = glm::cross(ball.points[b] - ball.points[a], ball.points[c] - ball.points[a]);
    for (uint32_t i : {a, b, c}) ball.normals[i] += n;
  }
  for (vec3& n : ball.normals) n = glm::normalize(n);
  return ball;
}

/// Is `p` (from the ball's centre) well below the ball's surface?
bool covers(const LumpyBall& ball, vec3 p) {
  constexpr float kMargin = 0.97f;
  for (const auto& [a, b, c] : ball.faces) {
    // p = u a + v b + w c: the centre sees p through this face if none is negative, and in front of it if they sum to
    // less than 1.
    const vec3 &pa = ball.points[a], &pb = ball.points[b], &pc = ball.points[c];
    const float volume = glm::dot(pa, glm::cross(pb, pc));
    const float u = glm::dot(p, glm::cross(pb, pc)) / volume, v = glm::dot(pa, glm::cross(p, pc)) / volume,
                w = glm::dot(pa, glm::cross(pb, p)) / volume;
    if (u >= 0.0f && v >= 0.0f && w >= 0.0f) return u + v + w < kMargin;
  }
  return false;
}

/// Does `other` cover this face of `ball`: its corners and its middle?
bool hides(const LumpyBall& other, const LumpyBall& ball, const std::array<uint32_t, 3>& face) {
  const vec3 shift = ball.centre - other.centre;
  vec3 middle(0.0f);
  for (uint32_t i : face) {
    if (!covers(other, shift + ball.points[i])) return false;
    middle += ball.points[i] / 3.0f;
  }
  return covers(other, shift + middle);
}

}  // namespace

void addSubmeshes(Mesh& mesh, const std::map<uint32_t, std::vector<uint32_t>>& by_material) {
  for (const auto& [material, indices] : by_material) {
    mesh.submeshes.push_back(
        {static_cast<uint32_t>(mesh.indices.size()), static_cast<uint32_t>(indices.size()), material});
    mesh.indices.insert(mesh.indices.end(), indices.begin(), indices.end());
  }
}

void MeshBuilder::setFrame(glm::vec3 origin, int quarter_turns) {
  origin_ = origin;
  quarter_turns_ = quarter_turns & 3;
}

vec3 MeshBuilder::turned(vec3 v) const {
  switch (quarter_turns_) {
    case 0:
      return v;
    case 1:
      return {v.z, v.y, -v.x};
    case 2:
      return {-v.x, v.y, -v.z};
    default:
      return {-v.z, v.y, v.x};
  }
}

uint32_t MeshBuilder::vertex(vec3 position, vec3 normal, vec2 uv) {
  mesh_.positions.push_back(origin_ + turned(position));
  mesh_.normals.push_back(turned(normal));
  mesh_.uvs.push_back(uv);
  if (rigged_) mesh_.skin.push_back({{joint_, 0, 0, 0}, {1.0f, 0.0f, 0.0f, 0.0f}});
  return static_cast<uint32_t>(mesh_.positions.size() - 1);
}

void MeshBuilder::polygon(uint32_t material, const std::vector<vec3>& points) {
  const vec3 normal = glm::normalize(glm::cross(points[1] - points[0], points[2] - points[0]));
  const PlaneAxes axes = planeAxes(normal);
  const vec2 metres = palette_.metres[material];
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (const vec3& p : points) vertex(p, normal, vec2(glm::dot(p, axes.across), -glm::dot(p, axes.up)) / metres);
  for (uint32_t i = 2; i < points.size(); ++i) {
    indices(material).insert(indices(material).end(), {first, first + i - 1, first + i});
  }
}

void MeshBuilder::picture(uint32_t material, vec3 a, vec3 b, vec3 c, vec3 d) {
  const vec3 normal = glm::normalize(glm::cross(b - a, c - a));
  const uint32_t i = vertex(a, normal, {0.0f, 1.0f});
  vertex(b, normal, {1.0f, 1.0f});
  vertex(c, normal, {1.0f, 0.0f});
  vertex(d, normal, {0.0f, 0.0f});
  indices(material).insert(indices(material).end(), {i, i + 1, i + 2, i, i + 2, i + 3});
}

void MeshBuilder::box(uint32_t material, vec3 a, vec3 b, uint32_t omit) {
  const vec3 p000(a.x, a.y, a.z), p100(b.x, a.y, a.z), p010(a.x, b.y, a.z), p110(b.x, b.y, a.z);
  const vec3 p001(a.x, a.y, b.z), p101(b.x, a.y, b.z), p011(a.x, b.y, b.z), p111(b.x, b.y, b.z);
  if (!(omit & kNoFront)) quad(material, p001, p101, p111, p011);
  if (!(omit & kNoBack)) quad(material, p100, p000, p010, p110);
  if (!(omit & kNoRight)) quad(material, p101, p100, p110, p111);
  if (!(omit & kNoLeft)) quad(material, p000, p001, p011, p010);
  if (!(omit & kNoTop)) quad(material, p011, p111, p110, p010);
  if (!(omit & kNoBottom)) quad(material, p000, p100, p101, p001);
}

void MeshBuilder::frustum(uint32_t material, vec3 base, float bottom_radius, float top_radius, float height, int sides,
                          bool bottom) {
  const vec2 metres = palette_.metres[material];
  const float slope = (bottom_radius - top_radius) / height;
  const float girth = 6.2831853f * std::max(bottom_radius, top_radius);
  const auto first = static_cast<uint32_t>(mesh_.positions.size());
  for (int i = 0; i <= sides; ++i) {
    const double turns = static_cast<double>(i % sides) / sides;
    const vec2 direction = unitVector(turns);
    const vec3 around(direction.x, 0.0f, -direction.y);
    const vec3 normal = glm::normalize(around + vec3(0.0f, slope, 0.0f));
    const float u = girth * static_cast<float>(i) / static_cast<float>(sides) / metres.x;
    vertex(base + around * bottom_radius, normal, {u, 0.0f});
    vertex(base + around * top_radius + vec3(0.0f, height, 0.0f), normal, {u, -height / metres.y});
  }
  std::vector<uint32_t>& list = indices(material);
  for (uint32_t i = 0; i < static_cast<uint32_t>(sides); ++i) {
    const uint32_t a = first + 2 * i, b = a + 2;
    list.insert(list.end(), {a, b, a + 1});
    if (top_radius > 0.0f) list.insert(list.end(), {b, b + 1, a + 1});
  }
  std::vector<vec3> top, under;
  for (int i = 0; i < sides; ++i) {
    const vec2 direction = unitVector(static_cast<double>(i) / sides);
    top.push_back(base + vec3(direction.x * top_radius, height, -direction.y * top_radius));
    under.insert(under.begin(), base + vec3(direction.x * bottom_radius, 0.0f, -direction.y * bottom_radius));
  }
  if (top_radius > 0.0f) polygon(material, top);
  if (bottom) polygon(material, under);
}

void MeshBuilder::prism(uint32_t material, vec3 base, float bottom_radius, float top_radius, float height, int sides,
                        bool bottom) {
  std::vector<vec3> low, high;
  for (int i = 0; i < sides; ++i) {
    const vec2 direction = unitVector((i + 0.5) / sides + 0.25);
    low.push_back(base + vec3(direction.x * bottom_radius, 0.0f, -direction.y * bottom_radius));
    high.push_back(base + vec3(direction.x * top_radius, height, -direction.y * top_radius));
  }
  for (int i = 0; i < sides; ++i) {
    const int j = (i + 1) % sides;
    if (top_radius > 0.0f) quad(material, low[i], low[j], high[j], high[i]);
    else triangle(material, low[i], low[j], high[i]);
  }
  if (top_radius > 0.0f) polygon(material, high);
  if (bottom) polygon(material, {low.rbegin(), low.rend()});
}

void MeshBuilder::blobs(uint32_t material, const std::vector<Blob>& blobs) {
  std::vector<LumpyBall> balls;
  balls.reserve(blobs.size());
  for (const Blob& blob : blobs) balls.push_back(makeBall(blob));
  const vec2 metres = palette_.metres[material];
  for (const LumpyBall& ball : balls) {
    for (const std::array<uint32_t, 3>& face : ball.faces) {
      if (std::ranges::any_of(balls,
                              [&](const LumpyBall& other) { return &other != &ball && hides(other, ball, face); }))
        continue;
      const vec3 facing = ball.normals[face[0]] + ball.normals[face[1]] + ball.normals[face[2]];
      for (uint32_t i : face) {
        const vec3 p = ball.centre + ball.points[i];
        indices(material).push_back(vertex(p, ball.normals[i], boxProjection(p, facing) / metres));
      }
    }
  }
}

void MeshBuilder::hangOn(uint16_t joint) {
  rigged_ = true;
  joint_ = joint;
  mesh_.skin.resize(mesh_.positions.size(), {{joint, 0, 0, 0}, {1.0f, 0.0f, 0.0f, 0.0f}});
}

Mesh MeshBuilder::build() {
  addSubmeshes(mesh_, by_material_);
  mesh_.finish();
  return std::move(mesh_);
}

}  // namespace helio::scene
