# Every library the project links, found once. All come from Debian 12 (see packages.txt).
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(PNG REQUIRED)
find_package(ZLIB REQUIRED)
find_package(meshoptimizer REQUIRED)
find_package(SQLite3 REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(tomlplusplus REQUIRED)
find_package(CLI11 REQUIRED)
find_package(fmt REQUIRED)
find_package(pugixml REQUIRED)

foreach(library osmesa libserialport libusb-1.0 libmicrohttpd libseccomp libsystemd fcl libhwy libzip tinygltf libcurl avahi-client)
  pkg_check_modules(${library} REQUIRED IMPORTED_TARGET ${library})
endforeach()

# Paho's synchronous client with TLS tells pkg-config nothing.
find_library(PAHO_MQTT_LIBRARY paho-mqtt3cs REQUIRED)

# CGAL is header-only here; it needs GMP and MPFR, and Boost's headers.
find_library(GMP_LIBRARY gmp REQUIRED)
find_library(MPFR_LIBRARY mpfr REQUIRED)
add_library(packmerger_cgal INTERFACE)
target_compile_definitions(packmerger_cgal INTERFACE CGAL_HEADER_ONLY CGAL_EIGEN3_ENABLED CGAL_NO_DEPRECATED_CODE)
target_link_libraries(packmerger_cgal INTERFACE Eigen3::Eigen ${GMP_LIBRARY} ${MPFR_LIBRARY})

find_library(OPENVDB_LIBRARY openvdb REQUIRED)
find_library(IMATH_LIBRARY NAMES Imath-3_1 Imath REQUIRED)
add_library(packmerger_openvdb INTERFACE)
target_link_libraries(packmerger_openvdb INTERFACE ${OPENVDB_LIBRARY} ${IMATH_LIBRARY} TBB::tbb)

find_library(TETGEN_LIBRARY tet REQUIRED)
add_library(packmerger_tetgen INTERFACE)
target_compile_definitions(packmerger_tetgen INTERFACE TETLIBRARY)
target_link_libraries(packmerger_tetgen INTERFACE ${TETGEN_LIBRARY})
