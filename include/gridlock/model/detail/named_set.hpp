#pragma once

#include <cstddef>
#include <type_traits>

namespace gridlock {

/// Types with a `name`, each once.
template <class... Tags>
struct NamedSet {
  static constexpr std::size_t count = sizeof...(Tags);
  template <class Tag>
  static constexpr bool has = (std::is_same_v<Tag, Tags> || ...);
  /// The index of a type in the order of the names.
  template <class Tag>
  static constexpr std::size_t place_of = ((Tags::name < Tag::name ? 1U : 0U) + ... + 0U);
};

}  // namespace gridlock
