#include <gtest/gtest.h>

#include <cstdlib>
#include <systemc>

namespace {

// SystemC prints its banner before sc_main runs.
[[maybe_unused]] const int banner_off = setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 1);

/// Every report of the SystemC kernel or of a socket fails the current test. Errors are thrown as well.
void fail_test(const sc_core::sc_report& report, const sc_core::sc_actions& actions) {
  if (report.get_severity() < sc_core::SC_WARNING || actions == sc_core::SC_DO_NOTHING) return;
  ADD_FAILURE() << "SystemC report " << report.get_msg_type() << ": " << report.get_msg();
  if (report.get_severity() >= sc_core::SC_ERROR) throw report;
}

}  // namespace

int sc_main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  sc_core::sc_report_handler::set_handler(fail_test);
  // Units without processes are elaborated by a start without events.
  sc_core::sc_report_handler::set_actions(sc_core::SC_ID_NO_SC_START_ACTIVITY_, sc_core::SC_DO_NOTHING);
  return RUN_ALL_TESTS();
}
