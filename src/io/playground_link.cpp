#include "io/playground_link.hpp"

#include <libdeflate.h>

#include <cstdint>
#include <memory>
#include <new>
#include <string_view>

namespace gridlock {

namespace {

std::string deflated(std::string const& text) {
  constexpr int level = 9;
  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> const compressor(
      libdeflate_alloc_compressor(level), &libdeflate_free_compressor);
  if (!compressor) throw std::bad_alloc();
  std::string packed(libdeflate_deflate_compress_bound(compressor.get(), text.size()), '\0');
  packed.resize(libdeflate_deflate_compress(compressor.get(), text.data(), text.size(), packed.data(), packed.size()));
  return packed;
}

std::string in_base64url(std::string const& bytes) {
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string text;
  std::uint32_t waiting = 0;  // bits that are not in a letter yet
  unsigned count = 0;
  for (char const byte : bytes) {
    waiting = (waiting << 8U) | static_cast<unsigned char>(byte);
    for (count += 8; count >= 6;) {
      count -= 6;
      text += letters[(waiting >> count) & 63U];
    }
  }
  if (count > 0) text += letters[(waiting << (6U - count)) & 63U];
  return text;
}

}  // namespace

std::string playground_link(std::string const& toml) { return "playground.html#toml=" + in_base64url(deflated(toml)); }

}  // namespace gridlock
