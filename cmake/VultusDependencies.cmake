# Debian 12's packages, with the quirks of their CMake files worked around here and nowhere else.
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(nlohmann_json REQUIRED)
find_package(TBB REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(embree 3 REQUIRED)
find_package(OpenImageIO REQUIRED)
find_package(Ceres REQUIRED)
find_package(OpenMesh CONFIG REQUIRED)  # CGAL puts its own FindOpenMesh on the module path
find_package(CGAL REQUIRED)
find_package(spdlog REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenSubdiv MODULE REQUIRED)     # its own config names a static library that is not shipped
find_package(OpenCVModules MODULE REQUIRED)  # OpenCVConfig.cmake comes only with the 317 MB libopencv-dev
find_package(dlib REQUIRED)

if(NOT TARGET OpenMeshCore)
  message(FATAL_ERROR "libopenmesh-dev is missing its CMake targets")
endif()
