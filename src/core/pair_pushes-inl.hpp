// The forces of the pair potentials, written once for numbers and for registers of numbers. A file includes it inside
// the namespace of its kernels, after square_root() and broadcast() for its type of number; so it has no include guard.

/// Returns −(dV/dr)/r of two disks, where `square` is r² and `sigma` is σ. Contract: r is below the cutoff.
template <class N>
struct HarmonicPush {
  explicit HarmonicPush(PairConstants const& constants)
      : energy(broadcast<N>(constants.energy)), one(broadcast<N>(1.0)) {}

  [[gnu::always_inline]] N operator()(N square, N sigma) const {
    return (energy / sigma) * (one / square_root(square) - one / sigma);
  }

  N energy;
  N one;
};

template <class N>
struct HertzianPush {
  explicit HertzianPush(PairConstants const& constants)
      : energy(broadcast<N>(constants.energy)), one(broadcast<N>(1.0)) {}

  [[gnu::always_inline]] N operator()(N square, N sigma) const {
    N const distance = square_root(square);
    N const overlap = one - distance / sigma;
    return (energy / sigma) * (overlap * square_root(overlap)) / distance;
  }

  N energy;
  N one;
};

/// The push of wca and of lennard_jones, which differ in their cutoff alone.
template <class N>
struct LennardJonesPush {
  explicit LennardJonesPush(PairConstants const& constants)
      : energy(broadcast<N>(24.0 * constants.energy)), one(broadcast<N>(1.0)), two(broadcast<N>(2.0)) {}

  [[gnu::always_inline]] N operator()(N square, N sigma) const {
    N const inverse = one / square;
    N const s2 = sigma * sigma * inverse;
    N const s6 = s2 * s2 * s2;
    return energy * (s6 * (two * s6 - one)) * inverse;
  }

  N energy;
  N one;
  N two;
};

template <class N>
struct InversePowerPush {
  explicit InversePowerPush(PairConstants const& constants)
      : energy(broadcast<N>(static_cast<double>(constants.exponent) * constants.energy)),
        one(broadcast<N>(1.0)),
        exponent(constants.exponent) {}

  [[gnu::always_inline]] N operator()(N square, N sigma) const {
    N const inverse = one / square;
    N factor = sigma * sigma * inverse;
    N power = exponent % 2 == 1 ? square_root(factor) : one;
    for (std::uint64_t half = exponent / 2; half > 0; half /= 2) {
      if (half % 2 == 1) power = power * factor;
      factor = factor * factor;
    }
    return energy * power * inverse;
  }

  N energy;
  N one;
  std::uint64_t exponent;
};
