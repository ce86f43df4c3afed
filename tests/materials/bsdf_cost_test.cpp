#include <sstream>

#include "firmware/path_tracer/materials/lobe_table.hpp"
#include "tests/materials/material_bench.hpp"

/// What each lobe costs: the instructions that the PE array issues for all PEs. docs/materials.md has the
/// cycles. After an intended change, copy what the test found, and run it again.
namespace bsdf_cost_test {

using cn::InstructionClass;
using path_tracer::BsdfConfig;
using path_tracer::Lobes;
using test_support::counts;
using test_support::MonoMaterial;
using test_support::MonoPoint;

struct Cost {
  const char* name;
  Lobes lobes;
  const char* prepare;
  const char* evaluate;
  const char* sample;
};

Lobes lobes_of(std::initializer_list<bool Lobes::*> members) {
  Lobes lobes;
  for (bool Lobes::*member : members) lobes.*member = true;
  return lobes;
}

std::string text_of(const cn::IssueCounts& issued) {
  std::ostringstream text;
  cn::PrintTo(issued, &text);
  return text.str();
}

class MaterialsCost : public test_support::MaterialBench {
 protected:
  cn::IssueCounts issued_by_prepare(const BsdfConfig& config) {
    return issued_by([&] { prepare(config, MonoMaterial{}, MonoPoint{}); });
  }
  cn::IssueCounts issued_by_evaluate(const BsdfConfig& config) {
    return difference(issued_by([&] {
                        const path_tracer::Bsdf bsdf = prepare(config, MonoMaterial{}, MonoPoint{});
                        evaluate(bsdf, {0.0, 0.0, 1.0});
                      }),
                      issued_by_prepare(config));
  }
  cn::IssueCounts issued_by_sample(const BsdfConfig& config) {
    return difference(issued_by([&] {
                        const path_tracer::Bsdf bsdf = prepare(config, MonoMaterial{}, MonoPoint{});
                        sample(bsdf, {0.25, 0.75}, 0.5);
                      }),
                      issued_by_prepare(config));
  }

  static cn::IssueCounts difference(cn::IssueCounts all, const cn::IssueCounts& part) {
    for (std::size_t i = 0; i < cn::kInstructionClasses; ++i) all.by_class[i] -= part.by_class[i];
    return all;
  }
};

const std::vector<Cost>& costs() {
  static const std::vector<Cost> all = {
      {"diffuse", lobes_of({&Lobes::diffuse}), "{ }", "{ fp64_add:3 fp64_mul:7 move:1 }",
       "{ fp64_add:8 fp64_mul:11 fp64_div:1 fp64_sqrt:2 fp64_sincos:1 move:4 }"},
      {"mirror", lobes_of({&Lobes::mirror}), "{ fp64_add:9 fp64_mul:8 move:2 }",
       "{ fp64_add:4 fp64_mul:3 move:9 }", "{ fp64_add:14 fp64_mul:13 move:2 }"},
      {"glass", lobes_of({&Lobes::glass}), "{ fp64_add:11 fp64_mul:9 fp64_div:1 move:3 }",
       "{ fp64_add:5 fp64_mul:3 int16_alu:3 move:9 }",
       "{ fp64_add:46 fp64_mul:48 fp64_div:3 fp64_sqrt:2 int16_alu:1 move:17 }"},
      {"glossy", lobes_of({&Lobes::glossy}), "{ fp64_add:71 fp64_mul:86 fp64_div:3 fp64_sqrt:1 move:12 }",
       "{ fp64_add:41 fp64_mul:53 fp64_div:4 fp64_sqrt:2 move:12 }",
       "{ fp64_add:81 fp64_mul:108 fp64_div:8 fp64_sqrt:4 fp64_sincos:1 int16_alu:3 move:36 }"},
      {"rough_glass", lobes_of({&Lobes::rough_glass}),
       "{ fp64_add:17 fp64_mul:13 fp64_div:1 fp64_sqrt:1 move:7 }",
       "{ fp64_add:62 fp64_mul:73 fp64_div:7 fp64_sqrt:3 int16_alu:9 move:29 }",
       "{ fp64_add:138 fp64_mul:166 fp64_div:13 fp64_sqrt:7 fp64_sincos:1 int16_alu:17 move:52 }"},
      {"rough_glass thin_glass", lobes_of({&Lobes::rough_glass, &Lobes::thin_glass}),
       "{ fp64_add:74 fp64_mul:68 fp64_div:5 fp64_sqrt:1 move:20 }",
       "{ fp64_add:79 fp64_mul:97 fp64_div:8 fp64_sqrt:3 int16_alu:12 move:38 }",
       "{ fp64_add:163 fp64_mul:201 fp64_div:14 fp64_sqrt:7 fp64_sincos:1 int16_alu:23 move:79 }"},
      {"coat", lobes_of({&Lobes::coat}), "{ fp64_add:78 fp64_mul:77 fp64_div:2 fp64_sqrt:1 move:7 }",
       "{ fp64_add:50 fp64_mul:56 fp64_div:4 fp64_sqrt:2 move:16 }",
       "{ fp64_add:94 fp64_mul:116 fp64_div:9 fp64_sqrt:4 fp64_sincos:1 int16_alu:6 move:34 }"},
      {"sheen", lobes_of({&Lobes::sheen}), "{ fp64_add:39 fp64_mul:34 fp64_div:2 move:7 }",
       "{ fp64_add:33 fp64_mul:31 fp64_div:3 fp64_sqrt:1 fp64_exp:1 fp64_log:1 move:17 }",
       "{ fp64_add:39 fp64_mul:42 fp64_div:4 fp64_sqrt:2 fp64_sincos:1 fp64_exp:1 fp64_log:1 int16_alu:6 "
       "move:22 }"},
      {"diffuse mirror", lobes_of({&Lobes::diffuse, &Lobes::mirror}),
       "{ fp64_add:29 fp64_mul:25 fp64_div:2 move:9 }", "{ fp64_add:10 fp64_mul:16 move:10 }",
       "{ fp64_add:36 fp64_mul:46 fp64_div:3 fp64_sqrt:2 fp64_sincos:1 int16_alu:2 move:32 }"},
      {"diffuse glossy", lobes_of({&Lobes::diffuse, &Lobes::glossy}),
       "{ fp64_add:124 fp64_mul:134 fp64_div:5 fp64_sqrt:1 move:17 }",
       "{ fp64_add:56 fp64_mul:67 fp64_div:4 fp64_sqrt:2 move:14 }",
       "{ fp64_add:96 fp64_mul:122 fp64_div:8 fp64_sqrt:4 fp64_sincos:1 int16_alu:3 move:38 }"},
      {"diffuse glossy coat", lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::coat}),
       "{ fp64_add:199 fp64_mul:211 fp64_div:7 fp64_sqrt:2 move:22 }",
       "{ fp64_add:90 fp64_mul:109 fp64_div:8 fp64_sqrt:3 move:20 }",
       "{ fp64_add:136 fp64_mul:169 fp64_div:13 fp64_sqrt:5 fp64_sincos:1 int16_alu:8 move:51 }"},
      {"diffuse glossy sheen", lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::sheen}),
       "{ fp64_add:161 fp64_mul:169 fp64_div:7 fp64_sqrt:1 move:23 }",
       "{ fp64_add:77 fp64_mul:87 fp64_div:7 fp64_sqrt:2 fp64_exp:1 fp64_log:1 move:21 }",
       "{ fp64_add:121 fp64_mul:145 fp64_div:11 fp64_sqrt:4 fp64_sincos:1 fp64_exp:1 fp64_log:1 int16_alu:10 "
       "move:48 }"},
      {"diffuse glossy glass", lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror, &Lobes::glass}),
       "{ fp64_add:131 fp64_mul:135 fp64_div:6 fp64_sqrt:1 move:22 }",
       "{ fp64_add:59 fp64_mul:67 fp64_div:4 fp64_sqrt:2 int16_alu:3 move:24 }",
       "{ fp64_add:140 fp64_mul:164 fp64_div:11 fp64_sqrt:6 fp64_sincos:1 int16_alu:15 move:70 }"},
      {"every lobe",
       lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::mirror, &Lobes::glass, &Lobes::rough_glass,
                 &Lobes::thin_glass, &Lobes::coat, &Lobes::sheen}),
       "{ fp64_add:255 fp64_mul:254 fp64_div:12 fp64_sqrt:2 move:42 }",
       "{ fp64_add:151 fp64_mul:173 fp64_div:15 fp64_sqrt:4 fp64_exp:1 fp64_log:1 int16_alu:12 move:59 }",
       "{ fp64_add:249 fp64_mul:295 fp64_div:23 fp64_sqrt:8 fp64_sincos:1 fp64_exp:1 fp64_log:1 int16_alu:40 "
       "move:122 }"},
  };
  return all;
}

TEST_F(MaterialsCost, InstructionsOfEachLobe) {
  for (const Cost& cost : costs()) {
    BsdfConfig config;
    config.lobes = cost.lobes;
    EXPECT_EQ(text_of(issued_by_prepare(config)), cost.prepare) << cost.name << ": prepare";
    EXPECT_EQ(text_of(issued_by_evaluate(config)), cost.evaluate) << cost.name << ": evaluate";
    EXPECT_EQ(text_of(issued_by_sample(config)), cost.sample) << cost.name << ": sample";
  }
}

/// Purely diffuse scenes cost what sampling the cosine costs, and not one instruction more.
TEST_F(MaterialsCost, DiffuseAloneCostsTheSampleOfTheCosine) {
  BsdfConfig config;
  config.lobes.diffuse = true;
  const cn::IssueCounts cosine = issued_by([&] { path_tracer::sample_cosine({0.0, 0.0, 1.0}, 0.25, 0.75); });
  EXPECT_EQ(issued_by_prepare(config), cn::IssueCounts{});
  EXPECT_EQ(issued_by_sample(config), cosine);
}

/// What a vertex issues whose PEs all have a purely diffuse material, in a program with more lobes.
TEST_F(MaterialsCost, AbsentLobesAreSkipped) {
  BsdfConfig config;
  config.lobes = lobes_of({&Lobes::diffuse, &Lobes::glossy, &Lobes::coat, &Lobes::sheen});
  MonoMaterial diffuse;
  diffuse.f0 = diffuse.f90 = 0;
  const auto issued_by_vertex = [&] {
    return issued_by([&] {
      const path_tracer::Bsdf bsdf = prepare(config, diffuse, MonoPoint{});
      sample(bsdf, {0.25, 0.75}, 0.5);
    });
  };
  const cn::IssueCounts all = issued_by_vertex();
  config.skips_absent_lobes = true;
  const cn::IssueCounts skipped = issued_by_vertex();
  EXPECT_EQ(text_of(skipped),
            "{ fp64_add:92 fp64_mul:84 fp64_div:4 fp64_sqrt:3 fp64_sincos:1 int16_alu:16 move:53 enable:22 "
            "reduce:11 }");
  EXPECT_EQ(text_of(all),
            "{ fp64_add:397 fp64_mul:439 fp64_div:25 fp64_sqrt:7 fp64_sincos:1 fp64_exp:1 fp64_log:1 "
            "int16_alu:15 move:89 }");
}

TEST_F(MaterialsCost, TransmittanceCostsThreeExponentials) {
  EXPECT_EQ(issued_by([&] {
              path_tracer::transmittance({1.0, 2.0, 3.0}, 0.5);
            }),
            counts({{InstructionClass::fp64_add, 1},
                    {InstructionClass::fp64_mul, 3},
                    {InstructionClass::fp64_exp, 3}}));
}

/// Every flag of Lobes is in the table once.
TEST_F(MaterialsCost, TheTableListsEveryLobe) {
  EXPECT_EQ(path_tracer::kLobeTable.size(), sizeof(Lobes));
  Lobes lobes;
  for (const path_tracer::LobeDescription& description : path_tracer::kLobeTable) {
    EXPECT_FALSE(lobes.*description.member) << description.name;
    lobes.*description.member = true;
    EXPECT_FALSE(description.meaning.empty() || description.gltf.empty() || description.mtl.empty());
  }
}

}  // namespace bsdf_cost_test
