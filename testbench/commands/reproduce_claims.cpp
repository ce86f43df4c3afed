#include "testbench/commands/reproduce_claims.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

/// A tree is the faster way by far, and the simulator takes a second a run.
constexpr int kTriangles = 2000;

}  // namespace

std::vector<JudgedClaim> judge_claims(const Scene& box, const RenderOptions& options, int jobs) {
  ClaimScenes scenes{box, generate_scene(GeneratedScene::blob, kTriangles)};
  scenes.many_triangles.film = box.film;
  ProgressBar bar("claims");
  const ClaimMeasurements measured =
      measure_claims(claim_runs(scenes, options), jobs, [&](double share) { bar.show(share); });
  std::vector<JudgedClaim> claims;
  for (const PaperClaim& claim : paper_claims()) claims.push_back({&claim, claim.judge(measured)});
  return claims;
}

std::string claims_text(const std::vector<JudgedClaim>& claims) {
  std::string text;
  for (const JudgedClaim& judged : claims) {
    char head[200];
    std::snprintf(head, sizeof(head), "%-4s %-18s %s\n", judged.claim->section,
                  name_of(judged.judgement.verdict), judged.claim->says);
    text += head;
    text += std::string(24, ' ') + judged.judgement.figure + "\n";
    text +=
        std::string(24, ' ') + "true if: " + judged.claim->criterion + "; " + judged.claim->command + "\n";
  }
  const auto count = [&](Verdict verdict) {
    return std::to_string(std::count_if(claims.begin(), claims.end(), [&](const JudgedClaim& judged) {
      return judged.judgement.verdict == verdict;
    }));
  };
  return text + "\n" + std::to_string(claims.size()) + " claims: " + count(Verdict::holds) + " true, " +
         count(Verdict::partly) + " partly, " + count(Verdict::fails) + " not so\n";
}

nlohmann::ordered_json claims_json(const std::vector<JudgedClaim>& claims, const RenderOptions& options) {
  nlohmann::ordered_json json;
  json["format"] = "csx600-claims-1";
  json["chip_preset"] = options.chip.preset;
  json["samples"] = options.work.samples;
  json["claims"] = nlohmann::ordered_json::array();
  for (const JudgedClaim& judged : claims)
    json["claims"].push_back({{"section", judged.claim->section},
                              {"claim", judged.claim->says},
                              {"true_if", judged.claim->criterion},
                              {"verdict", name_of(judged.judgement.verdict)},
                              {"figure", judged.judgement.figure},
                              {"command", judged.claim->command}});
  return json;
}

}  // namespace testbench
