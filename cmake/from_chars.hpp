#pragma once

// A build by cmake/libcxx.cmake includes this file before every source: libc++ before version 20 reads no floating-point
// numbers. fast_float rounds correctly, as the standard asks, so the bits are the same.

#include <fast_float/fast_float.h>

#include <charconv>

namespace std {  // NOLINT(cert-dcl58-cpp): the function belongs here, and is missing

inline from_chars_result from_chars(char const* first, char const* last, double& value) {
  auto const [end, error] = fast_float::from_chars(first, last, value);
  return {end, error};
}

}  // namespace std
