#pragma once

#include <xxhash.h>

#include <string>

#include "io/checkpoint.hpp"

namespace gridlock::test {

/// The bytes as the content of a checkpoint whose checksum is right.
inline std::string with_header(std::string const& content) {
  std::string bytes = to_checkpoint([](Archive&) {}).substr(0, 16);
  XXH128_canonical_t checksum;
  XXH128_canonicalFromHash(&checksum, XXH3_128bits(content.data(), content.size()));
  bytes.append(reinterpret_cast<char const*>(checksum.digest), sizeof checksum.digest);
  return bytes + content;
}

}  // namespace gridlock::test
