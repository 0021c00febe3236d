# Target `bundle`: one folder with the programs, the GPU tests and the shared libraries they need, which runs on another
# x86-64 Linux that has a Vulkan driver and the C and C++ run-time libraries of Debian 12 or newer (glibc 2.36, GCC 12).
set(programs)
foreach(program heliographd helio helio-load helio-bench)
  if(TARGET ${program})
    list(APPEND programs ${program})
  endif()
endforeach()
get_property(gpu_tests GLOBAL PROPERTY HELIOGRAPH_GPU_TESTS)
list(APPEND programs ${gpu_tests})

find_library(VULKAN_LOADER libvulkan.so.1 REQUIRED)
set(files)
foreach(program IN LISTS programs)
  list(APPEND files $<TARGET_FILE:${program}>)
endforeach()
add_custom_target(bundle
  COMMAND ${CMAKE_COMMAND} "-DPROGRAMS=${files}" -DSOURCE=${CMAKE_SOURCE_DIR} -DBUNDLE=${CMAKE_BINARY_DIR}/bundle
    -DVULKAN_LOADER=${VULKAN_LOADER} -DSTRIP=${CMAKE_STRIP} -P ${CMAKE_SOURCE_DIR}/cmake/make_bundle.cmake
  DEPENDS ${programs}
  COMMENT "Bundle ${CMAKE_BINARY_DIR}/bundle"
  VERBATIM)
