#include "testbench/sweep/sweep_file.hpp"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "testbench/sweep/sweep_plan.hpp"
#include "testbench/sweep/sweep_points.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace sweep_file_test {

using testbench::InputError;
using testbench::Setting;
using testbench::Sweep;
using testbench::SweepFile;
using Values = std::vector<std::string>;

class SweepFileTest : public testing::Test {
 protected:
  std::string path(const std::string& text) {
    const std::string name = testing::TempDir() + "sweep_file_test_" + std::to_string(getpid()) + ".toml";
    std::ofstream(name) << text;
    return name;
  }
  SweepFile load(const std::string& text) { return testbench::load_sweep_file(path(text)); }
  /// Values of the first key of the first axis.
  Values values(const std::string& axis) {
    const SweepFile sweep = load("[[axis]]\n" + axis);
    Values found;
    for (const auto& step : sweep.axes.at(0).steps) found.push_back(step.at(0).value);
    return found;
  }
  void expect_error(const std::string& text, const Values& parts) {
    SCOPED_TRACE(text);
    try {
      load(text);
      ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
      const std::string message = error.what();
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
      for (const std::string& part : parts)
        EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
    }
  }
};

TEST_F(SweepFileTest, ListsAndRangesGiveTheirValues) {
  EXPECT_EQ(values("firmware.n = [0, 3, 1]"), (Values{"0", "3", "1"}));
  EXPECT_EQ(values("firmware.program = [\"direct\", \"full\"]"), (Values{"direct", "full"}));
  EXPECT_EQ(values("pio.consolidate_equal_addresses = [false, true]"), (Values{"false", "true"}));
  EXPECT_EQ(values("pio.per_pe_cycles = { from = 4, to = 16, step = 4 }"), (Values{"4", "8", "12", "16"}));
  EXPECT_EQ(values("pio.per_pe_cycles = { from = 9, to = 4, step = -2 }"), (Values{"9", "7", "5"}));
  EXPECT_EQ(values("chip.pes = { from = 16, to = 128, factor = 2 }"), (Values{"16", "32", "64", "128"}));
  EXPECT_EQ(values("ddr.banks = { from = 1, to = 9, count = 3 }"), (Values{"1", "5", "9"}));
  EXPECT_EQ(values("ddr.banks = { from = 1, to = 100, count = 3, geometric = true }"),
            (Values{"1", "10", "100"}));
  EXPECT_EQ(values("poly.code_quality_factor = { from = 0.5, to = 1.5, count = 3 }"),
            (Values{"0.5", "1", "1.5"}));
}

TEST_F(SweepFileTest, AxesMultiplyAndKeysOfOneAxisChangeTogether) {
  const SweepFile sweep = load(
      "chip = \"paper\"\nsamples = 2\npio.setup_cycles = 99\naudit.share = 0.5\naudit.seed = 7\n"
      "[[axis]]\nfirmware.n = [0, 1]\n"
      "[[axis]]\nchip.pes = [32, 64, 96]\nddr.banks = [1, 2, 4]\n");
  EXPECT_EQ(sweep.points(), 6u);
  EXPECT_EQ(sweep.keys(), (Values{"firmware.n", "chip.pes", "ddr.banks"}));
  EXPECT_EQ(sweep.axes[1].steps[2][0].value, "96");
  EXPECT_EQ(sweep.axes[1].steps[2][1].value, "4");
  EXPECT_EQ(sweep.base.size(), 3u);
  EXPECT_EQ(sweep.audit_share, 0.5);
  EXPECT_EQ(sweep.audit_seed, 7u);
}

TEST_F(SweepFileTest, PointsHaveTheirSettingsAndTheirOwnNames) {
  const SweepFile file = load("scene = \"" CSX600_SCENES_DIR
                              "/cornell_box\"\nsize = \"8x6\"\nchip = \"paper\"\n"
                              "[[axis]]\nfirmware.n = [0, 2]\n[[axis]]\npio.setup_cycles = [10, 20]\n");
  const Sweep sweep(file, {});
  ASSERT_EQ(sweep.points().size(), 4u);
  const testbench::SweepPoint& point = sweep.points()[2];
  EXPECT_EQ(point.inputs, (Values{"2", "10"}));
  const auto& run = std::get<testbench::RenderPoint>(point.run);
  EXPECT_EQ(run.request.options.program.n, 2);
  EXPECT_EQ(run.request.options.chip.pio.setup_cycles, 10);
  EXPECT_EQ(run.request.options.chip.preset, "paper");
  EXPECT_EQ(run.scene->film.width, 8);
  EXPECT_EQ(sweep.points()[0].stream, sweep.points()[1].stream);
  EXPECT_NE(sweep.points()[0].stream, sweep.points()[2].stream);
  EXPECT_NE(sweep.points()[0].id, sweep.points()[1].id);
  const Sweep other_samples(file, {{"samples", "3", "--set"}});
  EXPECT_NE(other_samples.points()[0].id, sweep.points()[0].id);
  EXPECT_NE(other_samples.points()[0].stream, sweep.points()[0].stream);
  EXPECT_THROW(Sweep(file, {{"firmware.n", "3", "--set"}}), InputError);
}

/// A finished point is taken over by its name, so two lights from outside must not share one.
TEST_F(SweepFileTest, LightFromOutsideIsPartOfAPointsName) {
  const test_support::TemporaryDirectory folder;
  std::ofstream(folder.path() / "m.obj") << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const auto id_under = [&](const std::string& radiance) {
    std::ofstream(folder.path() / "scene.toml")
        << "[camera]\nposition = [0, 0, 9]\nlook_at = [0, 0, 0]\nvertical_fov_degrees = 40\n"
        << "[environment]\nconstant = " << radiance << "\n[[mesh]]\nfile = \"m.obj\"\n";
    const SweepFile file =
        load("scene = \"" + folder.path().string() + "\"\nsize = \"8x6\"\n[[axis]]\nfirmware.n = [0, 1]\n");
    return Sweep(file, {}).points()[0].id;
  };
  const std::string white = id_under("[1, 1, 1]");
  EXPECT_EQ(id_under("[1, 1, 1]"), white);
  EXPECT_NE(id_under("[1, 1, 2]"), white);
}

TEST_F(SweepFileTest, EveryParameterCanBeAnAxis) {
  for (const testbench::RunParameter& parameter : testbench::run_parameter_table()) {
    if (parameter.key == "scene") continue;
    testbench::RunSettings run = testbench::make_settings({});
    const std::string value = parameter.key == "size" ? "9x9" : parameter.read(run);
    EXPECT_NO_THROW(testbench::require_allowed({parameter.key, value, "test"})) << parameter.key;
    EXPECT_EQ(testbench::value_of(testbench::make_settings({{parameter.key, value, "test"}}), parameter.key),
              value);
  }
  for (const model::ParameterInfo& parameter : model::parameter_table())
    EXPECT_NO_THROW(
        testbench::require_allowed({parameter.key, model::value_text(parameter.default_value), "test"}))
        << parameter.key;
}

TEST_F(SweepFileTest, BadInputIsNamedWithItsLine) {
  expect_error("scene = [\n", {".toml:", "not TOML"});
  expect_error("pio.setup = 3\n", {".toml:1", "'pio.setup'", "csx600 params"});
  expect_error("[[axis]]\npio.setup = [3]\n", {".toml:2", "'pio.setup'", "names no parameter"});
  expect_error("[[axis]]\nchip.pes = [96, 97]\n", {".toml:2", "chip.pes", "'97'", "multiple of 8"});
  expect_error("[[axis]]\nfirmware.n = [9]\n", {".toml:2", "firmware.n", "'9'", "0 to 8"});
  expect_error("[[axis]]\nfirmware.program = [\"quick\"]\n",
               {"firmware.program", "'quick'", "segments, direct, full"});
  expect_error("[[axis]]\nfirmware.stack_entries = [4, 3]\n",
               {".toml:2", "firmware.stack_entries", "'3'", "0, 1, 2, 4, 8, 16, 32"});
  expect_error("firmware.seed = -1\n", {".toml:1", "firmware.seed", "'-1'", "0 to 18446744073709551615"});
  expect_error("firmware.max_survival = 1.0\n", {".toml:1", "firmware.max_survival", "'1'", "below 1"});
  expect_error("firmware.depth = 1\n", {".toml:1", "'firmware.depth'", "firmware.program"});
  expect_error("chip.host_link.host_dmas = 1\n", {".toml:1", "chip.host_link.transfers"});
  expect_error("firmware.n = [1, 2]\n", {".toml:1", "firmware.n", "an array", "[[axis]]"});
  expect_error("firmware.n = 1.5\n", {"firmware.n", "'1.5'"});
  expect_error("chip = \"csx601\"\n", {".toml:1", "csx601", "paper"});
  expect_error("size = \"0x5\"\n", {"size", "'0x5'", "1 to 16384"});
  expect_error("axis = 3\n", {".toml:1", "axis", "[[axis]]"});
  expect_error("[[axis]]\n", {"axis", "no key"});
  expect_error("[[axis]]\nfirmware.n = 3\n", {"firmware.n", "'3'", "a list"});
  expect_error("[[axis]]\nfirmware.n = []\n", {"firmware.n", "empty"});
  expect_error("[[axis]]\nfirmware.n = [1, 1]\n", {"firmware.n", "'1' twice"});
  expect_error("[[axis]]\nfirmware.n = [[1], [2]]\n", {"firmware.n", "an array in a list"});
  expect_error("[[axis]]\nfirmware.n = [1, 2]\nddr.banks = [1]\n", {"1 values", "2, as many as"});
  expect_error("[[axis]]\nfirmware.n = [1]\n[[axis]]\nfirmware.n = [2]\n", {"firmware.n", "twice"});
  expect_error("firmware.n = 1\n[[axis]]\nfirmware.n = [2]\n", {"firmware.n", "twice"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4 }\n", {"ddr.banks", "step, factor, count"});
  for (const char* how : {"count = 5", "step = 1", "factor = 2"})
    expect_error("[[axis]]\nddr.banks = { from = 4, to = 4, " + std::string(how) + " }\n",
                 {"ddr.banks", "from 4 to itself", "a list of one value"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4, step = 0 }\n", {"ddr.banks", "step of 0"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4, step = -1 }\n", {"ddr.banks", "step of -1"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4, factor = 1 }\n", {"ddr.banks", "factor of 1"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4, count = 1 }\n", {"ddr.banks", "count of 1"});
  expect_error("[[axis]]\nddr.banks = { from = 1, step = 1 }\n", {"ddr.banks", "without to"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = 4, stride = 1 }\n", {"ddr.banks", "'stride'"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = inf, step = 1 }\n", {"ddr.banks.to", "finite"});
  expect_error("[[axis]]\nddr.banks = { from = 1, to = \"4\", step = 1 }\n", {"ddr.banks.to", "'4'"});
  expect_error("audit.share = 2\n", {"audit.share", "'2'", "0 to 1"});
  expect_error("audit.rate = 0.1\n", {"audit.rate", "audit.seed"});
  std::string keys;
  for (const char* const key : {"fp64_add", "fp64_mul", "fp64_div"})
    keys += "energy.picojoules." + std::string(key) + " = { from = 0.5, to = 1, count = 100000 }\n";
  expect_error("[[axis]]\n" + keys, {"fp64_div: found 300000 values on all axes", "at most 200000"});
  expect_error(
      "[[axis]]\npio.setup_cycles = { from = 1, to = 90000, step = 1 }\n"
      "[[axis]]\npio.per_pe_cycles = { from = 1, to = 90000, step = 1 }\n",
      {"axis", "points", "1000000"});
  EXPECT_THROW(testbench::load_sweep_file("/nonexistent/sweep.toml"), InputError);
  EXPECT_THROW(testbench::load_sweep_file("/"), InputError);
}

TEST_F(SweepFileTest, ValuesThatDoNotFitEachOtherFailTheirPointsOnly) {
  const std::string scene = "scene = \"" CSX600_SCENES_DIR "/cornell_box\"\nsize = \"8x6\"\n";
  const Sweep sweep(load(scene + "firmware.bin_blocks = 3\n[[axis]]\nfirmware.n = [1, 4]\n"), {});
  EXPECT_EQ(sweep.points()[0].error, "");
  EXPECT_NE(sweep.points()[1].error.find("n: found 4"), std::string::npos);
  EXPECT_THROW(Sweep(load(scene + "firmware.bin_blocks = 3\n[[axis]]\nfirmware.n = [5, 4]\n"), {}),
               InputError);
  EXPECT_THROW(Sweep(load("[[axis]]\nfirmware.n = [5, 4]\n"), {}), InputError) << "no scene";
  EXPECT_THROW(Sweep(load("scene = \"nowhere\"\n[[axis]]\nfirmware.n = [5, 4]\n"), {}), InputError);
}

TEST_F(SweepFileTest, TheAuditTakesItsShareOfThePoints) {
  const std::string scene = "scene = \"" CSX600_SCENES_DIR "/cornell_box\"\nsize = \"8x6\"\n";
  const std::string axis = "[[axis]]\npio.setup_cycles = { from = 1, to = 1000, step = 1 }\n";
  const auto audited = [&](const std::string& audit) {
    std::vector<bool> chosen;
    const Sweep sweep(load(scene + audit + axis), {});
    for (const testbench::SweepPoint& point : sweep.points()) chosen.push_back(point.audited);
    return chosen;
  };
  const auto count = [](const std::vector<bool>& chosen) {
    return std::count(chosen.begin(), chosen.end(), true);
  };
  const std::vector<bool> usual = audited("");
  EXPECT_NEAR(double(count(usual)), 50, 25);
  EXPECT_EQ(audited(""), usual);
  EXPECT_NE(audited("audit.seed = 2\n"), usual);
  EXPECT_EQ(count(audited("audit.share = 0\n")), 0);
  EXPECT_EQ(count(audited("audit.share = 1\n")), 1000);
}

TEST_F(SweepFileTest, ThePlanKeepsAServerOnItsStream) {
  const std::string scene = "scene = \"" CSX600_SCENES_DIR "/cornell_box\"\nsize = \"8x6\"\n";
  const Sweep sweep(load(scene + "[[axis]]\nfirmware.n = [0, 1]\n[[axis]]\npio.setup_cycles = [1, 2, 3]\n"),
                    {});
  testbench::SweepPlan plan(sweep, {0, 1, 2, 3, 4, 5}, false);
  const auto stream = [&](int server) { return sweep.points()[plan.next(server)->point].stream; };
  const std::string of_0 = stream(0);
  const std::string of_1 = stream(1);
  EXPECT_NE(of_0, of_1);
  EXPECT_EQ(stream(0), of_0);
  EXPECT_EQ(stream(1), of_1);
  EXPECT_EQ(stream(0), of_0);
  EXPECT_EQ(stream(0), of_1) << "helps out when its own is done";
  EXPECT_FALSE(plan.next(1));
}

TEST_F(SweepFileTest, ThePlanReplaysWhatIsSharedAndNothingElse) {
  const std::string scene = "scene = \"" CSX600_SCENES_DIR "/cornell_box\"\nsize = \"8x6\"\n";
  const Sweep sweep(load(scene + "[[axis]]\nfirmware.n = [0, 1]\n[[axis]]\npio.setup_cycles = [1, 2]\n"), {});
  testbench::SweepPlan some(sweep, {0, 1, 2}, false);
  for (int i = 0; i < 3; ++i) {
    const auto order = some.next(0);
    EXPECT_EQ(order->replays, order->point < 2) << order->point;
  }
  testbench::SweepPlan in_full(sweep, {0, 1, 2, 3}, true);
  EXPECT_FALSE(in_full.next(0)->replays);
  testbench::SweepPlan nothing(sweep, {}, false);
  EXPECT_FALSE(nothing.next(0));
}

}  // namespace sweep_file_test
