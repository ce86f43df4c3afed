// The paper's claims, judged by small runs.

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/command_line.hpp"

namespace reproduce_claims_test {

using Json = nlohmann::json;

class ReproduceClaims : public test_support::CommandLineFixture {};

/// The verdicts that do not depend on how long the end of a run is, in which ever fewer paths are left.
const std::map<std::string, std::string> kVerdicts = {
    {"and after a few bounces", "true"},
    {"A vertex is appended without loading the path", "true"},
    {"n-buffering hides the latency of loads and saves", "true"},
    {"A bin must be at least n blocks long", "true"},
    {"PEs that succeed get ascending numbers, where a stream processor unloads and reloads", "true"},
    {"Time falls as n rises, and no further after n = 1", "true"},
    {"Loads and saves move around ten doubles a PE", "true"},
    {"The chip has 50 GFLOPS of double precision", "partly"},
    {"750,000 segments a second with a shadow ray each", "not so"},
    {"A sub-tree, not a single node, should be loaded at a time (left open: how large)", "true"},
    {"Bidirectional path tracing fits the bins", "true"},
};

TEST_F(ReproduceClaims, AreJudgedByFreshRuns) {
  const auto result = run({"reproduce", CSX600_SCENES_DIR "/cornell_box", "--claims", "--size", "48x48",
                           "--samples", "4", "--json", "claims.json"});
  ASSERT_EQ(result.exit_code, 0) << result.error;
  const Json json = Json::parse(read("claims.json"));
  std::map<std::string, std::string> verdicts;
  for (const Json& claim : json["claims"]) {
    verdicts[claim["claim"]] = claim["verdict"];
    EXPECT_FALSE(claim["figure"].get<std::string>().empty());
    EXPECT_NE(result.out.find(claim["figure"].get<std::string>()), std::string::npos);
  }
  EXPECT_EQ(verdicts.size(), json["claims"].size()) << "a claim stands twice";
  for (const auto& [claim, verdict] : kVerdicts) EXPECT_EQ(verdicts[claim], verdict) << claim;
}

TEST_F(ReproduceClaims, AreNotTheImage) {
  const auto result = run({"reproduce", CSX600_SCENES_DIR "/cornell_box", "--claims", "--image"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.error_lines().size(), 1U) << result.error;
}

}  // namespace reproduce_claims_test
