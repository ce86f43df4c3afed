#pragma once

#include <gtest/gtest.h>

#include <systemc>

namespace test_support {

/// Each test elaborates its own modules: SystemC allows none once a simulation has begun, so every test
/// begins with a context of its own. The context before leaks (about 5 KB); deleting it would take the
/// modules' names along.
class SystemCFixture : public testing::Test {
 protected:
  SystemCFixture() {
    sc_core::sc_curr_simcontext = new sc_core::sc_simcontext();
    sc_core::sc_default_global_context = sc_core::sc_curr_simcontext;
  }

  /// Completes binding without letting time pass.
  static void elaborate() { sc_core::sc_start(sc_core::SC_ZERO_TIME); }
};

}  // namespace test_support
