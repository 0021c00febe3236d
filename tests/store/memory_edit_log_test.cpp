#include "edit_log_conformance.h"

namespace helio::store {

INSTANTIATE_TEST_SUITE_P(Memory, EditLogConformance, ::testing::Values(Backend{"Memory", makeMemoryEditLog}));

}  // namespace helio::store
