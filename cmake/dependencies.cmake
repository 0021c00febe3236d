# Every library comes from Debian (deploy/install-deps).
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Protobuf REQUIRED)     # module mode, and before gRPC: Debian's gRPC asks for it
find_package(gRPC CONFIG REQUIRED)
find_package(absl CONFIG REQUIRED)   # comes with gRPC
find_program(GRPC_CPP_PLUGIN grpc_cpp_plugin REQUIRED)
find_package(OpenSSL REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(prometheus-cpp CONFIG REQUIRED COMPONENTS core)
find_package(nlohmann_json REQUIRED)
find_package(glm REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(VulkanMemoryAllocator CONFIG QUIET)
pkg_check_modules(SQLITE REQUIRED IMPORTED_TARGET sqlite3)
pkg_check_modules(HTTPLIB REQUIRED IMPORTED_TARGET cpp-httplib)
pkg_check_modules(TURBOJPEG REQUIRED IMPORTED_TARGET libturbojpeg)
find_program(GLSLANG glslangValidator REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)
if(HELIOGRAPH_TESTS)
  find_package(GTest REQUIRED)
  find_package(Boost CONFIG REQUIRED)   # headers of Boost.Math: the distributions of the statistical tests
endif()
