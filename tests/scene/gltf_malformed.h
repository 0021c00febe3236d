// One way in which a file can be wrong, and what must be said about it.
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/gltf.h"
#include "support/gltf_builder.h"

namespace helio::scene {

struct Malformed {
  std::string name;
  std::function<void(GltfBuilder&)> damage;
  ErrorKind kind;
  std::string message;  ///< a part of it
};

inline std::ostream& operator<<(std::ostream& out, const Malformed& malformed) { return out << malformed.name; }

/// Applies the damage to a sound file: loading it gives the error that names what is wrong, in one line.
inline void expectRefused(const Malformed& malformed) {
  const TempFolder folder;
  GltfBuilder builder;
  malformed.damage(builder);
  std::filesystem::path file = builder.save(folder);
  if (malformed.name == "JsonNumberOverflows") {  // what a JSON library cannot write
    std::string text = builder.document.dump();
    text.replace(text.find("\"PLACEHOLDER\""), 13, "1e999");
    file = folder.write("model.gltf", text);
  }
  const Result<ScenePtr> scene = loadGltf(file);
  ASSERT_FALSE(scene.ok());
  EXPECT_EQ(scene.error().kind, malformed.kind) << scene.error().message;
  EXPECT_THAT(scene.error().message, ::testing::HasSubstr(malformed.message));
  EXPECT_THAT(scene.error().message, ::testing::HasSubstr(file.string()));
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
  EXPECT_FALSE(scene.error().field.empty());
}

}  // namespace helio::scene
