#pragma once

#include <gtest/gtest.h>

#include <systemc>

namespace test_support {

/// Gives each test a new SystemC context.
class SystemCFixture : public testing::Test {
 protected:
  SystemCFixture() { new_context(); }

  /// Must be called before a further simulation in the same test, because SystemC allows no new modules once
  /// a simulation has begun. The previous context leaks (about 5 KB), since deleting it would also delete the
  /// modules' names.
  static void new_context() {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
  }

  /// Completes the binding of ports without advancing time.
  static void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }
};

}  // namespace test_support
