#include "scene/palette.h"

#include "scene/textures.h"

namespace helio::scene {
namespace {

using glm::vec3;

/// A painted surface pattern: where its textures are in the palette.
struct Painted {
  uint32_t base_color = kNone;
  uint32_t normals = kNone;
  glm::vec2 metres{1.0f};
};

class PaletteBuilder {
 public:
  explicit PaletteBuilder(Palette& palette) : palette_(palette) {}

  uint32_t texture(Texture texture) {
    palette_.textures.push_back(std::move(texture));
    return static_cast<uint32_t>(palette_.textures.size() - 1);
  }
  Painted flat(const SurfacePattern& surface) { return {texture(paintBaseColor(surface)), kNone, surface.metres}; }
  Painted relief(const SurfacePattern& surface) {
    Painted painted = flat(surface);
    painted.normals = texture(paintNormals(surface));
    return painted;
  }

  /// `tint` multiplies the texture: linear, [0, 1].
  uint32_t material(std::string name, const Painted& painted, vec3 tint, float roughness) {
    Material& m = palette_.materials.emplace_back();
    m.name = std::move(name);
    m.base_color = glm::vec4(tint, 1.0f);
    m.roughness = roughness;
    m.base_color_texture = painted.base_color;
    m.normal_texture = painted.normals;
    palette_.metres.push_back(painted.metres);
    return static_cast<uint32_t>(palette_.materials.size() - 1);
  }
  uint32_t plain(std::string name, vec3 albedo, float roughness) {
    return material(std::move(name), Painted{}, albedo, roughness);
  }
  Material& operator[](uint32_t index) { return palette_.materials[index]; }

 private:
  Palette& palette_;
};

void addWallsAndRoofs(Palette& p, PaletteBuilder& make) {
  const Painted plaster = make.relief(patterns::plaster());
  p.plaster = {make.material("plaster_white", plaster, {0.80f, 0.78f, 0.72f}, 0.9f),
               make.material("plaster_cream", plaster, {0.79f, 0.68f, 0.48f}, 0.9f),
               make.material("plaster_ochre", plaster, {0.72f, 0.49f, 0.22f}, 0.9f),
               make.material("plaster_rose", plaster, {0.70f, 0.42f, 0.34f}, 0.9f),
               make.material("plaster_terracotta", plaster, {0.58f, 0.26f, 0.15f}, 0.9f),
               make.material("plaster_sage", plaster, {0.44f, 0.53f, 0.38f}, 0.9f),
               make.material("plaster_blue", plaster, {0.36f, 0.48f, 0.58f}, 0.9f),
               make.material("plaster_grey", plaster, {0.55f, 0.54f, 0.52f}, 0.9f)};
  const Painted brick = make.relief(patterns::brick());
  p.brick = {make.material("brick_red", brick, {0.95f, 0.82f, 0.80f}, 0.85f),
             make.material("brick_brown", brick, {0.66f, 0.58f, 0.52f}, 0.85f),
             make.material("brick_yellow", brick, {1.0f, 1.0f, 0.82f}, 0.85f)};
  const Painted timber = make.relief(patterns::timberFrame());
  p.timber_frame = {make.material("timber_frame_white", timber, {1.0f, 1.0f, 1.0f}, 0.9f),
                    make.material("timber_frame_yellow", timber, {1.0f, 0.84f, 0.56f}, 0.9f),
                    make.material("timber_frame_red", timber, {0.90f, 0.60f, 0.48f}, 0.9f)};
  const Painted ashlar = make.relief(patterns::ashlar());
  p.ashlar = {make.material("ashlar", ashlar, {1.0f, 0.97f, 0.92f}, 0.85f),
              make.material("ashlar_grey", ashlar, {0.70f, 0.72f, 0.76f}, 0.85f)};
  const Painted tiles = make.relief(patterns::roofTiles());
  p.roof_tiles = {make.material("roof_tiles_red", tiles, {0.92f, 0.80f, 0.76f}, 0.8f),
                  make.material("roof_tiles_orange", tiles, {1.0f, 1.0f, 0.92f}, 0.8f),
                  make.material("roof_tiles_brown", tiles, {0.58f, 0.66f, 0.70f}, 0.8f),
                  make.material("roof_tiles_dark", tiles, {0.34f, 0.56f, 0.74f}, 0.8f),
                  make.material("roof_tiles_old", tiles, {0.80f, 0.98f, 1.0f}, 0.85f)};
  const Painted slate = make.relief(patterns::slate());
  p.slate = {make.material("slate", slate, {0.9f, 0.95f, 1.0f}, 0.7f),
             make.material("slate_warm", slate, {1.0f, 0.86f, 0.78f}, 0.7f)};
  const Painted planks = make.relief(patterns::planks());
  p.planks = {make.material("planks", planks, {1.0f, 0.95f, 0.88f}, 0.85f),
              make.material("planks_dark", planks, {0.42f, 0.36f, 0.32f}, 0.85f),
              make.material("planks_red", planks, {0.70f, 0.22f, 0.16f}, 0.85f),
              make.material("planks_weathered", planks, {0.78f, 0.92f, 1.0f}, 0.9f)};
  const Painted door = make.flat(patterns::door());
  p.door = {make.material("door_green", door, {0.20f, 0.42f, 0.28f}, 0.7f),
            make.material("door_blue", door, {0.22f, 0.36f, 0.60f}, 0.7f),
            make.material("door_red", door, {0.60f, 0.16f, 0.12f}, 0.7f),
            make.material("door_brown", door, {0.48f, 0.28f, 0.16f}, 0.7f)};
  p.trim = {make.plain("trim_white", {0.74f, 0.72f, 0.67f}, 0.8f),
            make.plain("trim_sandstone", {0.54f, 0.45f, 0.33f}, 0.85f),
            make.plain("trim_dark", {0.09f, 0.07f, 0.06f}, 0.75f)};
  const SurfacePattern window = patterns::window();
  p.window = make.material("window", make.flat(window), vec3(1.0f), 1.0f);
  make[p.window].metallic_roughness_texture = make.texture(paintRoughness(window));
  p.lit_window =
      make.material("window_lit", {make[p.window].base_color_texture, kNone, window.metres}, vec3(1.0f), 0.4f);
  make[p.lit_window].emission = {1.7f, 1.2f, 0.62f};
  make[p.lit_window].emissive_texture = make.texture(paintBaseColor(patterns::litWindow()));
  p.copper = make.plain("copper_green", {0.20f, 0.42f, 0.34f}, 0.7f);
  p.iron = make.plain("iron", {0.06f, 0.065f, 0.07f}, 0.6f);
  p.gold = make.plain("gold", {0.95f, 0.70f, 0.30f}, 0.3f);
  make[p.gold].metallic = 1.0f;
  p.mirror = make.plain("mirror_glass", {0.86f, 0.90f, 0.93f}, 0.0f);
  make[p.mirror].metallic = 1.0f;
}

void addGround(Palette& p, PaletteBuilder& make) {
  const Painted grass = make.relief(patterns::grass());
  p.lawn = {make.material("lawn", grass, {0.82f, 0.95f, 0.72f}, 0.95f),
            make.material("lawn_dry", grass, {1.0f, 0.95f, 0.80f}, 0.95f),
            make.material("lawn_deep", grass, {0.62f, 0.85f, 0.60f}, 0.95f)};
  p.meadow = {make.material("meadow", grass, {1.0f, 1.0f, 0.78f}, 0.95f),
              make.material("meadow_green", grass, {0.78f, 0.90f, 0.66f}, 0.95f),
              make.material("meadow_pale", grass, {1.0f, 0.92f, 0.86f}, 0.95f)};
  p.hill = make.material("hill", grass, {0.80f, 0.88f, 0.70f}, 0.95f);
  p.hill_woods = make.material("hill_woods", make.relief(patterns::canopy()), vec3(1.0f), 0.95f);
  p.crops = {make.material("soil", make.relief(patterns::soilRows()), vec3(1.0f), 0.95f),
             make.material("crop", make.relief(patterns::cropRows()), vec3(1.0f), 0.95f),
             make.material("wheat", make.relief(patterns::wheat()), {0.92f, 0.90f, 0.84f}, 0.95f)};
  p.forest_floor = make.material("forest_floor", make.relief(patterns::forestFloor()), vec3(1.0f), 0.95f);
  p.asphalt = make.material("asphalt", make.relief(patterns::asphalt()), vec3(1.0f), 0.85f);
  const Painted cobbles = make.relief(patterns::cobbles());
  p.cobbles = make.material("cobbles", cobbles, {0.80f, 0.78f, 0.76f}, 0.8f);
  p.courtyard = make.material("courtyard", cobbles, {0.92f, 0.84f, 0.72f}, 0.85f);
  const Painted slabs = make.relief(patterns::slabs());
  p.slabs = make.material("pavement", slabs, {0.86f, 0.86f, 0.86f}, 0.85f);
  p.market = make.material("market_paving", slabs, {1.0f, 0.90f, 0.74f}, 0.8f);
  p.kerb = make.plain("kerb", {0.36f, 0.35f, 0.33f}, 0.85f);
  const Painted gravel = make.relief(patterns::gravel());
  p.gravel = make.material("gravel", gravel, vec3(1.0f), 0.95f);
  p.dirt = make.material("dirt", gravel, {0.70f, 0.62f, 0.54f}, 0.95f);
  p.flat_roof = make.material("roof_gravel", gravel, {0.62f, 0.68f, 0.76f}, 0.95f);
}

void addNatureAndProps(Palette& p, PaletteBuilder& make) {
  const Painted foliage = make.relief(patterns::foliage());
  p.foliage = {make.material("foliage_oak", foliage, {0.78f, 0.86f, 0.62f}, 0.9f),
               make.material("foliage_linden", foliage, {0.92f, 1.0f, 0.66f}, 0.9f),
               make.material("foliage_birch", foliage, {1.0f, 1.0f, 0.62f}, 0.9f),
               make.material("foliage_maple", foliage, {1.0f, 0.56f, 0.26f}, 0.9f),
               make.material("foliage_apple", foliage, {0.80f, 1.0f, 0.72f}, 0.9f),
               make.material("foliage_hedge", foliage, {0.58f, 0.72f, 0.50f}, 0.9f),
               make.material("foliage_copper_beech", foliage, {0.62f, 0.40f, 0.46f}, 0.9f)};
  const Painted needles = make.relief(patterns::needles());
  p.needles = {make.material("needles_spruce", needles, {0.85f, 1.0f, 0.90f}, 0.9f),
               make.material("needles_fir", needles, {0.75f, 0.92f, 0.95f}, 0.9f),
               make.material("needles_pine", needles, {1.0f, 1.0f, 0.72f}, 0.9f)};
  const Painted bark = make.relief(patterns::bark());
  p.bark = {make.material("bark", bark, {0.85f, 0.80f, 0.75f}, 0.95f),
            make.plain("bark_birch", {0.62f, 0.60f, 0.56f}, 0.9f)};
  const Painted stripes = make.flat(patterns::stripes());
  p.stripes = {make.material("stripes_red", stripes, {0.80f, 0.20f, 0.14f}, 0.9f),
               make.material("stripes_green", stripes, {0.22f, 0.50f, 0.26f}, 0.9f),
               make.material("stripes_blue", stripes, {0.20f, 0.36f, 0.62f}, 0.9f),
               make.material("stripes_yellow", stripes, {0.85f, 0.62f, 0.16f}, 0.9f)};
  p.water = make.plain("water", {0.05f, 0.10f, 0.11f}, 0.05f);
  p.lamp_light = make.plain("lamp_light", vec3(0.8f), 0.6f);
  make[p.lamp_light].emission = {64.0f, 46.0f, 25.0f};
  p.straw = make.plain("straw", {0.62f, 0.46f, 0.18f}, 0.95f);
  p.fruit_red = make.plain("fruit_red", {0.55f, 0.07f, 0.05f}, 0.6f);
  p.fruit_orange = make.plain("fruit_orange", {0.75f, 0.32f, 0.05f}, 0.6f);
  p.cloth = make.plain("cloth", {0.66f, 0.60f, 0.48f}, 0.95f);
  p.flowers = make.plain("flowers", {0.62f, 0.10f, 0.22f}, 0.8f);
}

void addPeopleAndVehicles(Palette& p, PaletteBuilder& make) {
  const std::array<glm::vec3, 10> garments{{{0.10f, 0.14f, 0.28f},
                                            {0.52f, 0.10f, 0.09f},
                                            {0.16f, 0.11f, 0.07f},
                                            {0.68f, 0.64f, 0.55f},
                                            {0.12f, 0.26f, 0.14f},
                                            {0.07f, 0.07f, 0.08f},
                                            {0.58f, 0.34f, 0.07f},
                                            {0.24f, 0.20f, 0.17f},
                                            {0.36f, 0.12f, 0.30f},
                                            {0.18f, 0.34f, 0.42f}}};
  for (size_t i = 0; i < garments.size(); ++i)
    p.garment[i] = make.plain("garment_" + std::to_string(i), garments[i], 0.9f);
  p.complexion = {make.plain("skin_0", {0.66f, 0.42f, 0.32f}, 0.6f), make.plain("skin_1", {0.72f, 0.50f, 0.40f}, 0.6f),
                  make.plain("skin_2", {0.42f, 0.25f, 0.16f}, 0.6f), make.plain("skin_3", {0.20f, 0.11f, 0.07f}, 0.6f)};
  p.hair = {make.plain("hair_dark", {0.035f, 0.025f, 0.02f}, 0.7f),
            make.plain("hair_brown", {0.13f, 0.07f, 0.035f}, 0.7f),
            make.plain("hair_fair", {0.45f, 0.30f, 0.13f}, 0.7f), make.plain("hair_grey", {0.42f, 0.41f, 0.40f}, 0.7f)};
  p.paint = {
      make.plain("paint_red", {0.42f, 0.035f, 0.03f}, 0.25f), make.plain("paint_blue", {0.05f, 0.12f, 0.32f}, 0.25f),
      make.plain("paint_cream", {0.62f, 0.56f, 0.42f}, 0.25f), make.plain("paint_green", {0.05f, 0.20f, 0.12f}, 0.3f),
      make.plain("paint_grey", {0.22f, 0.23f, 0.25f}, 0.35f)};
  p.leather = make.plain("leather", {0.07f, 0.04f, 0.025f}, 0.55f);
  p.tyre = make.plain("tyre", {0.02f, 0.02f, 0.022f}, 0.9f);
  p.pane = make.plain("pane", {0.03f, 0.04f, 0.05f}, 0.12f);
}

}  // namespace

Palette makePalette() {
  Palette palette;
  PaletteBuilder make(palette);
  addWallsAndRoofs(palette, make);
  addGround(palette, make);
  addNatureAndProps(palette, make);
  addPeopleAndVehicles(palette, make);
  return palette;
}

}  // namespace helio::scene
