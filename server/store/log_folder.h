// The folder that a log lives in.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/result.h"

namespace helio::store {

/// Makes the folder if it is not there, for its owner alone. Errors: it cannot be made or is none (invalid); it lies on
/// a network file system (unsupported): there a sync does not promise what durability needs, nor do locks keep a second
/// server out.
Result<void> prepareLogFolder(const std::filesystem::path& folder);

/// Refuses a network file system (unsupported). `type` is statfs' f_type of the folder.
Result<void> checkFileSystem(const std::string& folder, long type);

/// The name of a network file system by statfs' f_type, if it is one.
std::optional<std::string> networkFileSystem(long type);

}  // namespace helio::store
