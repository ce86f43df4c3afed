// What sources and pages cite can be found in the project: sections, sources of facts, files, links. This
// file breaks such references on purpose and is not followed itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "tests/docs/references.hpp"

namespace references_test {

using test_support::BrokenReference;
using test_support::FollowedReferences;
using test_support::Page;
using test_support::ReferenceChecker;

const ReferenceChecker& project() {
  static const ReferenceChecker checker(CSX600_SOURCE_DIR);
  return checker;
}

/// What is broken in a text that stands in a source of the model.
std::vector<BrokenReference> broken_in_source(const std::string& text) {
  return project().follow("model/config/planted.cpp", text).broken;
}
std::vector<BrokenReference> broken_in_page(const std::string& text) {
  return project().follow("docs/planted.md", text).broken;
}

TEST(References, LeadSomewhere) {
  int followed = 0;
  for (const std::string& file : project().files()) {
    const FollowedReferences references = project().follow_file(file);
    followed += references.followed;
    for (const BrokenReference& broken : references.broken)
      ADD_FAILURE() << broken.file << ":" << broken.line << ": " << broken.reference << ": "
                    << broken.problem;
  }
  RecordProperty("followed", followed);
  std::printf("%d references followed\n", followed);
  EXPECT_GT(followed, 1000);
}

TEST(References, AreSoughtInEveryRoomAndPage) {
  const std::vector<std::string> files = project().files();
  for (const char* file :
       {"README.md", "CMakeLists.txt", "docs/csx600.md", "firmware/cn/machine.hpp", "model/csx600.cpp",
        "testbench/main.cpp", "tests/model/chip_config_test.cpp", "sweeps/README.md"})
    EXPECT_TRUE(std::binary_search(files.begin(), files.end(), file)) << file;
}

TEST(References, ReadmeHasAtMost150Lines) {
  std::ifstream readme(CSX600_SOURCE_DIR "/README.md");
  ASSERT_TRUE(readme);
  EXPECT_LE(std::count(std::istreambuf_iterator<char>(readme), {}, '\n'), 150);
}

TEST(ReferenceChecker, FindsWhatLeadsNowhereInASource) {
  for (const char* text :
       {"// Too fast [reference, section 99].", "// [reference,\n// section 77]", "\"clock [S99]\"",
        "\"clock \"\n    \"[S5, S98]\"", "\"energy [Nobody]\"", "// (paper, section 9)",
        "// As the paper's section 3.9 has it.", "// (paper, figure 12)", "// csx600.md, section 6.9",
        "// docs/design.md, section 77", "// docs/design.md, invariant 17", "// (section 4.1)",
        "// design.md, sections 7 and 70", "// see docs/nowhere.md", "// (README, \"Nonsense\")",
        "// docs/paper.md, \"Unknown slips\"", "// in tests/renders/nowhere_test.cpp",
        "#include \"model/nowhere.hpp\""}) {
    EXPECT_EQ(broken_in_source(text).size(), 1U) << text;
  }
}

TEST(ReferenceChecker, FindsWhatLeadsNowhereInAPage) {
  for (const char* text :
       {"[a page](nowhere.md)", "![a picture](../waves/nowhere.png)", "[a heading](paper.md#nowhere)",
        "[a heading here](#nowhere)", "`csx600 sweep sweeps/nowhere.toml`", "    ninja model/nowhere",
        "stated by [S99]", "[facts](csx600.md), section 66", "([paper.md](paper.md), \"Unknown slips\")"}) {
    EXPECT_GE(broken_in_page(text).size(), 1U) << text;
  }
}

TEST(ReferenceChecker, SaysWhereAndWhat) {
  const auto broken = broken_in_source("int a;\n\n// A fact\n// [reference, section 99].\n");
  ASSERT_EQ(broken.size(), 1U);
  EXPECT_EQ(broken[0].file, "model/config/planted.cpp");
  EXPECT_EQ(broken[0].line, 4);
  EXPECT_EQ(broken[0].reference, "reference, section 99");
  EXPECT_EQ(broken[0].problem, "docs/csx600.md has no such section");
}

TEST(ReferenceChecker, FollowsWhatLeadsSomewhere) {
  for (const char* text :
       {"// [reference, section 6.2]", "\"clock [S5]\"", "\"energy [Horowitz]\"", "// (paper, section 3.3)",
        "// the paper's section 5", "// (paper, figure 1)", "// docs/csx600.md, section 1",
        "// docs/design.md, invariant 4", "// docs/paper.md, \"Known slips\"", "// (README, \"Design\")",
        "#include \"model/csx600.hpp\""}) {
    const FollowedReferences references = project().follow("model/config/planted.cpp", text);
    EXPECT_GE(references.followed, 1) << text;
    EXPECT_TRUE(references.broken.empty()) << text;
  }
}

TEST(ReferenceChecker, LeavesPublicationsAndTheWebAlone) {
  const FollowedReferences source = project().follow(
      "model/config/planted.cpp", "// Burley 2020, section 2; IEEE 1364, section 18; glTF 2.0, section 3.10");
  EXPECT_EQ(source.followed, 0);
  const FollowedReferences page =
      project().follow("docs/planted.md", "[web](https://example.org/a.html)\n\n    [](int a) {}\n");
  EXPECT_EQ(page.followed, 0);
}

TEST(ReferenceChecker, ReadsWhatAPageOffers) {
  const Page page = test_support::parse_page(
      "# A page\n\n## 7. Rules\n\n1. one\n2. two\n\n### 7.1 Small print\n\n### Section 8: On_figures, too\n\n"
      "Figure 3\n\n| id | title |\n|---|---|\n| S5 | five |\n\n| word | no |\n|---|---|\n| S6 | no source "
      "|\n");
  EXPECT_EQ(page.sections, (std::set<std::string>{"7", "7.1", "8"}));
  EXPECT_EQ(page.items, (std::set<std::string>{"1", "2"}));
  EXPECT_EQ(page.figures, (std::set<std::string>{"3"}));
  EXPECT_EQ(page.sources.count("S5"), 1U);
  EXPECT_EQ(page.sources.count("S6"), 0U);
  EXPECT_EQ(page.headings.count("Small print"), 1U);
  EXPECT_EQ(page.anchors.count("7-rules"), 1U);
  EXPECT_EQ(page.anchors.count("section-8-on_figures-too"), 1U);
}

}  // namespace references_test
