// Four ranks of one mpirun on this machine make what one process makes.

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "tests/support/command_line.hpp"

namespace ranks_test {

using Json = nlohmann::json;
using Words = std::vector<std::string>;

const std::string kScene = CSX600_SCENES_DIR "/cornell_box";

class Ranks : public test_support::CommandLineFixture {
 protected:
  /// The program's exit code under mpirun; its output goes to a file.
  int run_on_ranks(int ranks, const std::string& arguments) {
    const std::string as_root = geteuid() == 0 ? " --allow-run-as-root" : "";
    const int status = std::system(("cd " + directory().string() + " && timeout 100 " MPIRUN + as_root +
                                    " --oversubscribe -np " + std::to_string(ranks) + " " CSX600_BINARY " " +
                                    arguments + " > /dev/null 2> ranks_error.txt")
                                       .c_str());
    return WEXITSTATUS(status);
  }
  std::string hash(const std::string& file) { return Json::parse(read(file))["image_sha256"]; }
};

TEST_F(Ranks, ShareTheSamplesOfARender) {
  const Words common = {"render", kScene, "--size", "24x20", "--samples", "7", "--program", "direct"};
  Words alone = common;
  alone.insert(alone.end(), {"--stats", "alone.json", "--png", "alone.png"});
  ASSERT_EQ(run(alone).exit_code, 0);
  std::string line;
  for (const std::string& word : common) line += word + " ";
  ASSERT_EQ(run_on_ranks(4, line + "--stats four.json --png four.png"), 0) << read("ranks_error.txt");
  EXPECT_EQ(hash("four.json"), hash("alone.json"));
  EXPECT_EQ(read("four.png"), read("alone.png"));
  const Json four = Json::parse(read("four.json"));
  EXPECT_EQ(four["ranks"], 4);
  EXPECT_EQ(four["parts"].size(), 4u);
  EXPECT_EQ(four["segments"], Json::parse(read("alone.json"))["segments"]);
  EXPECT_LT(four["simulated_seconds"], Json::parse(read("alone.json"))["simulated_seconds"]);
  ASSERT_EQ(run_on_ranks(4, "render " + kScene + " --size 8x6 --samples 2 --native --stats few.json"), 0);
  ASSERT_EQ(run({"render", kScene, "--size", "8x6", "--samples", "2", "--stats", "two.json"}).exit_code, 0);
  EXPECT_EQ(hash("few.json"), hash("two.json")) << "more ranks than samples";
}

TEST_F(Ranks, ShareEachPassOfAnAdaptiveRender) {
  const std::string common = "render " + kScene + " --size 12x10 --samples 64 --target-error 0.2 --stats ";
  ASSERT_EQ(run_on_ranks(1, common + "one.json"), 0) << read("ranks_error.txt");
  ASSERT_EQ(run_on_ranks(3, common + "three.json --exr map.exr"), 0) << read("ranks_error.txt");
  EXPECT_EQ(hash("three.json"), hash("one.json"));
  const Json three = Json::parse(read("three.json"));
  EXPECT_EQ(three["parts"][0]["ranks"], 3);
  EXPECT_LT(three["simulated_seconds"], Json::parse(read("one.json"))["simulated_seconds"]);
  const std::string selective =
      "render " + kScene + " --size 12x10 --samples 3 --importance map.exr --stats ";
  ASSERT_EQ(run_on_ranks(1, selective + "one.json"), 0) << read("ranks_error.txt");
  ASSERT_EQ(run_on_ranks(3, selective + "three.json"), 0) << read("ranks_error.txt");
  EXPECT_EQ(hash("three.json"), hash("one.json"));
  EXPECT_EQ(run_on_ranks(3, common + "t.json --importance none.exr"), 2);
  EXPECT_EQ(run_on_ranks(3, common + "t.json --snapshots map.exr"), 2);
}

TEST_F(Ranks, ShareThePointsOfASweep) {
  write("s.toml", "scene = \"" + kScene +
                      "\"\nsize = \"8x6\"\nsamples = 2\naudit.share = 0.2\n"
                      "[[axis]]\nfirmware.n = [0, 1, 9999]\n"
                      "[[axis]]\npio.setup_cycles = { from = 10, to = 200, step = 10 }\n");
  EXPECT_EQ(run_on_ranks(4, "sweep s.toml -o out"), 2);
  EXPECT_NE(read("ranks_error.txt").find("s.toml:6: firmware.n: found '9999'"), std::string::npos);
  const std::string errors = read("ranks_error.txt");
  EXPECT_EQ(errors.find("9999"), errors.rfind("9999")) << "said once, not by every rank";
  write("s.toml", "scene = \"" + kScene +
                      "\"\nsize = \"8x6\"\nsamples = 2\naudit.share = 0.2\n"
                      "[[axis]]\nfirmware.n = [0, 1]\n"
                      "[[axis]]\npio.setup_cycles = { from = 10, to = 200, step = 10 }\n");
  ASSERT_EQ(run_on_ranks(4, "sweep s.toml -o out"), 0) << read("ranks_error.txt");
  ASSERT_EQ(run({"sweep", "s.toml", "-o", "alone"}).exit_code, 0);
  EXPECT_EQ(read("out/sweep.csv"), read("alone/sweep.csv"));
  EXPECT_EQ(run_on_ranks(4, "sweep s.toml -o out"), 0) << "nothing left to do";
}

TEST_F(Ranks, RecordAPointThatFails) {
  write("s.toml", "scene = \"" + kScene +
                      "\"\nsize = \"8x6\"\nfirmware.n = 2\n"
                      "[[axis]]\npoly.sram_bytes = [2048, 6144]\n[[axis]]\nddr.banks = [2, 4]\n");
  EXPECT_EQ(run_on_ranks(4, "sweep s.toml -o out"), 1);
  const Json points = Json::parse(read("out/sweep.json"))["points"];
  EXPECT_EQ(points[0]["status"], "failed");
  EXPECT_EQ(points[3]["status"], "done");
}

}  // namespace ranks_test
