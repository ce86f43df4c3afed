// The script that loads every mesh of a folder: its table has the triangles of each file, or why it is
// refused.

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/command_line.hpp"

namespace load_folder_test {

class LoadFolder : public test_support::CommandLineFixture {
 protected:
  /// The words of each line of the table.
  std::vector<std::vector<std::string>> table_of(const std::string& folder) const {
    const std::string file = (directory() / "table.txt").string();
    const std::string command = std::string("sh " CSX600_SOURCE_DIR "/tests/program/load_folder.sh ") +
                                CSX600_BINARY + " " + (directory() / folder).string() + " > " + file;
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::vector<std::vector<std::string>> lines;
    std::ifstream text(file);
    for (std::string line; std::getline(text, line);) {
      std::istringstream words(line);
      lines.emplace_back();
      for (std::string word; words >> word;) lines.back().push_back(word);
    }
    return lines;
  }
};

TEST_F(LoadFolder, CountsWhatIsLoadedAndSaysWhyTheRestIsNot) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\n";
  write("meshes/below/four.obj", corners + "f 1 2 3 4\nf 1 2 5\nf 1 4 5\n");
  write("meshes/flat.obj", corners + "f 1 2 3\nf 1 1 2\n");  // one has no area, a second reader counts it
  write("meshes/broken.obj", corners + "f 1 2 9\n");
  write("meshes/none.txt", "f 1 2 3\n");
  const auto table = table_of("meshes");
  ASSERT_EQ(table.size(), 5U);
  EXPECT_EQ(table[1][0], "below/four.obj");
  EXPECT_EQ(table[1][1], "4");
  EXPECT_EQ(table[1].back(), "same");
  EXPECT_EQ(table[2][0], "broken.obj");
  EXPECT_EQ(table[2][1], "refused");
  EXPECT_EQ(table[3][0], "flat.obj");
  EXPECT_EQ(table[3][1], "2");
  EXPECT_EQ(table[4][0] + table[4][1] + table[4][2] + table[4][3], "3files,2loaded,");
}

}  // namespace load_folder_test
