# What draws: built as ever where the rest gets HELIOGRAPH_SANITIZE.
set(HELIOGRAPH_RENDERER gpu accel effects render)

# helio_library(scene DEPENDS helio_base ...): the static library helio_scene of server/scene/*.cpp.
function(helio_library name)
  cmake_parse_arguments(arg "" "" "DEPENDS;PRIVATE" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(helio_${name} STATIC ${sources})
  if(HELIOGRAPH_SANITIZE AND name IN_LIST HELIOGRAPH_RENDERER)
    set_target_properties(helio_${name} PROPERTIES COMPILE_OPTIONS "")
  endif()
  target_include_directories(helio_${name} PUBLIC ${CMAKE_SOURCE_DIR}/server)
  target_link_libraries(helio_${name} PUBLIC ${arg_DEPENDS} PRIVATE ${arg_PRIVATE})
  helio_warnings(helio_${name})
endfunction()

# helio_test(scene DEPENDS helio_scene ... [GPU] [COST 200]): the GoogleTest program of the present folder's *.cpp.
# COST seconds, roughly, on two cores: ctest begins with the longest.
function(helio_test name)
  cmake_parse_arguments(arg "GPU" "COST" "DEPENDS" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${arg_DEPENDS} GTest::gtest GTest::gmock GTest::gtest_main)
  helio_warnings(test_${name})
  add_test(NAME ${name} COMMAND test_${name} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(${name} PROPERTIES TIMEOUT 1800)
  if(arg_COST)
    set_tests_properties(${name} PROPERTIES COST ${arg_COST})
  endif()
  if(arg_GPU)
    set_tests_properties(${name} PROPERTIES LABELS gpu)
    set_property(GLOBAL APPEND PROPERTY HELIOGRAPH_GPU_TESTS test_${name})   # they go into the bundle
  endif()
endfunction()

# Left out: -Wmissing-field-initializers (Vulkan's structs start with {sType} and the rest is zero) and what GCC 12 cries wolf
# over: -Wrestrict in std::string's operator+ (GCC bug 105329), -Wmaybe-uninitialized in std::variant.
function(helio_warnings target)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wno-missing-field-initializers $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict -Wno-maybe-uninitialized>)
  if(HELIOGRAPH_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
