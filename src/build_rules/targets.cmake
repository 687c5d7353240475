# How each of our targets is compiled.
add_library(packmerger_compile_options INTERFACE)
target_compile_features(packmerger_compile_options INTERFACE cxx_std_20)
target_compile_options(packmerger_compile_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual
  # fused multiply-adds would make results differ between compilers
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 reports these two wrongly for std::string's operator+ and for Eigen's small matrices
  target_compile_options(packmerger_compile_options INTERFACE -Wno-restrict -Wno-maybe-uninitialized)
endif()
if(PACKMERGER_WERROR)
  target_compile_options(packmerger_compile_options INTERFACE -Werror)
endif()
if(PACKMERGER_SANITIZE)
  target_compile_options(packmerger_compile_options INTERFACE
    -fsanitize=${PACKMERGER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(packmerger_compile_options INTERFACE -fsanitize=${PACKMERGER_SANITIZE})
endif()

# packmerger_library(NAME SOURCES ... LINKS ... PRIVATE_LINKS ...): the static library of one folder.
# Its headers are included as "folder/file.h".
function(packmerger_library name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LINKS;PRIVATE_LINKS")
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${ARG_LINKS} PRIVATE packmerger_compile_options ${ARG_PRIVATE_LINKS})
endfunction()

# packmerger_program(NAME SOURCES ... LINKS ...): an executable in build/bin.
function(packmerger_program name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LINKS")
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE packmerger_compile_options ${ARG_LINKS})
endfunction()
