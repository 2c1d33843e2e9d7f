# A build by clang with libc++ on Debian, whose libraries in C++ are compiled for libstdc++: these come from their headers or
# sources. Those in C stay as they are, and so does oneTBB, whose functions take no types of the standard library. Of RapidCheck
# Debian has the archive alone, so the tests that use it are left out.
add_compile_options(-include ${CMAKE_CURRENT_LIST_DIR}/from_chars.hpp)

macro(gridlock_provide method name)
  if("${name}" MATCHES "^(fmt|tomlplusplus)$")
    add_library(${name}::${name} INTERFACE IMPORTED)
    set(${name}_FOUND TRUE)
  elseif("${name}" STREQUAL "rapidcheck")
    add_library(rapidcheck INTERFACE IMPORTED)
    set_source_files_properties(unit/drawing/picture_test.cpp PROPERTIES HEADER_FILE_ONLY ON)
    set(rapidcheck_FOUND TRUE)
  elseif("${name}" STREQUAL "GTest")
    set(googletest /usr/src/googletest/googletest)
    add_library(googletest STATIC ${googletest}/src/gtest-all.cc ${googletest}/src/gtest_main.cc)
    target_include_directories(googletest SYSTEM PRIVATE ${googletest} PUBLIC ${googletest}/include)
    add_library(GTest::gtest_main ALIAS googletest)
    set(GTest_FOUND TRUE)
  endif()
endmacro()
cmake_language(SET_DEPENDENCY_PROVIDER gridlock_provide SUPPORTED_METHODS FIND_PACKAGE)
add_compile_definitions(FMT_HEADER_ONLY)
