// Whole renders with a foreign memory in place of MonoDdr give the same bits.

#include <tlm_utils/simple_target_socket.h>
#include <cstring>

#include "firmware/path_tracer/path_tracer.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/protocol_checker.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace foreign_memory_test {

using model::TimingStyle;
using path_tracer::Program;
using testbench::RenderOptions;

/// A memory as a third party would write it: b_transport with a latency that is no multiple of the clock,
/// debug transport, optional DMI, no extensions, no phases.
class ForeignMemory : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<ForeignMemory> socket{"socket"};

  ForeignMemory(const sc_core::sc_module_name& name, std::size_t size_bytes, const sc_core::sc_time& latency,
                bool grants_pointer)
      : sc_module(name), bytes_(size_bytes), latency_(latency), grants_pointer_(grants_pointer) {
    socket.register_b_transport(this, &ForeignMemory::b_transport);
    socket.register_transport_dbg(this, &ForeignMemory::transport_dbg);
    socket.register_get_direct_mem_ptr(this, &ForeignMemory::get_direct_mem_ptr);
  }
  std::uint64_t accesses() const { return accesses_; }

 private:
  void b_transport(tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    ++accesses_;
    delay += latency_;
    const unsigned int moved = transport_dbg(payload);
    const bool whole = payload.get_command() == tlm::TLM_IGNORE_COMMAND || moved == payload.get_data_length();
    payload.set_response_status(whole ? tlm::TLM_OK_RESPONSE : tlm::TLM_ADDRESS_ERROR_RESPONSE);
  }
  unsigned int transport_dbg(tlm::tlm_generic_payload& payload) {
    const std::uint64_t address = payload.get_address();
    const unsigned int length = payload.get_data_length();
    if (address > bytes_.size() || length > bytes_.size() - address) return 0;
    if (payload.is_read()) std::memcpy(payload.get_data_ptr(), bytes_.data() + address, length);
    if (payload.is_write()) std::memcpy(bytes_.data() + address, payload.get_data_ptr(), length);
    return length;
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload&, tlm::tlm_dmi& dmi) {
    if (!grants_pointer_) return false;
    dmi.set_start_address(0);
    dmi.set_end_address(bytes_.size() - 1);
    dmi.set_dmi_ptr(bytes_.data());
    dmi.allow_read_write();
    return true;
  }

  std::vector<unsigned char> bytes_;
  sc_core::sc_time latency_;
  bool grants_pointer_;
  std::uint64_t accesses_ = 0;
};

struct Case {
  TimingStyle timing;
  bool grants_pointer;
  double latency_nanoseconds;
};

class Foreign : public test_support::SystemCFixture, public testing::WithParamInterface<Case> {};

TEST_P(Foreign, MemoryGivesTheSameBits) {
  const testbench::Scene scene = test_support::small_cornell_box({17, 5});
  RenderOptions options = test_support::render_options(Program::full, 12);
  options.chip.ddr.size_bytes = 64 << 20;
  const testbench::MonoImage image =
      testbench::make_mono_image(scene, options.chip.chip.pes, options.program);
  testbench::Film film(scene.film, testbench::film_scale(scene));
  model::Csx600 chip("chip", options.chip, GetParam().timing, model::MonoMemory::bound_outside);
  ForeignMemory memory("memory", options.chip.ddr.size_bytes,
                       sc_core::sc_time(GetParam().latency_nanoseconds, sc_core::SC_NS),
                       GetParam().grants_pointer);
  test_support::ProtocolChecker checker("checker");
  chip.clear_connect.ddr_socket.bind(checker.in);
  checker.out.bind(memory.socket);
  testbench::HostPc host("host", chip, image, film);
  chip.control_unit.load([&](cn::Machine& machine) {
    path_tracer::PathTracer(machine, path_tracer::kernels(options.level), options.program, image.layout,
                            options.work)
        .run({});
  });
  sc_core::sc_start();
  chip.control_unit.rethrow_failure();
  EXPECT_TRUE(host.finished());
  EXPECT_EQ(film.sha256(), testbench::render_natively(scene, options).film.sha256());
  EXPECT_EQ(checker.violations(), std::vector<std::string>{});
  EXPECT_EQ(checker.active(), 0u);
  EXPECT_GT(memory.accesses(), 1000u);
  EXPECT_EQ(checker.transactions() > 0, GetParam().timing == TimingStyle::approximately_timed);
  EXPECT_EQ(chip.pio_engine.statistics().late_starts, 0u);
  EXPECT_EQ(chip.control_unit.statistics().total(),
            chip.control_unit.now() - chip.control_unit.start_cycle());
}

INSTANTIATE_TEST_SUITE_P(Memories, Foreign,
                         testing::Values(Case{TimingStyle::loosely_timed, true, 133.7},
                                         Case{TimingStyle::loosely_timed, false, 133.7},
                                         Case{TimingStyle::approximately_timed, true, 133.7},
                                         Case{TimingStyle::approximately_timed, false, 133.7},
                                         Case{TimingStyle::loosely_timed, false, 0},
                                         Case{TimingStyle::approximately_timed, false, 0}),
                         [](const testing::TestParamInfo<Case>& parameters) {
                           return std::string(parameters.param.timing == TimingStyle::loosely_timed ? "Lt"
                                                                                                    : "At") +
                                  (parameters.param.grants_pointer ? "WithPointer" : "WithoutPointer") +
                                  (parameters.param.latency_nanoseconds > 0 ? "" : "WithoutLatency");
                         });

/// A slower foreign memory makes a longer run.
class ForeignLatency : public test_support::SystemCFixture, public testing::WithParamInterface<TimingStyle> {
 protected:
  static model::Cycles cycles_with(double latency_nanoseconds) {
    new_context();
    model::ChipConfig config = test_support::render_options(Program::full, 1).chip;
    config.ddr.size_bytes = 1 << 20;
    model::Csx600 chip("chip", config, GetParam(), model::MonoMemory::bound_outside);
    ForeignMemory memory("memory", config.ddr.size_bytes,
                         sc_core::sc_time(latency_nanoseconds, sc_core::SC_NS), true);
    chip.clear_connect.ddr_socket.bind(memory.socket);
    chip.control_unit.load([](cn::Machine& machine) {
      const cn::Semaphore done = machine.allocate_semaphore("done");
      machine.async_copy_m2p(done, {0, 32}, cn::MonoPlaces::array(0, 32), cn::LaneMask::first(1));
      machine.sem_wait(done);
    });
    elaborate();
    chip.control_unit.start();
    sc_core::sc_start();
    chip.control_unit.rethrow_failure();
    EXPECT_TRUE(chip.control_unit.finished());
    return chip.control_unit.now() - chip.control_unit.start_cycle();
  }
};

TEST_P(ForeignLatency, IsFeltByARead) {
  const model::Cycles fast = cycles_with(1000);
  const model::Cycles slow = cycles_with(11000);  // 2100 cycles more at 210 MHz
  EXPECT_NEAR(double(slow - fast), 2100.0, 1.0);
}

INSTANTIATE_TEST_SUITE_P(Styles, ForeignLatency,
                         testing::Values(TimingStyle::loosely_timed, TimingStyle::approximately_timed));

}  // namespace foreign_memory_test
