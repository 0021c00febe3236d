// What a viewer may choose, on the wire and in the renderer.
#include <google/protobuf/generated_enum_reflection.h>

#include <functional>
#include <set>

#include "fixture.h"
#include "render/choices.h"
#include "service/convert.h"

namespace helio::test {
namespace {

TEST_F(ServiceTest, ApproximationsAreSettingsLikeOthers) {
  makeWorld("city");
  Viewer usual(*viewers_, "city", 64, 32);
  const v1::Approximations defaults = usual.welcome().settings().settings().approximations();
  EXPECT_EQ(defaults.sun_shadow(), v1::SUN_SHADOW_RAYS);
  EXPECT_EQ(defaults.shadow_map_size(), 2048u);
  EXPECT_TRUE(defaults.levels_of_detail());
  EXPECT_EQ(defaults.denoiser(), v1::DENOISER_NONE);
  usual.cancel();
  eventually([&] { return renderer_.views() == 0; }, "nobody else looks");
  Viewer viewer(*viewers_, "city", 64, 32, [](v1::Hello& hello) {
    auto& wanted = *hello.mutable_settings()->mutable_approximations();
    wanted.set_sun_shadow(v1::SUN_SHADOW_RAYS_AND_MAP);
    wanted.set_shadow_map_size(512);
    wanted.set_levels_of_detail(false);
    wanted.set_denoiser(v1::DENOISER_SVGF);
    wanted.set_taa(true);
    wanted.set_extra_samples(0.5f);
    hello.mutable_settings()->set_inspect(v1::INSPECT_DIFFUSE);
  });
  const v1::Settings in_effect = viewer.welcome().settings().settings();
  EXPECT_EQ(in_effect.approximations().sun_shadow(), v1::SUN_SHADOW_RAYS_AND_MAP);
  EXPECT_EQ(in_effect.approximations().shadow_map_size(), 512u);
  EXPECT_FALSE(in_effect.approximations().levels_of_detail());
  EXPECT_EQ(in_effect.approximations().denoiser(), v1::DENOISER_SVGF);
  EXPECT_TRUE(in_effect.approximations().taa());
  EXPECT_EQ(in_effect.approximations().extra_samples(), 0.5f);
  EXPECT_EQ(in_effect.inspect(), v1::INSPECT_DIFFUSE);
  viewer.frame();
  const render::ViewSettings rendered = renderer_.newestSettings();
  EXPECT_EQ(rendered.sun_shadow, render::SunShadow::rays_and_map);
  EXPECT_EQ(rendered.shadow_map_size, 512u);
  EXPECT_FALSE(rendered.levels_of_detail);
  EXPECT_EQ(rendered.denoiser, render::Denoiser::svgf);
  EXPECT_TRUE(rendered.taa);
  EXPECT_EQ(rendered.extra_samples, 0.5f);
  EXPECT_EQ(rendered.inspect, render::Inspect::diffuse);
}

/// Every choice of the renderer has a number on the wire, and every number of the wire is a choice.
template <typename Wire, typename Value, size_t N>
void expectOnWire(const render::Choice<Value> (&choices)[N], const std::function<void(v1::Settings&, Wire)>& put,
                  Value render::ViewSettings::*field, Wire (*get)(const v1::Settings&)) {
  const auto& wire = *google::protobuf::GetEnumDescriptor<Wire>();
  std::set<Value> reached;
  for (int i = 0; i < wire.value_count(); ++i) {
    SCOPED_TRACE(wire.value(i)->name());
    v1::Settings settings;
    settings.set_width(64);
    settings.set_height(32);
    settings.mutable_approximations()->set_denoiser(v1::DENOISER_SVGF);  // without which some cannot be inspected
    const auto number = static_cast<Wire>(wire.value(i)->number());
    put(settings, number);
    const auto taken = service::fromWire(settings, service::Limits{});
    ASSERT_TRUE(taken) << taken.error().error.message;
    reached.insert(taken->view.*field);
    if (number != 0) { EXPECT_EQ(get(service::toWire(*taken)), number) << "what is in effect is said"; }
  }
  for (const auto& choice : choices)
    EXPECT_EQ(reached.count(choice.value), 1u) << choice.name << " cannot be asked for";
}

TEST(SettingsOnTheWire, HaveEveryChoiceOfTheRenderer) {
  using V = render::ViewSettings;
  using S = v1::Settings;
  expectOnWire<v1::RenderMode>(render::kModes, &S::set_mode, &V::mode, [](const S& s) { return s.mode(); });
  expectOnWire<v1::PrimaryHits>(render::kPrimaries, &S::set_primary, &V::primary,
                                [](const S& s) { return s.primary(); });
  expectOnWire<v1::SunShadow>(
      render::kSunShadows, [](S& s, v1::SunShadow value) { s.mutable_approximations()->set_sun_shadow(value); },
      &V::sun_shadow, [](const S& s) { return s.approximations().sun_shadow(); });
  expectOnWire<v1::Denoiser>(
      render::kDenoisers, [](S& s, v1::Denoiser value) { s.mutable_approximations()->set_denoiser(value); },
      &V::denoiser, [](const S& s) { return s.approximations().denoiser(); });
  const auto alone = [](S& s) -> v1::Approximations& {
    s.mutable_approximations()->set_denoiser(v1::DENOISER_NONE);
    return *s.mutable_approximations();
  };
  expectOnWire<v1::Technique>(
      render::kTechniques, [&](S& s, v1::Technique value) { alone(s).set_technique(value); }, &V::technique,
      [](const S& s) { return s.approximations().technique(); });
  expectOnWire<v1::Ambient>(
      render::kAmbients,
      [&](S& s, v1::Ambient value) {
        alone(s).set_technique(v1::TECHNIQUE_DISTRIBUTED);
        alone(s).set_ambient(value);
      },
      &V::ambient, [](const S& s) { return s.approximations().ambient(); });
  expectOnWire<v1::IndirectRate>(
      render::kIndirectRates, [&](S& s, v1::IndirectRate value) { alone(s).set_indirect_rate(value); },
      &V::indirect_rate, [](const S& s) { return s.approximations().indirect_rate(); });
  expectOnWire<v1::Reconstruction>(
      render::kReconstructions, [&](S& s, v1::Reconstruction value) { alone(s).set_reconstruction(value); },
      &V::reconstruction, [](const S& s) { return s.approximations().reconstruction(); });
  expectOnWire<v1::CullingView>(render::kCullingViews, &S::set_culling_view, &V::culling_view,
                                [](const S& s) { return s.culling_view(); });
  expectOnWire<v1::Inspect>(render::kInspects, &S::set_inspect, &V::inspect, [](const S& s) { return s.inspect(); });
}

TEST(SettingsOnTheWire, HaveTheLens) {
  v1::Settings settings;
  settings.set_width(64);
  settings.set_height(32);
  settings.set_primary(v1::PRIMARY_HITS_TRACED);
  EXPECT_EQ(service::toWire(*service::fromWire(settings, service::Limits{})).lens().focus(), 10.0f);
  settings.mutable_lens()->set_aperture(0.25f);
  settings.mutable_lens()->set_focus(3.0f);
  settings.mutable_approximations()->set_ambient_radius(2.0f);
  settings.mutable_light_transport()->set_light_feedback(true);
  const auto taken = service::fromWire(settings, service::Limits{});
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->view.aperture, 0.25f);
  EXPECT_EQ(taken->view.focus, 3.0f);
  EXPECT_EQ(taken->view.ambient_radius, 2.0f);
  EXPECT_TRUE(taken->view.light_feedback);
  const v1::Settings in_effect = service::toWire(*taken);
  EXPECT_EQ(in_effect.lens().aperture(), 0.25f);
  EXPECT_EQ(in_effect.approximations().ambient_radius(), 2.0f);
  EXPECT_TRUE(in_effect.light_transport().light_feedback());
}

TEST(SettingsOnTheWire, GoalsAreReachedByPathTracing) {
  v1::Settings settings;
  settings.set_width(64);
  settings.set_height(32);
  settings.mutable_goal()->set_max_frame_ms(20.0f);
  EXPECT_TRUE(service::fromWire(settings, service::Limits{}));
  settings.mutable_approximations()->set_technique(v1::TECHNIQUE_WHITTED);
  EXPECT_FALSE(service::fromWire(settings, service::Limits{}));
  settings.mutable_approximations()->set_technique(v1::TECHNIQUE_PATH_TRACED);
  settings.mutable_approximations()->set_indirect_rate(v1::INDIRECT_RATE_HALF);
  EXPECT_FALSE(service::fromWire(settings, service::Limits{}));
}

}  // namespace
}  // namespace helio::test
