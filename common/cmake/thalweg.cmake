# Settings shared by all targets: language, warnings, sanitizers, folders.
include_guard(GLOBAL)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # GCC collects garbage from 128 MB on, which takes a tenth of its time; small sources need less than 512 MB.
  add_compile_options($<$<COMPILE_LANGUAGE:CXX>:--param=ggc-min-heapsize=524288>)
endif()

include(GNUInstallDirs)
set(THALWEG_INCLUDEDIR ${CMAKE_INSTALL_INCLUDEDIR}/thalweg)  # headers keep their source folders below it

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

set(THALWEG_SANITIZE "" CACHE STRING "Sanitizers, comma separated: address,undefined or thread")
if(THALWEG_SANITIZE)
  add_compile_options(-fsanitize=${THALWEG_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${THALWEG_SANITIZE})
  add_library(thalweg_sanitizer_options OBJECT common/base/sanitizer_options.cpp)
  # Not instrumented itself, so that programs which are not sanitized link it, too; such code does not see the macros of
  # GCC, which Clang lacks anyway.
  target_compile_options(thalweg_sanitizer_options PRIVATE -fno-sanitize=all)
  if(THALWEG_SANITIZE MATCHES address)
    target_compile_definitions(thalweg_sanitizer_options PRIVATE THALWEG_SANITIZE_ADDRESS)
  endif()
  if(THALWEG_SANITIZE MATCHES thread)
    target_compile_definitions(thalweg_sanitizer_options PRIVATE THALWEG_SANITIZE_THREAD)
  endif()
  link_libraries(
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:thalweg_sanitizer_options>>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # With sanitizers, GCC 12 warns about uninitialized memory and null pointers within std::regex.
    set(THALWEG_SANITIZER_WARNINGS -Wno-maybe-uninitialized -Wno-null-dereference)
    # ThreadSanitizer does not understand the fences of Asio, of which GCC warns. Handlers pass between threads under
    # the mutex of the scheduler, too.
    if(THALWEG_SANITIZE MATCHES thread)
      list(APPEND THALWEG_SANITIZER_WARNINGS -Wno-tsan)
    endif()
  endif()
endif()

option(THALWEG_FUZZ "Build the fuzzers; needs clang" OFF)
add_library(thalweg_warnings INTERFACE)
# CUDA's headers, and what nvcc makes of a source, are not held to them.
set(warnings -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual -Wunused
  -Woverloaded-virtual -Wnull-dereference ${THALWEG_SANITIZER_WARNINGS})
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # Where a source is included by another, GCC takes a class for one that other translation units know, too.
  list(APPEND warnings -Wno-subobject-linkage)
endif()
target_compile_options(thalweg_warnings INTERFACE "$<$<NOT:$<COMPILE_LANGUAGE:CUDA>>:${warnings}>")
option(THALWEG_WERROR "Treat warnings as errors; for developers, whose compiler version is known" OFF)
if(THALWEG_WERROR)
  target_compile_options(thalweg_warnings INTERFACE $<$<NOT:$<COMPILE_LANGUAGE:CUDA>>:-Werror>)
endif()

# thalweg_add_library(NAME SOURCES a.cpp... PUBLIC lib... PRIVATE lib...) -> thalweg::NAME
# Without sources, it is a header-only (interface) library.
function(thalweg_add_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target thalweg_${name})
  if(arg_SOURCES)
    add_library(${target} STATIC ${arg_SOURCES})
    set(scope PUBLIC)
    target_link_libraries(${target} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE} $<BUILD_INTERFACE:thalweg_warnings>)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
    target_link_libraries(${target} INTERFACE ${arg_PUBLIC})
  endif()
  target_compile_features(${target} ${scope} cxx_std_20)
  target_include_directories(${target} ${scope}
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${THALWEG_INCLUDEDIR}>)
  add_library(thalweg::${name} ALIAS ${target})
endfunction()

# thalweg_add_service(NAME MAIN main.cpp LINKS lib...) -> bin/thalweg-NAME
function(thalweg_add_service name)
  cmake_parse_arguments(arg "" "MAIN" "LINKS" ${ARGN})
  add_executable(thalweg-${name} ${arg_MAIN})
  target_link_libraries(thalweg-${name} PRIVATE ${arg_LINKS} thalweg_warnings)
endfunction()

# Sets `result` to whether tests with this label run alone: the whole system in real time needs every core.
function(thalweg_needs_machine result label)
  string(COMPARE EQUAL "${label}" system serial)
  set(${result} ${serial} PARENT_SCOPE)
endfunction()

# thalweg_add_test(NAME SOURCES a_test.cpp... LINKS lib... [TIMEOUT s] [LABELS l] [DEPENDS target...]
#                  [HEAVY filter [HEAVY_TIMEOUT s]])
#   -> bin/test_NAME, one CTest case per TEST; sanitized, a test has ten times its time. What the filter of GoogleTest
#   matches has the label heavy instead.
function(thalweg_add_test name)
  cmake_parse_arguments(arg "" "TIMEOUT;LABELS;HEAVY;HEAVY_TIMEOUT" "SOURCES;LINKS;DEPENDS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 60)
  endif()
  if(NOT arg_HEAVY_TIMEOUT)
    set(arg_HEAVY_TIMEOUT ${arg_TIMEOUT})
  endif()
  if(THALWEG_SANITIZE)
    math(EXPR arg_TIMEOUT "10 * ${arg_TIMEOUT}")
    math(EXPR arg_HEAVY_TIMEOUT "10 * ${arg_HEAVY_TIMEOUT}")
  endif()
  if(NOT arg_LABELS)
    set(arg_LABELS unit)
  endif()
  add_executable(test_${name} ${arg_SOURCES})
  # A path that is absolute stays as it is.
  list(TRANSFORM arg_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ REGEX "^[^/]")
  thalweg_list_test(${name}. TARGETS test_${name} SOURCES ${arg_SOURCES})
  target_link_libraries(test_${name} PRIVATE ${arg_LINKS} thalweg::test_places thalweg_warnings GTest::gmock_main)
  # A test spends most of its time in the libraries, which are optimized as they are shipped.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  # Most of a test's source is what it includes.
  set_target_properties(test_${name} PROPERTIES UNITY_BUILD_BATCH_SIZE 12)
  if(arg_DEPENDS)
    add_dependencies(test_${name} ${arg_DEPENDS})
  endif()
  include(GoogleTest)
  thalweg_needs_machine(serial ${arg_LABELS})
  set(others "*")
  if(arg_HEAVY)
    set(others "-${arg_HEAVY}")
    gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST TEST_FILTER "${arg_HEAVY}"
      TEST_LIST test_${name}_HEAVY PROPERTIES TIMEOUT ${arg_HEAVY_TIMEOUT} LABELS heavy)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. DISCOVERY_MODE PRE_TEST TEST_FILTER "${others}"
    PROPERTIES TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABELS} RUN_SERIAL ${serial})
endfunction()

# thalweg_add_script_test(NAME COMMAND command... [TIMEOUT s] [LABELS l] [DEPENDS target...])
#   -> one CTest case; exit code 77 skips it
function(thalweg_add_script_test name)
  cmake_parse_arguments(arg "" "TIMEOUT;LABELS" "COMMAND;DEPENDS" ${ARGN})
  add_test(NAME ${name} COMMAND ${arg_COMMAND})
  thalweg_needs_machine(serial ${arg_LABELS})
  set_tests_properties(${name} PROPERTIES
    TIMEOUT ${arg_TIMEOUT} LABELS ${arg_LABELS} RUN_SERIAL ${serial} SKIP_RETURN_CODE 77)
  thalweg_list_test(${name} TARGETS ${arg_DEPENDS})
endfunction()

# tests.txt in the build tree says for tests/run, before anything is built, what each test needs, in lines
# "NAME|TARGET...|SOURCE...". The tests in the sources are named NAMESuite.Case; without sources, NAME is the
# test.
set(THALWEG_TEST_LIST ${CMAKE_BINARY_DIR}/tests.txt)
file(WRITE ${THALWEG_TEST_LIST} "")
function(thalweg_list_test name)
  cmake_parse_arguments(arg "" "" "TARGETS;SOURCES" ${ARGN})
  list(JOIN arg_TARGETS " " targets)
  list(JOIN arg_SOURCES " " sources)
  file(APPEND ${THALWEG_TEST_LIST} "${name}|${targets}|${sources}\n")
endfunction()

# thalweg_add_benchmark(NAME SOURCES a_bench.cpp... LINKS lib...) -> bin/bench_NAME
function(thalweg_add_benchmark name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(bench_${name} ${arg_SOURCES})
  target_link_libraries(bench_${name} PRIVATE ${arg_LINKS} thalweg::test_places thalweg_warnings
    benchmark::benchmark_main)
endfunction()
