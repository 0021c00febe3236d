# Run by target `bundle`: PROGRAMS and what they need go into BUNDLE/{bin,lib,scenes,tests}, stripped.
file(REMOVE_RECURSE ${BUNDLE})
file(MAKE_DIRECTORY ${BUNDLE}/bin ${BUNDLE}/lib)
file(COPY ${PROGRAMS} DESTINATION ${BUNDLE}/bin)

# Left to the other machine: glibc, which belongs to its kernel and driver, and the C++ run-time library, which must not
# be older than the one that a driver written in C++ was linked with.
set(from_the_machine
  [[^ld-linux]] [[^lib(c|m|dl|rt|pthread|resolv|util|anl)\.so]] [[^libstdc\+\+\.so]] [[^libgcc_s\.so]] [[^linux-vdso]])
file(GET_RUNTIME_DEPENDENCIES
  EXECUTABLES ${PROGRAMS}
  RESOLVED_DEPENDENCIES_VAR libraries
  UNRESOLVED_DEPENDENCIES_VAR missing
  PRE_EXCLUDE_REGEXES ${from_the_machine})
if(missing)
  message(FATAL_ERROR "bundle: these shared libraries are not on this machine: ${missing}")
endif()
list(APPEND libraries ${VULKAN_LOADER})   # opened at run time
foreach(library IN LISTS libraries)
  get_filename_component(name ${library} NAME)
  get_filename_component(file ${library} REALPATH)
  configure_file(${file} ${BUNDLE}/lib/${name} COPYONLY)
endforeach()

# The programs find scenes, and the tests their data, below the working directory.
file(COPY ${SOURCE}/scenes DESTINATION ${BUNDLE})
file(GLOB data RELATIVE ${SOURCE} ${SOURCE}/tests/*/data)
foreach(folder IN LISTS data)
  get_filename_component(suite ${folder} DIRECTORY)
  file(COPY ${SOURCE}/${folder} DESTINATION ${BUNDLE}/${suite})
endforeach()

file(GLOB binaries ${BUNDLE}/bin/* ${BUNDLE}/lib/*)
execute_process(COMMAND ${STRIP} --strip-unneeded ${binaries} COMMAND_ERROR_IS_FATAL ANY)

set(bytes 0)
foreach(file IN LISTS binaries)
  file(SIZE ${file} size)
  math(EXPR bytes "${bytes} + ${size}")
endforeach()
math(EXPR megabytes "${bytes} / 1000000")
message(STATUS "${BUNDLE}: ${megabytes} MB; start ${BUNDLE}/bin/helio from ${BUNDLE}")
