// The buildings that a town has one of. All but the windmill stand around the market square.
#include "scene/catalogue.h"
#include "scene/house_parts.h"
#include "scene/random.h"

namespace helio::scene {
namespace {

using glm::vec3;

/// Runs draw() in the frame of each of a body's four walls: origin at the wall's lower left, +z outwards.
template <typename Draw>
void onWalls(MeshBuilder& b, vec3 centre, float width, float depth, Draw draw) {
  for (int side = 0; side < 4; ++side) {
    const float span = side % 2 == 0 ? width : depth, out = 0.5f * (side % 2 == 0 ? depth : width);
    const vec3 outward = side == 0   ? vec3(0, 0, 1)
                         : side == 1 ? vec3(1, 0, 0)
                         : side == 2 ? vec3(0, 0, -1)
                                     : vec3(-1, 0, 0);
    const vec3 right{outward.z, 0.0f, -outward.x};
    b.setFrame(centre + outward * out - right * (0.5f * span), side);
    draw(side, span);
  }
  b.setFrame(centre);
}

/// Equal windows in `count` axes over one storey of a wall.
std::vector<Opening> axes(int count, float span, float width, float low, float high, uint32_t material) {
  std::vector<Opening> openings;
  for (int i = 0; i < count; ++i) {
    const float x = span * (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
    openings.push_back({x - 0.5f * width, x + 0.5f * width, low, high, material});
  }
  return openings;
}

Mesh church(const Palette& p) {
  MeshBuilder b("church", p);
  const uint32_t stone = p.ashlar[0], roof = p.slate[0], trim = p.trim[1];
  // Nave
  const vec3 nave(0.0f, 0.0f, -3.5f);
  b.setFrame(nave);
  plinth(b, p.ashlar[1], 12.0f, 20.0f);
  onWalls(b, nave, 12.0f, 20.0f, [&](int side, float span) {
    const auto windows = side % 2 == 1 ? axes(5, span, 1.3f, 2.4f, 7.4f, p.window) : std::vector<Opening>{};
    wallWithOpenings(b, stone, 0.0f, span, kPlinth, 9.0f, windows, 0.35f);
    if (side % 2 == 0) return;
    for (int i = 1; i < 5; ++i) {  // buttresses between the windows
      const float x = span * static_cast<float>(i) / 5.0f;
      b.box(stone, {x - 0.35f, -kFoundation, -0.1f}, {x + 0.35f, 6.8f, 0.9f}, kNoBottom | kNoBack);
    }
  });
  b.setFrame(nave, 1);
  gableRoof(b, roof, stone, trim, {20.0f, 12.0f, 9.0f, 7.5f, 0.4f, 0.3f});
  // Apse
  b.setFrame();
  b.prism(stone, {0.0f, -kFoundation, -13.4f}, 4.2f, 4.2f, 7.0f + kFoundation, 8);
  b.prism(roof, {0.0f, 7.0f, -13.4f}, 4.6f, 0.0f, 4.0f, 8, true);
  // Tower
  const vec3 tower(0.0f, 0.0f, 9.6f);
  b.setFrame(tower);
  plinth(b, p.ashlar[1], 7.0f, 7.0f);
  onWalls(b, tower, 7.0f, 7.0f, [&](int side, float span) {
    std::vector<Opening> portal;
    if (side == 0) portal = {{2.3f, 4.7f, kPlinth, 4.0f, p.door[3]}};
    wallWithOpenings(b, stone, 0.0f, span, kPlinth, 12.0f, portal, 0.6f);
    wallWithOpenings(b, stone, 0.0f, span, 12.0f, 22.0f, axes(2, span, 1.1f, 17.0f, 20.6f, p.trim[2]), 0.5f);
    framedWindow(b, p.gold, p.trim[0], {0.5f * span - 0.9f, 13.3f}, {0.5f * span + 0.9f, 15.1f});
  });
  stringCourse(b, trim, 7.0f, 7.0f, 11.8f, 0.4f, 0.2f);
  stringCourse(b, trim, 7.0f, 7.0f, 21.8f, 0.5f, 0.35f);
  b.prism(p.copper, {0.0f, 22.3f, 0.0f}, 4.6f, 1.6f, 4.5f, 8, true);
  b.prism(p.copper, {0.0f, 26.8f, 0.0f}, 1.6f, 0.0f, 9.0f, 8);
  b.blob(p.gold, {{0.0f, 35.9f, 0.0f}, vec3(0.35f), 0, 0.0f, 1});
  b.box(p.ashlar[1], {-2.0f, -kFoundation, 3.4f}, {2.0f, 0.33f, 4.6f}, kNoBottom);
  return b.build();
}

Mesh townHall(const Palette& p) {
  MeshBuilder b("town_hall", p);
  const uint32_t wall = p.plaster[1], stone = p.ashlar[0], trim = p.trim[1], roof = p.roof_tiles[0];
  const float width = 27.5f, depth = 15.0f;
  plinth(b, p.ashlar[1], width, depth);
  onWalls(b, vec3(0.0f, kPlinth, 0.0f), width, depth, [&](int side, float span) {
    const int count = side % 2 == 0 ? 11 : 5;
    auto ground = axes(count, span, 1.3f, side == 0 ? 0.1f : 0.9f, 2.9f, p.window);
    if (side == 0) ground[5] = {0.5f * span - 1.1f, 0.5f * span + 1.1f, 0.0f, 3.0f, p.door[0]};
    wallWithOpenings(b, stone, 0.0f, span, 0.0f, 4.0f, ground, 0.4f);
    wallWithOpenings(
        b, wall, 0.0f, span, 4.0f, 7.8f,
        side == 2 ? axes(5, span, 1.2f, 4.7f, 7.0f, p.window) : axes(count, span, 1.2f, 4.7f, 7.0f, p.window), 0.2f);
    wallWithOpenings(b, wall, 0.0f, span, 7.8f, 11.0f,
                     side == 0 ? axes(count, span, 1.1f, 8.5f, 10.2f, p.window) : std::vector<Opening>{}, 0.2f);
  });
  b.setFrame();
  stringCourse(b, trim, width, depth, kPlinth + 3.9f, 0.3f, 0.18f);
  hipRoof(b, roof, trim, {width, depth, kPlinth + 11.0f, 5.2f, 0.6f, 0.0f});
  // Arcade: columns carry a balcony over the entrance.
  for (int i = 0; i < 4; ++i) {
    b.frustum(stone, {-4.5f + 3.0f * static_cast<float>(i), -kFoundation, 9.4f}, 0.36f, 0.30f, 4.1f + kFoundation, 8);
  }
  b.box(trim, {-5.4f, 4.1f, 7.3f}, {5.4f, 4.6f, 10.0f}, kNoBack);
  for (int i = 0; i < 10; ++i) {
    const float x = -5.2f + 10.3f * static_cast<float>(i) / 9.0f;
    b.box(trim, {x - 0.07f, 4.6f, 9.74f}, {x + 0.07f, 5.4f, 9.88f}, kNoBottom | kNoTop);
  }
  b.box(trim, {-5.4f, 5.4f, 9.68f}, {5.4f, 5.55f, 9.94f});
  b.box(p.ashlar[1], {-6.2f, -kFoundation, 7.2f}, {6.2f, 0.3f, 10.4f}, kNoBottom);
  // Clock tower over the entrance
  const vec3 tower(0.0f, 0.0f, 4.6f);
  onWalls(b, tower, 5.6f, 5.6f, [&](int, float span) {
    wallWithOpenings(b, wall, 0.0f, span, 10.0f, 23.0f, axes(2, span, 0.9f, 19.6f, 21.8f, p.trim[2]), 0.3f);
    framedWindow(b, p.gold, p.trim[0], {0.5f * span - 0.9f, 16.4f}, {0.5f * span + 0.9f, 18.2f});
  });
  stringCourse(b, trim, 5.6f, 5.6f, 15.4f, 0.35f, 0.2f);
  stringCourse(b, trim, 5.6f, 5.6f, 22.8f, 0.45f, 0.35f);
  b.prism(p.copper, {0.0f, 23.25f, 0.0f}, 4.1f, 2.2f, 2.6f, 4, true);
  b.prism(p.copper, {0.0f, 25.85f, 0.0f}, 1.9f, 1.7f, 2.2f, 8);
  b.prism(p.copper, {0.0f, 28.05f, 0.0f}, 2.0f, 0.0f, 5.0f, 8, true);
  b.blob(p.gold, {{0.0f, 33.1f, 0.0f}, vec3(0.3f), 0, 0.0f, 2});
  return b.build();
}

/// An exhibition hall of mirror glass: panes between slender fins, stepped upper storeys.
Mesh glassHall(const Palette& p) {
  MeshBuilder b("glass_hall", p);
  plinth(b, p.ashlar[1], 25.0f, 20.0f);
  const auto storeys = [&](vec3 centre, float width, float depth, float low, float high, int rows) {
    onWalls(b, centre, width, depth, [&](int side, float span) {
      b.quad(p.mirror, {0.0f, low, 0.0f}, {span, low, 0.0f}, {span, high, 0.0f}, {0.0f, high, 0.0f});
      const int columns = side % 2 == 0 ? 8 : 6;
      for (int i = 0; i <= columns; ++i) {
        const float x = span * static_cast<float>(i) / static_cast<float>(columns);
        b.box(p.trim[0], {x - 0.09f, low, -0.05f}, {x + 0.09f, high, 0.22f}, kNoBottom | kNoTop | kNoBack);
      }
      for (int i = 1; i < rows; ++i) {
        const float y = low + (high - low) * static_cast<float>(i) / static_cast<float>(rows);
        b.box(p.trim[0], {0.0f, y - 0.08f, -0.05f}, {span, y + 0.08f, 0.14f}, kNoBack | kNoLeft | kNoRight);
      }
    });
    stringCourse(b, p.trim[0], width, depth, high - 0.1f, 0.5f, 0.3f);
    b.setFrame();
  };
  storeys(vec3(0.0f), 25.0f, 20.0f, kPlinth, 14.5f, 4);
  storeys(vec3(0.0f), 16.0f, 12.5f, 14.9f, 22.5f, 2);
  b.setFrame();
  hipRoof(b, p.mirror, p.trim[0], {16.0f, 12.5f, 22.9f, 2.4f, 0.1f, 0.0f});
  b.box(p.trim[0], {-2.6f, kPlinth, 9.9f}, {2.6f, 3.6f, 11.4f}, kNoBottom | kNoBack);
  b.picture(p.door[1], {-1.2f, kPlinth, 11.43f}, {1.2f, kPlinth, 11.43f}, {1.2f, 2.9f, 11.43f}, {-1.2f, 2.9f, 11.43f});
  b.box(p.ashlar[0], {-3.4f, -kFoundation, 9.9f}, {3.4f, 0.3f, 12.2f}, kNoBottom);
  return b.build();
}

const vec3 kMillHub(0.0f, 11.9f, 3.5f);

/// `turning`: its tower hangs on joint 0 and its sails on joint 1 of millRig().
Mesh windmill(const Palette& p, const char* name, bool turning) {
  MeshBuilder b(name, p);
  if (turning) b.hangOn(0);
  b.frustum(p.plaster[0], {0.0f, -kFoundation, 0.0f}, 4.0f, 2.5f, 11.0f + kFoundation, 12);
  b.prism(p.planks[1], {0.0f, 11.0f, 0.0f}, 2.9f, 2.6f, 0.6f, 12, true);
  b.frustum(p.planks[1], {0.0f, 11.6f, 0.0f}, 2.6f, 0.0f, 2.6f, 12);
  b.box(p.planks[1], {-0.2f, 11.7f, 0.0f}, {0.2f, 12.1f, 3.6f});
  b.box(p.ashlar[0], {-0.8f, -kFoundation, 3.0f}, {0.8f, 0.3f, 4.6f}, kNoBottom);
  b.picture(p.door[2], {-0.6f, 0.3f, 3.95f}, {0.6f, 0.3f, 3.95f}, {0.6f, 2.5f, 3.75f}, {-0.6f, 2.5f, 3.75f});
  // Sails: a diagonal cross of lattice and canvas in the plane z = 3.5.
  if (turning) b.hangOn(1);
  const vec3 hub = kMillHub;
  for (const glm::vec2 d : {glm::vec2(0.9239f, 0.3827f), glm::vec2(-0.3827f, 0.9239f), glm::vec2(-0.9239f, -0.3827f),
                            glm::vec2(0.3827f, -0.9239f)}) {
    const vec3 along(d.x, d.y, 0.0f), across(-d.y, d.x, 0.0f), out(0.0f, 0.0f, 0.06f);
    const auto vane = [&](uint32_t material, float from, float to, float left, float right, float z) {
      const vec3 a = hub + along * from + across * left, c = hub + along * to + across * right;
      const vec3 ab = hub + along * to + across * left, ad = hub + along * from + across * right;
      const vec3 lift(0.0f, 0.0f, z);
      b.quad(material, a + lift + out, ab + lift + out, c + lift + out, ad + lift + out);
      b.quad(material, ad + lift - out, c + lift - out, ab + lift - out, a + lift - out);
    };
    vane(p.planks[1], 0.0f, 8.6f, -0.12f, 0.12f, 0.08f);
    vane(p.cloth, 1.6f, 8.4f, -1.5f, 0.3f, 0.0f);
  }
  return b.build();
}

Rig millRig() {
  constexpr float kTurnSeconds = 7.0f;
  Rig rig;
  rig.name = "windmill";
  RigNode tower, sails;
  sails.parent = 0;
  sails.translation = sails.rest[3] = kMillHub;
  rig.nodes = {tower, sails};
  rig.joints = {{0, glm::mat4x3(1.0f)}, {1, glm::mat4x3(1.0f)}};
  rig.joints[1].inverse_bind[3] = -kMillHub;
  Channel turn;
  turn.node = 1;
  turn.target = ChannelTarget::rotation;
  for (int quarter = 0; quarter <= 4; ++quarter) {
    const glm::dvec2 half_angle = unitVector(-0.125 * quarter);  // clockwise, seen from the front
    turn.times.push_back(kTurnSeconds * static_cast<float>(quarter) / 4.0f);
    for (const double c : {0.0, 0.0, half_angle.y, half_angle.x}) turn.values.push_back(static_cast<float>(c));
  }
  rig.clips = {{"turn", kTurnSeconds, {turn}}};
  return rig;
}

/// A gate of the old town wall: two round towers and an arch with a room above it.
Mesh gatehouse(const Palette& p) {
  MeshBuilder b("gatehouse", p);
  for (const float x : {-6.0f, 6.0f}) {
    b.frustum(p.ashlar[1], {x, -kFoundation, 0.0f}, 2.9f, 2.7f, 13.0f + kFoundation, 14);
    b.prism(p.ashlar[1], {x, 13.0f, 0.0f}, 3.1f, 3.1f, 1.0f, 14, true);
    b.frustum(p.roof_tiles[2], {x, 14.0f, 0.0f}, 3.3f, 0.0f, 5.5f, 14, true);
  }
  b.box(p.ashlar[1], {-4.2f, 5.2f, -2.0f}, {4.2f, 10.0f, 2.0f});
  b.setFrame({0.0f, 0.0f, 2.0f});
  for (const float x : {-2.0f, 0.0f, 2.0f}) framedWindow(b, p.trim[1], p.window, {x - 0.4f, 7.0f}, {x + 0.4f, 8.4f});
  b.setFrame();
  gableRoof(b, p.roof_tiles[2], p.ashlar[1], p.trim[2], {8.2f, 4.0f, 10.0f, 2.6f, 0.3f, -0.4f});
  return b.build();
}

}  // namespace

void addLandmarks(Catalogue& catalogue) {
  const Palette& p = catalogue.palette;
  catalogue.church = catalogue.add(church(p), "landmark");
  catalogue.town_hall = catalogue.add(townHall(p), "landmark");
  catalogue.glass_hall = catalogue.add(glassHall(p), "landmark");
  catalogue.windmill = catalogue.add(windmill(p, "windmill", false), "landmark");
  catalogue.turning_mill = catalogue.addRigged(windmill(p, "windmill_turning", true), "landmark", millRig());
  catalogue.prefabs[catalogue.turning_mill].out_of_step = true;
  catalogue.gatehouse = catalogue.add(gatehouse(p), "landmark");
}

}  // namespace helio::scene
