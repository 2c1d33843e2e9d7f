// The headings of a register of disks, for kernels written with Google Highway; src/core/highway-inl.hpp says how it
// is included.

#if defined(GRIDLOCK_ENGINE_HEADINGS_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef GRIDLOCK_ENGINE_HEADINGS_INL_HPP
#undef GRIDLOCK_ENGINE_HEADINGS_INL_HPP
#else
#define GRIDLOCK_ENGINE_HEADINGS_INL_HPP
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/highway-inl.hpp"
#include "engine/headings.hpp"

#if HWY_TARGET != HWY_SCALAR && HWY_TARGET != HWY_EMU128
HWY_BEFORE_NAMESPACE();

namespace gridlock::HWY_NAMESPACE {

/// The operations of turned_velocity() on the disks of a register of D, in the same order, so that the bits are the
/// same.
template <class D>
class HeadingTurns {
  using Floats = hn::Rebind<float, D>;
  using Words = hn::RebindToUnsigned<Floats>;
  using LongWords = hn::RebindToUnsigned<D>;
  using Float = hn::Vec<Floats>;
  using Word = hn::Vec<Words>;
  using LongWord = hn::Vec<LongWords>;
  using Series = detail::HeadingSeries;

 public:
  /// The lower halves of `id_indices` are the id indices of the disks.
  static HWY_INLINE Vectors<D> turned(HeadingStep const& step, LongWord id_indices, Vectors<D> velocity) {
    D const tag;
    auto const [cosine, sine] = turn(hn::Mul(number(step.width), noise(step, id_indices)));
    auto const c = hn::PromoteTo(tag, cosine);
    auto const s = hn::PromoteTo(tag, sine);
    auto const x = hn::Sub(hn::Mul(velocity.x, c), hn::Mul(velocity.y, s));
    auto const y = hn::Add(hn::Mul(velocity.x, s), hn::Mul(velocity.y, c));
    auto const square = hn::Mul(squared_length(x, y), hn::Set(tag, step.inverse_square));
    auto const scale = hn::Sub(hn::Set(tag, 1.5), hn::Mul(hn::Set(tag, 0.5), square));
    return {hn::Mul(scale, x), hn::Mul(scale, y)};
  }

 private:
  struct Turn {
    Float cosine;
    Float sine;
  };

  static HWY_INLINE Float number(float value) { return hn::Set(Floats(), value); }
  static HWY_INLINE Word word(std::uint32_t value) { return hn::Set(Words(), value); }
  static HWY_INLINE Float as_number(Word bits) { return hn::BitCast(Floats(), bits); }
  static HWY_INLINE Word as_bits(Float numbers) { return hn::BitCast(Words(), numbers); }
  /// The words are whole numbers with a sign.
  static HWY_INLINE Float to_float(Word whole) {
    return hn::ConvertTo(Floats(), hn::BitCast(hn::RebindToSigned<Floats>(), whole));
  }

  template <std::size_t count>
  static HWY_INLINE Float series(std::array<float, count> const& coefficients, Float z) {
    Float sum = number(coefficients[0]);
    HWY_UNROLL(8)
    for (std::size_t k = 1; k < count; ++k) sum = hn::Add(hn::Mul(sum, z), number(coefficients[k]));
    return sum;
  }

  static HWY_INLINE Float noise(HeadingStep const& step, LongWord id_indices) {
    // Only the lower halves of the words are meant; those above hold what is left of a product.
    LongWords const long_words;
    hn::Repartition<std::uint32_t, D> const halves;
    LongWord c0 = id_indices;
    LongWord c1 = hn::Set(long_words, step.word);
    std::uint32_t key = step.key;
    HWY_UNROLL(10)
    for (int round = 0; round < Series::rounds; ++round) {
      LongWord const product = hn::MulEven(hn::BitCast(halves, c0), hn::Set(halves, Series::multiplier));
      c0 = hn::Xor(hn::Xor(hn::ShiftRight<32>(product), hn::Set(long_words, std::uint64_t{key})), c1);
      c1 = product;
      key += Series::key_step;
    }
    Word const first = hn::TruncateTo(Words(), c0);
    Word const second = hn::TruncateTo(Words(), c1);
    Float const u = hn::Mul(to_float(hn::Or(hn::ShiftRight<1>(first), word(1))), number(Series::two_to_minus_31));
    Float const x = hn::Mul(to_float(second), number(Series::pi_by_two_to_32));
    Float const root = hn::Sqrt(hn::Abs(hn::Mul(number(2.0F), logarithm(u))));
    return hn::Mul(root, hn::Mul(x, series(Series::sine(), hn::Mul(x, x))));
  }

  static HWY_INLINE Float logarithm(Float u) {
    Word const bits = as_bits(u);
    Word const k = hn::ShiftRight<23>(hn::Sub(word(Series::bits_of_root_half + ((1U << 23U) - 1U)), bits));
    Float const m = as_number(hn::Add(bits, hn::ShiftLeft<23>(k)));
    Float const s = hn::Div(hn::Sub(m, number(1.0F)), hn::Add(m, number(1.0F)));
    Float const sum = series(Series::logarithm(), hn::Mul(s, s));
    return hn::Sub(hn::Mul(hn::Mul(number(2.0F), s), sum), hn::Mul(to_float(k), number(Series::ln_2)));
  }

  static HWY_INLINE Turn turn(Float angle) {
    Float const shifted = hn::Add(hn::Mul(angle, number(Series::quarters_per_radian)), number(Series::large));
    Float const quarters = hn::Sub(shifted, number(Series::large));
    Float const x = hn::Sub(hn::Sub(angle, hn::Mul(quarters, number(Series::quarter_high))),
                            hn::Mul(quarters, number(Series::quarter_low)));
    Float const z = hn::Mul(x, x);
    Float const c = series(Series::cosine_near_zero(), z);
    Float const s = hn::Mul(x, series(Series::sine_near_zero(), z));
    // The last two bits are the quarter: 1 and 3 exchange the two, 1 and 2 turn the sign of the cosine, 2 and 3 that of
    // the sine.
    Word const quarter = as_bits(shifted);
    auto const is_odd = hn::MaskFromVec(as_number(hn::Sub(hn::Zero(Words()), hn::And(quarter, word(1)))));
    Word const sign_of_sine = hn::ShiftLeft<31>(hn::ShiftRight<1>(quarter));
    Word const sign_of_cosine = hn::Xor(sign_of_sine, hn::ShiftLeft<31>(quarter));
    return {as_number(hn::Xor(as_bits(hn::IfThenElse(is_odd, s, c)), sign_of_cosine)),
            as_number(hn::Xor(as_bits(hn::IfThenElse(is_odd, c, s)), sign_of_sine))};
  }
};

}  // namespace gridlock::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();
#endif

#endif
