#include "scene/levels_of_detail.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include <meshoptimizer.h>

#include "scene/triangle_order.h"

namespace helio::scene {
namespace {

constexpr double kReduction = 0.35;    // of triangles, a level
constexpr float kFarthestOff = 0.25f;  // of the mesh's extent: what is coarser than that is no longer this mesh
constexpr float kTileOff = 0.005f;  // the same of a tile: its outline stays, so that more would hardly save triangles
constexpr float kMeeting = 1e-5f;   // of the mesh's extent: vertices nearer than about that are at one place
constexpr size_t kMostCombinations = 1'000;
constexpr float kAreaKept = 0.7f;     // of what faces a direction
constexpr float kAreaIgnored = 0.1f;  // of the largest such area: sides as small as that may change
constexpr float kCreaseCost = 4.0f;   // of a normal that is off, beside the stretch of a texture

/// Vertices that count as one while triangles are joined: `representative[v]` is the first of those at v's place (and
/// on the same joints), and `next[v]` the one behind v among them, or kNone. `positions` are equal where they all but
/// are: the two sides of a seam must meet to the last bit, or the surface would be torn open along it.
struct Welding {
  std::vector<uint32_t> representative, next;
  std::vector<glm::vec3> positions;
};

/// What must be equal of two vertices that are one.
struct Place {
  glm::vec3 position;
  glm::u16vec4 joints{0};
  glm::vec4 weights{0.0f};
};

/// Positions of which those that all but coincide are equal: in a lattice's cell they are its first vertex's.
std::vector<glm::vec3> meetingPositions(const Mesh& mesh) {
  const size_t count = mesh.positions.size();
  Aabb box;
  for (const glm::vec3& p : mesh.positions) box.grow(p);
  const float step = std::max(kMeeting * glm::length(box.extent()), 1e-30f);
  std::vector<glm::vec3> cells(count);
  for (size_t v = 0; v < count; ++v) cells[v] = glm::round((mesh.positions[v] - box.min) / step);
  std::vector<unsigned int> remap(count);
  meshopt_generateVertexRemap<uint32_t>(remap.data(), mesh.indices.data(), mesh.indices.size(), cells.data(), count,
                                        sizeof(glm::vec3));
  std::vector<uint32_t> first_of(count, kNone);
  std::vector<glm::vec3> positions = mesh.positions;
  for (uint32_t v = 0; v < count; ++v) {
    if (remap[v] == kNone) continue;  // no triangle uses it
    if (first_of[remap[v]] == kNone) first_of[remap[v]] = v;
    positions[v] = mesh.positions[first_of[remap[v]]];
  }
  return positions;
}

/// A number for what the morph targets do to each vertex: equal where they do the same [FNV-1a].
std::vector<uint64_t> morphDigests(const Mesh& mesh) {
  std::vector<uint64_t> digests(mesh.positions.size(), 0xcbf29ce484222325u);
  for (const MorphTarget& target : mesh.morph_targets) {
    for (size_t v = 0; v < digests.size(); ++v) {
      for (int axis = 0; axis < 3; ++axis)
        digests[v] = (digests[v] ^ std::bit_cast<uint32_t>(target.positions[v][axis] + 0.0f)) * 0x100000001b3u;
    }
  }
  return digests;
}

Welding weld(const Mesh& mesh, Seams seams) {
  const size_t count = mesh.positions.size();
  Welding welding;
  welding.positions = meetingPositions(mesh);
  welding.representative.resize(count);
  std::vector<unsigned int> remap(count);
  std::vector<Place> places(count, Place{});
  for (size_t v = 0; v < count; ++v) {
    places[v].position = welding.positions[v] + 0.0f;  // -0 becomes 0
    if (!mesh.skin.empty()) {
      places[v].joints = mesh.skin[v].joints;
      places[v].weights = mesh.skin[v].weights;
    }
  }
  // Corners that differ in nothing but their tangents are one at any rate.
  std::vector<meshopt_Stream> streams{{places.data(), sizeof(Place), sizeof(Place)}};
  const std::vector<uint64_t> morphs = morphDigests(mesh);
  if (!mesh.morph_targets.empty()) streams.push_back({morphs.data(), sizeof(uint64_t), sizeof(uint64_t)});
  if (seams == Seams::keep) {
    streams.push_back({mesh.normals.data(), sizeof(glm::vec3), sizeof(glm::vec3)});
    streams.push_back({mesh.uvs.data(), sizeof(glm::vec2), sizeof(glm::vec2)});
    for (const std::vector<glm::vec2>& uvs : mesh.more_uvs)
      streams.push_back({uvs.data(), sizeof(glm::vec2), sizeof(glm::vec2)});
    if (!mesh.colors.empty()) streams.push_back({mesh.colors.data(), sizeof(glm::vec4), sizeof(glm::vec4)});
  }
  meshopt_generateVertexRemapMulti<uint32_t>(remap.data(), mesh.indices.data(), mesh.indices.size(), count,
                                             streams.data(), streams.size());
  welding.next.assign(count, kNone);
  std::vector<uint32_t> first_of(count, kNone), last_of(count, kNone);
  for (uint32_t v = 0; v < count; ++v) {
    if (remap[v] == kNone) continue;  // no triangle uses it
    uint32_t &first = first_of[remap[v]], &last = last_of[remap[v]];
    (first == kNone ? first : welding.next[last]) = v;
    last = v;
    welding.representative[v] = first;
  }
  return welding;
}

/// Area that faces each of six directions, as it would be seen were nothing in the way: square metres.
std::array<float, 6> facingAreas(const Mesh& mesh, std::span<const uint32_t> indices) {
  std::array<float, 6> areas{};
  for (size_t t = 0; t + 2 < indices.size(); t += 3) {
    const glm::vec3 &a = mesh.positions[indices[t]], &b = mesh.positions[indices[t + 1]],
                    &c = mesh.positions[indices[t + 2]];
    const glm::vec3 area = 0.5f * glm::cross(b - a, c - a);
    for (size_t axis = 0; axis < 3; ++axis) {
      const float signed_area = area[static_cast<int>(axis)];
      areas[2 * axis + (signed_area < 0.0f ? 1 : 0)] += std::abs(signed_area);
    }
  }
  return areas;
}

/// The largest area by which coarse triangles show more or less of themselves to a side than the fine ones: square
/// metres; 0 where it is little of what there is. Quadrics do not care: to them a roof of two slopes is as good without
/// one of them.
float changedArea(const Mesh& mesh, std::span<const uint32_t> fine, std::span<const uint32_t> coarse) {
  const std::array<float, 6> before = facingAreas(mesh, fine), after = facingAreas(mesh, coarse);
  const float ignored = kAreaIgnored * *std::max_element(before.begin(), before.end());
  float changed = 0.0f;
  for (size_t side = 0; side < before.size(); ++side) {
    const auto [less, more] = std::minmax(before[side], after[side]);
    if (less < kAreaKept * more - ignored) changed = std::max(changed, more - less);
  }
  return changed;
}

/// Triangles and how far off they are, metres.
struct Simplified {
  std::vector<uint32_t> indices;
  float error = 0.0f;
};

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, Seams seams)
      : mesh_(mesh),
        welding_(weld(mesh, seams)),
        used_(mesh.positions.size()),
        numbered_(mesh.positions.size()),
        number_(mesh.positions.size()) {}

  /// A submesh with about `target` triangles; as it is when nothing coarser comes near it. Where it would show much
  /// more or less of itself to a side, it keeps as many triangles as it takes; `at_any_rate`: it does not, and is off
  /// by as much as that.
  Simplified simplify(const Submesh& submesh, size_t target, bool at_any_rate) {
    const auto fine = std::span(mesh_.indices).subspan(submesh.first_index, submesh.index_count);
    for (size_t goal = target; goal < fine.size() / 3; goal += goal / 2 + 1) {
      Simplified coarse = towards(fine, goal);
      const float changed = changedArea(mesh_, fine, coarse.indices);
      if (changed > 0.0f && !at_any_rate) continue;
      coarse.error = std::max(coarse.error, std::sqrt(changed));
      return coarse;
    }
    return {{fine.begin(), fine.end()}, 0.0f};
  }

  /// All submeshes at once, with about `target` triangles: what lies along the mesh's outline stays, and a border
  /// between two submeshes moves for both, since to the library it is a seam.
  std::vector<Simplified> simplifyWithinOutline(size_t target) {
    Joined joined;
    std::vector<size_t> begins;  // by submesh: its first place
    for (const Submesh& submesh : mesh_.submeshes) {
      begins.push_back(joined.places.size());
      join(std::span(mesh_.indices).subspan(submesh.first_index, submesh.index_count), joined);
    }
    std::vector<uint32_t> coarse(joined.indices.size());
    float error = 0.0f;
    const float* first = &joined.positions[0].x;
    coarse.resize(meshopt_simplify<uint32_t>(coarse.data(), joined.indices.data(), joined.indices.size(), first,
                                             joined.positions.size(), sizeof(glm::vec3), 3 * target, kTileOff,
                                             meshopt_SimplifyLockBorder, &error));
    error *= meshopt_simplifyScale(first, joined.positions.size(), sizeof(glm::vec3));
    std::vector<Simplified> result(mesh_.submeshes.size(), Simplified{{}, error});
    for (size_t t = 0; t < coarse.size(); t += 3) {
      const auto behind = std::upper_bound(begins.begin(), begins.end(), size_t{coarse[t]});
      std::vector<uint32_t>& indices = result[static_cast<size_t>(behind - begins.begin()) - 1].indices;
      for (const uint32_t vertex : corners(joined, &coarse[t])) indices.push_back(vertex);
    }
    return result;
  }

 private:
  /// Triangles over places that are numbered by themselves: clustering looks at every place that it is given.
  struct Joined {
    std::vector<uint32_t> indices;
    std::vector<uint32_t> places, turns;  // by number
    std::vector<glm::vec3> positions;
  };

  /// Adds a submesh's triangles, but for those that have no area.
  void join(std::span<const uint32_t> fine, Joined& joined) {
    ++turn_;
    const auto placeOf = [&](uint32_t vertex) {
      used_[vertex] = turn_;
      const uint32_t place = welding_.representative[vertex];
      if (numbered_[place] != turn_) {
        numbered_[place] = turn_;
        number_[place] = static_cast<uint32_t>(joined.places.size());
        joined.places.push_back(place);
        joined.turns.push_back(turn_);
        joined.positions.push_back(welding_.positions[place]);
      }
      return number_[place];
    };
    for (size_t t = 0; t + 2 < fine.size(); t += 3) {
      const std::array<uint32_t, 3> corner{placeOf(fine[t]), placeOf(fine[t + 1]), placeOf(fine[t + 2])};
      if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0])
        joined.indices.insert(joined.indices.end(), corner.begin(), corner.end());
    }
  }

  /// The mesh's vertices for a triangle of `joined`.
  std::array<uint32_t, 3> corners(const Joined& joined, const uint32_t* triangle) const {
    return chooseCorners({joined.places[triangle[0]], joined.places[triangle[1]], joined.places[triangle[2]]},
                         joined.turns[triangle[0]]);
  }

  Simplified towards(std::span<const uint32_t> fine, size_t target) {
    Simplified result{{fine.begin(), fine.end()}, 0.0f};
    Joined joined;
    join(fine, joined);
    if (joined.indices.size() / 3 <= target) return result;

    std::vector<uint32_t> coarse(joined.indices.size());
    float error = 0.0f;
    const float* first = &joined.positions[0].x;
    size_t count =
        meshopt_simplify<uint32_t>(coarse.data(), joined.indices.data(), joined.indices.size(), first,
                                   joined.positions.size(), sizeof(glm::vec3), 3 * target, kFarthestOff, 0, &error);
    if (count > 3 * target * 3 / 2) {
      // Many small parts: no edge of theirs can go, so places that lie together become one.
      std::vector<uint32_t> clustered(joined.indices.size());
      float cluster_error = 0.0f;
      const size_t left = meshopt_simplifySloppy<uint32_t>(clustered.data(), joined.indices.data(),
                                                           joined.indices.size(), first, joined.positions.size(),
                                                           sizeof(glm::vec3), 3 * target, kFarthestOff, &cluster_error);
      if (left > 0 && left < count) {
        coarse = std::move(clustered);
        count = left;
        error = cluster_error;
      }
    }
    coarse.resize(count);
    if (coarse.empty() || coarse.size() >= joined.indices.size()) return result;
    result.indices.clear();
    for (size_t t = 0; t < coarse.size(); t += 3)
      for (const uint32_t vertex : corners(joined, &coarse[t])) result.indices.push_back(vertex);
    result.error = error * meshopt_simplifyScale(first, joined.positions.size(), sizeof(glm::vec3));
    return result;
  }

  /// The corners of a joined triangle, one of the submesh's vertices at each of its three places: those whose normals
  /// fit it, and whose texture coordinates lie together.
  std::array<uint32_t, 3> chooseCorners(const std::array<uint32_t, 3>& places, uint32_t turn) const {
    const glm::vec3 &a = mesh_.positions[places[0]], &b = mesh_.positions[places[1]], &c = mesh_.positions[places[2]];
    const glm::vec3 scaled = glm::cross(b - a, c - a);
    const float size = glm::length(scaled);
    const glm::vec3 facing = size > 0.0f ? scaled / size : glm::vec3(0.0f);
    std::array<std::vector<uint32_t>, 3> wedges;
    for (size_t k = 0; k < 3; ++k)
      for (uint32_t v = places[k]; v != kNone; v = welding_.next[v])
        if (used_[v] == turn) wedges[k].push_back(v);
    std::array<uint32_t, 3> best{wedges[0].front(), wedges[1].front(), wedges[2].front()};
    // Fans of very many triangles do not let each corner see each other one.
    if (wedges[0].size() * wedges[1].size() * wedges[2].size() > kMostCombinations) return best;
    float least = std::numeric_limits<float>::infinity();
    for (const uint32_t i : wedges[0]) {
      for (const uint32_t j : wedges[1]) {
        for (const uint32_t k : wedges[2]) {
          const float crease = 3.0f - glm::dot(facing, mesh_.normals[i] + mesh_.normals[j] + mesh_.normals[k]);
          const float stretch = glm::distance(mesh_.uvs[i], mesh_.uvs[j]) + glm::distance(mesh_.uvs[j], mesh_.uvs[k]) +
                                glm::distance(mesh_.uvs[k], mesh_.uvs[i]);
          const float cost = kCreaseCost * crease + stretch;
          if (cost < least) {
            least = cost;
            best = {i, j, k};
          }
        }
      }
    }
    return best;
  }

  const Mesh& mesh_;
  Welding welding_;
  std::vector<uint32_t> used_;               // by vertex: the turn in which a submesh used it
  std::vector<uint32_t> numbered_, number_;  // by place: the turn in which it had a number, and the number
  uint32_t turn_ = 0;
};

/// Levels of about kReduction of the triangles of the one before: `simplify(share, last)` gives the submeshes with that
/// share of theirs.
void addLevels(Mesh& mesh, const std::function<std::vector<Simplified>(double share, bool last)>& simplify) {
  mesh.levels.clear();
  size_t before = mesh.indices.size() / 3;
  if (before < kFewestTrianglesForLevels) return;
  float error_before = 0.0f;
  double share = 1.0;
  for (size_t i = 0; i < kMostCoarserLevels; ++i) {
    share *= kReduction;
    MeshLevel level;
    level.error = error_before;
    const std::vector<Simplified> parts = simplify(share, i + 1 == kMostCoarserLevels);
    for (size_t part = 0; part < parts.size(); ++part) {
      level.submeshes.push_back(mesh.submeshes[part]);
      Submesh& coarse = level.submeshes.back();
      coarse.first_index = static_cast<uint32_t>(level.indices.size());
      coarse.index_count = static_cast<uint32_t>(parts[part].indices.size());
      level.indices.insert(level.indices.end(), parts[part].indices.begin(), parts[part].indices.end());
      level.error = std::max(level.error, parts[part].error);
      if (coarse.index_count < mesh.submeshes[part].index_count) orderTriangles(mesh.positions, level.indices, coarse);
    }
    const size_t triangles = level.indices.size() / 3;
    if (static_cast<double>(triangles) > kLevelShare * static_cast<double>(before)) continue;
    before = triangles;
    error_before = level.error;
    mesh.levels.push_back(std::move(level));
  }
}

}  // namespace

void makeLevels(Mesh& mesh, const std::vector<Material>& materials, Seams seams) {
  Simplifier simplifier(mesh, seams);
  const auto asItIs = [&](const Submesh& submesh) {
    const Material& material = materials[submesh.material];
    return material.masked() || material.emission != glm::vec3(0.0f) || material.unlit;
  };
  addLevels(mesh, [&](double share, bool last) {
    std::vector<Simplified> parts;
    for (const Submesh& submesh : mesh.submeshes) {
      const size_t all = submesh.index_count / 3;
      const auto target = static_cast<size_t>(std::ceil(share * static_cast<double>(all)));
      parts.push_back(simplifier.simplify(submesh, asItIs(submesh) ? all : target, last));
    }
    return parts;
  });
}

void makeTileLevels(Mesh& mesh) {
  Simplifier simplifier(mesh, Seams::cross);
  const size_t triangles = mesh.indices.size() / 3;
  const auto all = static_cast<double>(triangles);
  addLevels(mesh, [&](double share, bool) {
    return simplifier.simplifyWithinOutline(static_cast<size_t>(std::ceil(share * all)));
  });
}

std::vector<uint32_t> coarsestFirst(const Mesh& mesh) {
  std::vector<uint32_t> order;
  if (mesh.levels.empty()) return order;
  std::vector<bool> taken(mesh.positions.size());
  const auto take = [&](uint32_t vertex) {
    if (taken[vertex]) return;
    taken[vertex] = true;
    order.push_back(vertex);
  };
  for (auto level = mesh.levels.rbegin(); level != mesh.levels.rend(); ++level)
    std::for_each(level->indices.begin(), level->indices.end(), take);
  for (uint32_t vertex = 0; vertex < mesh.positions.size(); ++vertex) take(vertex);
  return order;
}

}  // namespace helio::scene
