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
# Seen from the build folder, where compilers run: ccache knows a file again in another checkout.
file(RELATIVE_PATH rules_from_build ${CMAKE_BINARY_DIR} ${CMAKE_CURRENT_LIST_DIR})
if(PACKMERGER_SANITIZE)
  target_compile_options(packmerger_compile_options INTERFACE
    -fsanitize=${PACKMERGER_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(packmerger_compile_options INTERFACE
      -fsanitize-ignorelist=${rules_from_build}/sanitizer_ignore.txt)
  endif()
  target_link_options(packmerger_compile_options INTERFACE -fsanitize=${PACKMERGER_SANITIZE})
endif()
if(PACKMERGER_FUZZ)
  # all our code counts its branches for the fuzzers; only they have a fuzzer's main
  target_compile_options(packmerger_compile_options INTERFACE -fsanitize=fuzzer-no-link
    -fsanitize-coverage-ignorelist=${rules_from_build}/coverage_ignore.txt)
  target_link_options(packmerger_compile_options INTERFACE -fsanitize=fuzzer-no-link)
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

# packmerger_test(NAME SOURCES ... LINKS ... [TIMEOUT s] [LABEL unit|unit-threads|...] [RUNNER program]): a
# GoogleTest program, started by RUNNER where there is one; one ctest test a TEST(), or one for the program where
# sanitizers are on. tests/ is on the include path.
# Label unit (the default) runs under the address and undefined sanitizers, unit-threads under the thread sanitizer as
# well; the target LABEL_tests builds all programs of a label.
function(packmerger_test name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "TIMEOUT;LABEL;RUNNER" "SOURCES;LINKS")
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  packmerger_program(${name} SOURCES ${ARG_SOURCES} LINKS ${ARG_LINKS} GTest::gmock GTest::gtest_main)
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  if(ARG_RUNNER)
    # CMake's name for it; gtest_discover_tests reads it at once
    set_target_properties(${name} PROPERTIES CROSSCOMPILING_EMULATOR ${ARG_RUNNER})
  endif()
  set(environment "PACKMERGER_SOURCE=${PROJECT_SOURCE_DIR}" "PACKMERGER_BIN=${CMAKE_RUNTIME_OUTPUT_DIRECTORY}"
    "LSAN_OPTIONS=suppressions=${PROJECT_SOURCE_DIR}/tests/lsan.supp:print_suppressions=0")
  if(PACKMERGER_SANITIZE)
    # A process starts slowly with a sanitizer in it. That threads change no answer, and what becomes of real models, is
    # for the release build to say: generated ones cover the same code.
    add_test(NAME ${name} COMMAND ${name} --gtest_filter=-*OnOneThreadAnd*:*OnOneAndTwoThreads*:*RealModels*)
    set_tests_properties(${name} PROPERTIES TIMEOUT 1800 LABELS ${ARG_LABEL} ENVIRONMENT "${environment}")
  else()
    gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
      PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS ${ARG_LABEL})
    # gtest_discover_tests takes no properties that are lists
    set(script ${CMAKE_CURRENT_BINARY_DIR}/${name}_environment.cmake)
    file(WRITE ${script} "if(${name}_TESTS)\n  set_tests_properties(\${${name}_TESTS} PROPERTIES ENVIRONMENT \"${environment}\")\nendif()\n")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
  endif()
  if(NOT TARGET ${ARG_LABEL}_tests)
    add_custom_target(${ARG_LABEL}_tests)
  endif()
  add_dependencies(${ARG_LABEL}_tests ${name})
endfunction()
