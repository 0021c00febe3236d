// The report's page, embedded at build time from page.html.
#pragma once

#include <string_view>

namespace helio::load {

/// Holds "/*REPORT*/null" where the report's JSON goes.
extern const std::string_view kPage;

}  // namespace helio::load
