#include "cli/command.h"

#include <google/protobuf/generated_enum_reflection.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numbers>

#include "lib/camera.h"
#include "render/choices.h"
#include "render/light_switches.h"
#include "render/material_override.h"

namespace helio::cli {
namespace {

/// "rays_and_map" is SUN_SHADOW_RAYS_AND_MAP. What the wire has no value for is what it leaves unspecified.
template <typename Wire>
Wire onWire(const std::string& prefix, std::string name) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::toupper(c); });
  const auto* value = google::protobuf::GetEnumDescriptor<Wire>()->FindValueByName(prefix + name);
  return static_cast<Wire>(value ? value->number() : 0);
}

}  // namespace

Size parseSize(const std::string& text) {
  Size size;
  char more;
  if (std::sscanf(text.c_str(), "%ux%u%c", &size.width, &size.height, &more) != 2)
    throw Stop{"--size is \"" + text + "\"; give WIDTHxHEIGHT in pixels, such as 640x360"};
  return size;
}

v1::PrimaryHits parsePrimary(const std::string& text) { return onWire<v1::PrimaryHits>("PRIMARY_HITS_", text); }

v1::RenderMode parseMode(const std::string& text) { return onWire<v1::RenderMode>("RENDER_MODE_", text); }

void addMaterials(CLI::App& command, std::string& materials) {
  command
      .add_option("--materials", materials,
                  "in the place of all materials: lambert, white; or shown as it is, without light: albedo, "
                  "roughness_metallic, emission, normals, geometric_normals, texture_coordinates, instances, materials")
      ->capture_default_str()
      ->check(CLI::IsMember(render::materialOverrideNames()))
      ->option_text("NAME");
}

v1::MaterialOverride parseMaterials(const std::string& text) {
  return static_cast<v1::MaterialOverride>(*render::materialOverride(text));
}

void addLightTransport(CLI::App& command, v1::LightTransport& light) {
  for (const render::LightSwitch& each : render::kLightSwitches) {
    std::string flag = each.name;
    std::replace(flag.begin(), flag.end(), '_', '-');
    const std::string off = "--no-" + flag;
    std::string names = "--" + flag;
    names.append(",!").append(off);
    const auto* field = v1::LightTransport::descriptor()->FindFieldByName(each.name);
    const bool usual = render::ViewSettings{}.*each.field;
    command
        .add_flag_function(
            names, [&light, field](int64_t count) { light.GetReflection()->SetBool(&light, field, count > 0); },
            each.description + (usual ? " (unless " + off + ")" : std::string()))
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  }
  command
      .add_option_function<float>(
          "--regularisation", [&light](float roughness) { light.set_regularisation(roughness); },
          "least roughness behind a rough scattering, 0 to 1: less noise, some bias; hybrid mode only")
      ->check(CLI::Range(0.0f, 1.0f));
  command
      .add_option_function<uint32_t>(
          "--lamp-samples", [&light](uint32_t lamps) { light.set_lamp_samples(lamps); },
          "lamps that the first vertex of a path samples, 0 to 64; 0: each once")
      ->check(CLI::Range(0u, 64u));
}

void addApproximations(CLI::App& command, Approximations& chosen) {
  const auto choice = [&](const char* flag, std::string& name, const char* description,
                          const std::vector<std::string>& names) {
    command.add_option(flag, name, description)->capture_default_str()->check(CLI::IsMember(names));
  };
  choice("--sun-shadow", chosen.sun_shadow, "hybrid mode: the sun's shadows by rays, map, or rays_and_map",
         render::namesOf(render::kSunShadows));
  command.add_option("--shadow-map-size", chosen.shadow_map_size, "texels along a side of a cascade, 256 to 4096")
      ->capture_default_str()
      ->check(CLI::Range(256u, 4096u));
  command.add_flag("--levels-of-detail,!--no-levels-of-detail", chosen.levels_of_detail,
                   "hybrid mode: far meshes are coarser by about a pixel (unless --no-levels-of-detail)");
  choice("--technique", chosen.technique, "hybrid mode: path_traced, distributed or whitted",
         render::namesOf(render::kTechniques));
  choice("--ambient", chosen.ambient,
         "with distributed or whitted, for indirect light: none, constant, or occluded (distributed alone)",
         render::namesOf(render::kAmbients));
  const auto number = [&](const char* flag, float& value, const char* description, float low, float high) {
    command.add_option(flag, value, description)->capture_default_str()->check(CLI::Range(low, high));
  };
  number("--ambient-radius", chosen.ambient_radius, "metres within which occluders count", 1e-6f, 1e6f);
  choice("--indirect-rate", chosen.indirect_rate, "hybrid mode: pixels that follow indirect light: full, half, quarter",
         render::namesOf(render::kIndirectRates));
  choice("--reconstruction", chosen.reconstruction, "what the others do: reuse or bilateral",
         render::namesOf(render::kReconstructions));
  number("--aperture", chosen.aperture, "metres of the lens' diameter; needs --primary traced or --mode reference",
         0.0f, 10.0f);
  number("--focus", chosen.focus, "metres to what is sharp", 0.01f, 1e6f);
  choice("--denoiser", chosen.denoiser, "hybrid mode: none, svgf, asvgf or reblur",
         render::namesOf(render::kDenoisers));
  command.add_flag("--taa", chosen.taa, "hybrid mode: temporal anti-aliasing");
  number("--extra-samples", chosen.extra_samples,
         "paths a pixel more, in the mean, where light is young and noisy; needs a denoiser", 0.0f, 4.0f);
  choice("--inspect", chosen.inspect,
         "hybrid mode: numbers in the picture's place: motion, position, before, unfiltered; with a denoiser diffuse, "
         "specular, samples",
         render::namesOf(render::kInspects));
  choice("--culling-view", chosen.culling_view,
         "hybrid mode: light path guided culling in the picture's place: states, hitboxes, untraced, rays, above",
         render::namesOf(render::kCullingViews));
}

v1::Approximations Approximations::toWire() const {
  v1::Approximations out;
  out.set_sun_shadow(onWire<v1::SunShadow>("SUN_SHADOW_", sun_shadow));
  out.set_shadow_map_size(shadow_map_size);
  out.set_levels_of_detail(levels_of_detail);
  out.set_taa(taa);
  out.set_extra_samples(extra_samples);
  out.set_denoiser(onWire<v1::Denoiser>("DENOISER_", denoiser));
  out.set_technique(onWire<v1::Technique>("TECHNIQUE_", technique));
  out.set_ambient(onWire<v1::Ambient>("AMBIENT_", ambient));
  out.set_ambient_radius(ambient_radius);
  out.set_indirect_rate(onWire<v1::IndirectRate>("INDIRECT_RATE_", indirect_rate));
  out.set_reconstruction(onWire<v1::Reconstruction>("RECONSTRUCTION_", reconstruction));
  return out;
}

v1::Inspect Approximations::inspectOnWire() const { return onWire<v1::Inspect>("INSPECT_", inspect); }

v1::Lens Approximations::lensOnWire() const {
  v1::Lens lens;
  lens.set_aperture(aperture);
  lens.set_focus(focus);
  return lens;
}

v1::CullingView Approximations::cullingViewOnWire() const {
  return onWire<v1::CullingView>("CULLING_VIEW_", culling_view);
}

void Approximations::put(render::ViewSettings& settings) const {
  settings.sun_shadow = *render::byName(render::kSunShadows, sun_shadow);
  settings.shadow_map_size = shadow_map_size;
  settings.levels_of_detail = levels_of_detail;
  settings.taa = taa;
  settings.extra_samples = extra_samples;
  settings.denoiser = *render::byName(render::kDenoisers, denoiser);
  settings.technique = *render::byName(render::kTechniques, technique);
  settings.ambient = *render::byName(render::kAmbients, ambient);
  settings.ambient_radius = ambient_radius;
  settings.indirect_rate = *render::byName(render::kIndirectRates, indirect_rate);
  settings.reconstruction = *render::byName(render::kReconstructions, reconstruction);
  settings.aperture = aperture;
  settings.focus = focus;
  settings.inspect = *render::byName(render::kInspects, inspect);
  settings.culling_view = *render::byName(render::kCullingViews, culling_view);
}

void print(const Json& document) { std::cout << document.dump(2) << "\n"; }

void writeFile(const std::string& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) throw Stop{"cannot write " + path + "; does its folder exist, and is there space?"};
}

v1::Camera Viewpoint::toWire() const {
  const glm::vec3 from(position[0], position[1], position[2]), to(target[0], target[1], target[2]);
  return client::toWire(client::lookAt(from, to, static_cast<float>(radians(vfov))));
}

double radians(double degrees) { return degrees * std::numbers::pi / 180.0; }

std::string usualServer() {
  const auto newest = client::CredentialStore().newestServer();
  return newest && !newest->empty() ? *newest : "127.0.0.1:7700";
}

void addCommon(CLI::App& command, Common& common, bool json) {
  command
      .add_option("--server", common.server, "host:port of the server; the usual one is that of the last helio login")
      ->envname("HELIOGRAPH_SERVER")
      ->capture_default_str();
  if (json) command.add_flag("--json", common.json, "print one JSON document with a schema field");
}

}  // namespace helio::cli
