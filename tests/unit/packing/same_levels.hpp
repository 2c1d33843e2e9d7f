#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "gridlock/packing/pressure_ramp.hpp"

namespace gridlock {

/// All that two levels hold; not a number is the same as itself.
inline void expect_same(PressureLevel const& a, PressureLevel const& b) {
  auto const is_same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  for (double PressureLevel::*const member :
       {&PressureLevel::packing_fraction, &PressureLevel::pressure, &PressureLevel::energy, &PressureLevel::residual,
        &PressureLevel::contact_number, &PressureLevel::excess_contacts, &PressureLevel::bulk_modulus,
        &PressureLevel::shear_modulus, &PressureLevel::simple_shear_modulus, &PressureLevel::pure_shear_modulus,
        &PressureLevel::least_shear_modulus, &PressureLevel::jamming_packing_fraction}) {
    EXPECT_TRUE(is_same(a.*member, b.*member)) << a.*member << " and " << b.*member;
  }
  EXPECT_EQ(a.iterations, b.iterations);
  EXPECT_EQ(a.backbone_disks, b.backbone_disks);
  EXPECT_EQ(a.backbone_contacts, b.backbone_contacts);
}

inline void expect_same(std::vector<PressureLevel> const& a, std::vector<PressureLevel> const& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) expect_same(a[k], b[k]);
}

}  // namespace gridlock
