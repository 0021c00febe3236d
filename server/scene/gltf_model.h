// The file as tinygltf's structures, after every reference, size and range that its JSON names was found sound.
#pragma once

#include <filesystem>

#include "base/result.h"

// One configuration for all who include it: images are left encoded, gltf_image.h decodes them.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE
#define TINYGLTF_NO_INCLUDE_STB_IMAGE_WRITE
#include <tiny_gltf.h>

namespace helio::scene {

/// Reads a .gltf or .glb file and what it refers to. Only files in the file's own folder or below are opened, whatever
/// URIs and symbolic links say. Images hold their encoded bytes, or none when they could not be read. Indices into the
/// model's arrays need no further check; accessors do. Errors (invalid, unsupported) without the file's name.
Result<tinygltf::Model> loadModel(const std::filesystem::path& file);

}  // namespace helio::scene
