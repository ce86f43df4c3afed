// The path tracer with arrays of the scene in the memory on the chip: the same image, from where it should
// be.

#include <gtest/gtest.h>

#include "testbench/run/render.hpp"
#include "testbench/sweep/replay.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace scratchpad_test {

using path_tracer::Program;
using path_tracer::Scratchpad;
using path_tracer::Traversal;
using test_support::render_options;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class ScratchpadRenders : public test_support::SystemCFixture {
 protected:
  static RenderResult on_chip(const Scene& scene, const RenderOptions& options) {
    new_context();
    return testbench::render_on_chip(scene, options);
  }
  static RenderOptions options(Traversal traversal, Scratchpad scratchpad) {
    RenderOptions options = render_options(Program::full, 2);
    options.program.traversal = traversal;
    options.program.scratchpad = scratchpad;
    return options;
  }
  static std::string refusal(const Scene& scene, const RenderOptions& options) {
    try {
      on_chip(scene, options);
      return "";
    } catch (const testbench::InputError& error) {
      return error.what();
    }
  }
};

TEST_F(ScratchpadRenders, ImagesAreTheSameAndRecordsComeFromTheChip) {
  const Scene scene = test_support::small_cornell_box({16, 12});
  for (const Traversal traversal : {Traversal::brute_force, Traversal::refill, Traversal::temporary_bin,
                                    Traversal::packets, Traversal::shared_treelets}) {
    const RenderResult in_ddr = on_chip(scene, options(traversal, Scratchpad::none));
    EXPECT_EQ(in_ddr.chip->on_chip_sram.bytes_read, 0u);
    for (const Scratchpad scratchpad : {Scratchpad::nodes, Scratchpad::triangles, Scratchpad::fitting}) {
      if (traversal == Traversal::brute_force && scratchpad == Scratchpad::nodes) continue;
      SCOPED_TRACE("traversal " + std::to_string(int(traversal)) + ", scratchpad " +
                   std::to_string(int(scratchpad)));
      RenderOptions with = options(traversal, scratchpad);
      with.check_hazards = true;
      const RenderResult result = on_chip(scene, with);
      EXPECT_EQ(result.film.sha256(), in_ddr.film.sha256());
      EXPECT_GT(result.chip->on_chip_sram.bytes_read, 0u);
      EXPECT_GT(result.chip->on_chip_sram.bytes_written, 0u);
      EXPECT_EQ(testbench::render_natively(scene, with).film.sha256(), in_ddr.film.sha256());
      EXPECT_EQ(result.chip->firmware_cycles, [&] {
        const testbench::Recording recording = testbench::record_render(scene, with);
        new_context();
        with.check_hazards = false;
        return testbench::replay_on_chip(recording, with).chip->firmware_cycles;
      }());
    }
  }
}

/// All that is written there is what is read first: 36 triangles of 96 bytes, or as many as the scene has.
TEST_F(ScratchpadRenders, CopiesAnArrayOnce) {
  const Scene scene = test_support::small_cornell_box({8, 8});
  const RenderOptions with = options(Traversal::brute_force, Scratchpad::triangles);
  const RenderResult result = on_chip(scene, with);
  EXPECT_EQ(result.chip->on_chip_sram.bytes_written,
            scene.triangles.size() * sizeof(path_tracer::TriangleRecord));
}

TEST_F(ScratchpadRenders, RefusesWhatDoesNotFit) {
  const Scene scene = test_support::small_cornell_box({8, 8});
  RenderOptions small = options(Traversal::refill, Scratchpad::triangles);
  small.chip.on_chip_sram.size_bytes = 1024;
  EXPECT_NE(refusal(scene, small).find("scratchpad: found triangles of "), std::string::npos)
      << refusal(scene, small);
  small.chip.on_chip_sram.size_bytes = 0;
  EXPECT_NE(refusal(scene, small).find("has 0"), std::string::npos);
  small.program.scratchpad = Scratchpad::fitting;
  EXPECT_EQ(refusal(scene, small), "");
  EXPECT_EQ(
      refusal(scene, options(Traversal::brute_force, Scratchpad::nodes)),
      "scratchpad: found nodes, allowed is none, triangles or fitting with traversal brute_force, which "
      "has no nodes");
}

}  // namespace scratchpad_test
