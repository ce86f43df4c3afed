#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace test_support {

/// The result of a run of the program.
struct CommandResult {
  int exit_code = -1;  ///< -1 if a signal ended the program
  std::string out;
  std::string error;

  std::vector<std::string> error_lines() const;
};

/// Runs the csx600 of this build in a new, empty directory, which the destructor removes.
class CommandLineFixture : public testing::Test {
 protected:
  CommandLineFixture();
  ~CommandLineFixture() override;

  CommandResult run(const std::vector<std::string>& arguments);

  /// Runs the program. Its output goes to files outside the directory.
  pid_t start(const std::vector<std::string>& arguments);
  CommandResult finish(pid_t child);

  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;
  /// Names of all files in the directory, sorted.
  std::vector<std::string> files() const;

  const std::filesystem::path& directory() const { return directory_; }

 private:
  std::filesystem::path directory_;
};

/// Writes a scene with one emitting triangle, seen from the front: scene.toml, mesh.obj and mesh.mtl.
struct SceneFiles {
  std::string toml =
      "[camera]\nposition = [0, 0, 5]\nlook_at = [0, 0, 0]\nvertical_fov_degrees = 40\n"
      "[film]\nwidth = 8\nheight = 6\n[[mesh]]\nfile = \"mesh.obj\"\n";
  std::string obj = "mtllib mesh.mtl\nv -1 -1 0\nv 1 -1 0\nv 0 1 0\nusemtl light\nf 1 2 3\n";
  std::string mtl = "newmtl light\nKd 0.5 0.5 0.5\nKe 1 2 3\n";
};

}  // namespace test_support
