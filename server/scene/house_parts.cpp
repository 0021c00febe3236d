#include "scene/house_parts.h"

#include <algorithm>

namespace helio::scene {

using glm::vec2;
using glm::vec3;

namespace {

constexpr float kRoofThickness = 0.2f;  // metres, upright
constexpr float kRoofLift = 0.12f;  // the covering lies this far above the wall plate, which is thus inside the roof

/// Fascia boards and soffit around an overhanging eave at height y.
void eaveBox(MeshBuilder& b, uint32_t trim, float half_width, float half_depth, float y) {
  b.box(trim, {-half_width, y - kRoofThickness, -half_depth}, {half_width, y, half_depth}, kNoTop);
}

}  // namespace

void wallWithOpenings(MeshBuilder& b, uint32_t wall, float x0, float x1, float y0, float y1,
                      const std::vector<Opening>& openings, float recess) {
  const auto panel = [&](float left, float right, float low, float high) {
    if (right - left > 1e-3f && high - low > 1e-3f) {
      b.quad(wall, {left, low, 0.0f}, {right, low, 0.0f}, {right, high, 0.0f}, {left, high, 0.0f});
    }
  };
  float left = x0;
  for (const Opening& o : openings) {
    panel(left, o.x0, y0, y1);
    panel(o.x0, o.x1, y0, o.y0);
    panel(o.x0, o.x1, o.y1, y1);
    const float z = -recess;
    b.quad(wall, {o.x0, o.y0, 0.0f}, {o.x0, o.y0, z}, {o.x0, o.y1, z}, {o.x0, o.y1, 0.0f});
    b.quad(wall, {o.x1, o.y0, z}, {o.x1, o.y0, 0.0f}, {o.x1, o.y1, 0.0f}, {o.x1, o.y1, z});
    b.quad(wall, {o.x0, o.y0, 0.0f}, {o.x1, o.y0, 0.0f}, {o.x1, o.y0, z}, {o.x0, o.y0, z});
    b.quad(wall, {o.x0, o.y1, z}, {o.x1, o.y1, z}, {o.x1, o.y1, 0.0f}, {o.x0, o.y1, 0.0f});
    b.picture(o.material, {o.x0, o.y0, z}, {o.x1, o.y0, z}, {o.x1, o.y1, z}, {o.x0, o.y1, z});
    left = o.x1;
  }
  panel(left, x1, y0, y1);
}

void framedWindow(MeshBuilder& b, uint32_t frame, uint32_t glass, vec2 low, vec2 high) {
  const float border = 0.12f, reach = 0.06f;
  b.box(frame, {low.x - border, low.y - border, -0.05f}, {high.x + border, high.y + border, reach}, kNoBack);
  const float z = reach + 0.02f;
  b.picture(glass, {low.x, low.y, z}, {high.x, low.y, z}, {high.x, high.y, z}, {low.x, high.y, z});
}

void gableRoof(MeshBuilder& b, uint32_t roof, uint32_t wall, uint32_t trim, const RoofPlan& plan) {
  const float half = 0.5f * plan.depth, slope = plan.rise / half;
  const float x = 0.5f * plan.width + plan.verge, z = half + plan.eaves;
  const float ridge = plan.y + plan.rise + kRoofLift, eave = plan.y - plan.eaves * slope + kRoofLift;
  const float under_ridge = ridge - kRoofThickness, under_eave = eave - kRoofThickness;
  for (const float side : {1.0f, -1.0f}) {
    const float sx = side * x, sz = side * z;  // seen from its own side, each slope has its left at -sx
    b.quad(roof, {-sx, eave, sz}, {sx, eave, sz}, {sx, ridge, 0.0f}, {-sx, ridge, 0.0f});
    b.quad(trim, {sx, under_eave, sz}, {-sx, under_eave, sz}, {-sx, under_ridge, 0.0f}, {sx, under_ridge, 0.0f});
    b.quad(trim, {-sx, under_eave, sz}, {sx, under_eave, sz}, {sx, eave, sz}, {-sx, eave, sz});
    b.quad(trim, {sx, under_eave, sz}, {sx, under_ridge, 0.0f}, {sx, ridge, 0.0f}, {sx, eave, sz});
    b.quad(trim, {-sx, under_ridge, 0.0f}, {-sx, under_eave, sz}, {-sx, eave, sz}, {-sx, ridge, 0.0f});
    const float gable = side * 0.5f * plan.width;
    b.triangle(wall, {gable, plan.y, side * half}, {gable, plan.y, -side * half}, {gable, plan.y + plan.rise, 0.0f});
  }
}

void hipRoof(MeshBuilder& b, uint32_t roof, uint32_t trim, const RoofPlan& plan) {
  const float half = 0.5f * std::min(plan.depth, plan.width), slope = plan.rise / half;
  const float x = 0.5f * plan.width + plan.eaves, z = 0.5f * plan.depth + plan.eaves;
  const float eave = plan.y - plan.eaves * slope + kRoofLift, ridge = plan.y + plan.rise + kRoofLift;
  const float rx = 0.5f * plan.width - half, rz = 0.5f * plan.depth - half;  // the ridge's half lengths: one is 0
  const vec3 a(-x, eave, z), c(x, eave, z), d(x, eave, -z), e(-x, eave, -z);
  const auto face = [&](vec3 left, vec3 right, vec3 top_right, vec3 top_left) {
    if (top_left == top_right) b.triangle(roof, left, right, top_left);
    else b.quad(roof, left, right, top_right, top_left);
  };
  face(a, c, {rx, ridge, rz}, {-rx, ridge, rz});
  face(c, d, {rx, ridge, -rz}, {rx, ridge, rz});
  face(d, e, {-rx, ridge, -rz}, {rx, ridge, -rz});
  face(e, a, {-rx, ridge, rz}, {-rx, ridge, -rz});
  eaveBox(b, trim, x, z, eave);
}

void mansardRoof(MeshBuilder& b, uint32_t roof, uint32_t trim, const RoofPlan& plan) {
  const float height = 2.4f, in = 0.8f;
  const float x = 0.5f * plan.width + 0.3f, z = 0.5f * plan.depth + 0.3f, low = plan.y + 0.1f, high = low + height;
  const float ix = x - in, iz = z - in;
  b.quad(roof, {-x, low, z}, {x, low, z}, {ix, high, iz}, {-ix, high, iz});
  b.quad(roof, {x, low, z}, {x, low, -z}, {ix, high, -iz}, {ix, high, iz});
  b.quad(roof, {x, low, -z}, {-x, low, -z}, {-ix, high, -iz}, {ix, high, -iz});
  b.quad(roof, {-x, low, -z}, {-x, low, z}, {-ix, high, iz}, {-ix, high, -iz});
  eaveBox(b, trim, x, z, low);
  hipRoof(b, roof, trim, {2.0f * ix, 2.0f * iz, high, plan.rise, 0.12f, 0.0f});
}

void flatRoof(MeshBuilder& b, uint32_t roof, uint32_t wall, uint32_t trim, const RoofPlan& plan) {
  const float x = 0.5f * plan.width, z = 0.5f * plan.depth, top = plan.y + 0.8f, thickness = 0.3f;
  const float ix = x - thickness, iz = z - thickness, deck = plan.y + 0.1f;  // above the string course
  b.box(wall, {-x, plan.y, -z}, {x, top, z}, kNoTop | kNoBottom);
  b.quad(roof, {-ix, deck, iz}, {ix, deck, iz}, {ix, deck, -iz}, {-ix, deck, -iz});
  b.quad(wall, {ix, deck, iz}, {-ix, deck, iz}, {-ix, top, iz}, {ix, top, iz});
  b.quad(wall, {-ix, deck, -iz}, {ix, deck, -iz}, {ix, top, -iz}, {-ix, top, -iz});
  b.quad(wall, {ix, deck, -iz}, {ix, deck, iz}, {ix, top, iz}, {ix, top, -iz});
  b.quad(wall, {-ix, deck, iz}, {-ix, deck, -iz}, {-ix, top, -iz}, {-ix, top, iz});
  // Coping stones on the parapet, a little wider than it on the outside.
  const float r = 0.08f, cx = x + r, cz = z + r, cap = top + 0.1f;
  b.quad(trim, {-cx, cap, cz}, {cx, cap, cz}, {ix, cap, iz}, {-ix, cap, iz});
  b.quad(trim, {cx, cap, cz}, {cx, cap, -cz}, {ix, cap, -iz}, {ix, cap, iz});
  b.quad(trim, {cx, cap, -cz}, {-cx, cap, -cz}, {-ix, cap, -iz}, {ix, cap, -iz});
  b.quad(trim, {-cx, cap, -cz}, {-cx, cap, cz}, {-ix, cap, iz}, {-ix, cap, -iz});
  b.box(trim, {-cx, top - 0.15f, -cz}, {cx, cap, cz}, kNoTop | kNoBottom);
  b.quad(trim, {ix, top, iz}, {-ix, top, iz}, {-ix, cap, iz}, {ix, cap, iz});
  b.quad(trim, {-ix, top, -iz}, {ix, top, -iz}, {ix, cap, -iz}, {-ix, cap, -iz});
  b.quad(trim, {ix, top, -iz}, {ix, top, iz}, {ix, cap, iz}, {ix, cap, -iz});
  b.quad(trim, {-ix, top, iz}, {-ix, top, -iz}, {-ix, cap, -iz}, {-ix, cap, iz});
  stringCourse(b, trim, plan.width, plan.depth, plan.y - 0.2f, 0.25f, 0.15f);
}

void dormer(MeshBuilder& b, uint32_t wall, uint32_t roof, uint32_t trim, uint32_t glass, vec3 foot, float depth) {
  const float half = 0.75f, height = 1.5f, rise = 0.65f, front = 0.12f, over = 0.15f;
  const float back = foot.z - depth, top = foot.y + height;
  b.box(wall, {foot.x - half, foot.y, back}, {foot.x + half, top, foot.z}, kNoBottom | kNoTop | kNoBack);
  const float z = foot.z + 0.03f;
  b.picture(glass, {foot.x - 0.5f, foot.y + 0.2f, z}, {foot.x + 0.5f, foot.y + 0.2f, z},
            {foot.x + 0.5f, top - 0.05f, z}, {foot.x - 0.5f, top - 0.05f, z});
  const float l = foot.x - half - over, r = foot.x + half + over, f = foot.z + front, ridge = top + rise;
  b.triangle(trim, {l, top, f}, {r, top, f}, {foot.x, ridge, f});
  b.quad(roof, {r, top, f}, {r, top, back}, {foot.x, ridge, back}, {foot.x, ridge, f});
  b.quad(roof, {l, top, back}, {l, top, f}, {foot.x, ridge, f}, {foot.x, ridge, back});
  b.quad(trim, {l, top, back}, {r, top, back}, {r, top, f}, {l, top, f});
}

void chimney(MeshBuilder& b, uint32_t brick, uint32_t trim, vec3 foot, float height, float side) {
  const float h = 0.5f * side;
  b.box(brick, foot + vec3(-h, 0.0f, -h), foot + vec3(h, height, h), kNoBottom | kNoTop);
  b.box(trim, foot + vec3(-h - 0.08f, height - 0.05f, -h - 0.08f), foot + vec3(h + 0.08f, height + 0.12f, h + 0.08f));
}

void awning(MeshBuilder& b, uint32_t canvas, float x0, float x1, float y) {
  const float reach = 1.25f, drop = 0.55f, hem = 0.22f;
  b.quad(canvas, {x0, y - drop, reach}, {x1, y - drop, reach}, {x1, y, 0.0f}, {x0, y, 0.0f});
  b.quad(canvas, {x0, y - drop - hem, reach}, {x1, y - drop - hem, reach}, {x1, y - drop, reach},
         {x0, y - drop, reach});
  b.quad(canvas, {x0, y - hem, 0.0f}, {x1, y - hem, 0.0f}, {x1, y - drop - hem, reach}, {x0, y - drop - hem, reach});
  b.quad(canvas, {x1, y - drop - hem, reach}, {x1, y - hem, 0.0f}, {x1, y, 0.0f}, {x1, y - drop, reach});
  b.quad(canvas, {x0, y - hem, 0.0f}, {x0, y - drop - hem, reach}, {x0, y - drop, reach}, {x0, y, 0.0f});
}

void stringCourse(MeshBuilder& b, uint32_t trim, float width, float depth, float y, float height, float reach) {
  b.box(trim, {-0.5f * width - reach, y, -0.5f * depth - reach},
        {0.5f * width + reach, y + height, 0.5f * depth + reach});
}

void plinth(MeshBuilder& b, uint32_t stone, float width, float depth) {
  const float reach = 0.06f;
  b.box(stone, {-0.5f * width - reach, -kFoundation, -0.5f * depth - reach},
        {0.5f * width + reach, kPlinth, 0.5f * depth + reach}, kNoBottom);
}

}  // namespace helio::scene
