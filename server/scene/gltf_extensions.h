// The extensions of glTF that are read, and the checks of their JSON.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "scene/gltf_checker.h"

namespace helio::scene {

inline constexpr const char* kTextureTransform = "KHR_texture_transform";
inline constexpr const char* kMeshQuantization = "KHR_mesh_quantization";
inline constexpr const char* kGpuInstancing = "EXT_mesh_gpu_instancing";
inline constexpr const char* kLightsPunctual = "KHR_lights_punctual";
inline constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";
inline constexpr const char* kMaterialIor = "KHR_materials_ior";
inline constexpr const char* kMaterialSpecular = "KHR_materials_specular";
inline constexpr const char* kMaterialUnlit = "KHR_materials_unlit";

inline constexpr std::array kSupportedExtensions = {kTextureTransform, kMeshQuantization, kGpuInstancing,
                                                    kLightsPunctual,   kEmissiveStrength, kMaterialIor,
                                                    kMaterialSpecular, kMaterialUnlit};

bool isSupportedExtension(std::string_view name);

/// A texture with its set of coordinates and its transform.
void checkTextureInfo(GltfChecker& checker, const nlohmann::json& owner, const std::string& at, const char* key);
void checkMaterialExtensions(GltfChecker& checker, const nlohmann::json& material, const std::string& at);
/// The document's list of lights.
void checkLights(GltfChecker& checker);
/// Instances and the light of a node; after checkLights().
void checkNodeExtensions(GltfChecker& checker, const nlohmann::json& node, const std::string& at);

}  // namespace helio::scene
