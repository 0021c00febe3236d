# helio_shaders(helio_shader_binaries NAMESPACE helio::shaders INCLUDE dir ...): the static library that holds the SPIR-V of
# every shader below the present folder. Each is compiled and checked at build time and embedded: a run needs no compiler and
# no file beside the binary. `embedded.h` of that folder declares NAMESPACE::find(), which knows a module by its path there.
function(helio_shaders target)
  cmake_parse_arguments(arg "" "NAMESPACE" "INCLUDE" ${ARGN})
  file(GLOB_RECURSE shaders CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR}
    *.rgen *.rchit *.rahit *.rmiss *.rint *.comp *.vert *.frag)
  list(SORT shaders)
  list(TRANSFORM arg_INCLUDE PREPEND -I)

  set(modules)   # the .spv files
  set(pull)      # assembly that pulls each of them into .rodata
  set(declare)   # ... and the C++ names of its begin and end
  set(table)     # ... and the rows of the look-up table, in the order of std::string_view's <
  set(index 0)
  foreach(shader IN LISTS shaders)
    set(source ${CMAKE_CURRENT_SOURCE_DIR}/${shader})
    set(module ${CMAKE_CURRENT_BINARY_DIR}/${shader}.spv)
    set(symbol ${target}_${index})
    get_filename_component(folder ${module} DIRECTORY)
    file(MAKE_DIRECTORY ${folder})
    # glslang reports an error on standard output, spirv-val on standard error; Ninja shows both.
    add_custom_command(
      OUTPUT ${module}
      COMMAND ${GLSLANG} --quiet --target-env vulkan1.3 ${arg_INCLUDE} $<$<CONFIG:Debug>:-g>
        --depfile ${module}.d -o ${module} ${source}
      COMMAND ${SPIRV_VAL} --target-env vulkan1.3 --scalar-block-layout ${module}
      DEPENDS ${source}
      DEPFILE ${module}.d
      COMMENT "Shader ${shader}"
      VERBATIM COMMAND_EXPAND_LISTS)
    list(APPEND modules ${module})
    string(APPEND pull "    \".balign 4\\n${symbol}: .incbin \\\"${module}\\\"\\n${symbol}_end:\\n\"\n")
    string(APPEND declare "extern const std::uint32_t ${symbol}[], ${symbol}_end[];\n")
    string(APPEND table "    {\"${shader}\", ${symbol}, ${symbol}_end},\n")
    math(EXPR index "${index} + 1")
  endforeach()
  set(header ${CMAKE_CURRENT_SOURCE_DIR}/embedded.h)
  set(namespace ${arg_NAMESPACE})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/embedded.cpp.in embedded.cpp @ONLY)
  set_source_files_properties(${CMAKE_CURRENT_BINARY_DIR}/embedded.cpp PROPERTIES OBJECT_DEPENDS "${modules}")

  add_library(${target} STATIC ${CMAKE_CURRENT_BINARY_DIR}/embedded.cpp)
  helio_warnings(${target})
endfunction()
