#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/scene_file/save_scene.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

struct SceneCommand {
  GeneratedScene kind = GeneratedScene::blob;
  int triangles = 10000;
  std::string output;
  bool force = false;

  void run() const {
    if (!force) require_no_scene();
    const Scene scene = generate_scene(kind, triangles);
    const Notes notes = save_scene(scene, output);
    std::printf("%s: %zu triangles\n", output.c_str(), scene.triangles.size());
    for (const std::string& line : notes.lines()) print_note(line);
  }

 private:
  void require_no_scene() const {
    for (const char* const name : kSavedSceneFiles)
      if (const std::filesystem::path file = std::filesystem::path(output) / name;
          std::filesystem::exists(std::filesystem::symlink_status(file)))
        throw InputError("--output: found " + file.string() +
                         ", which is there already; allowed is a directory without a scene, or --force to "
                         "replace it");
  }
};

}  // namespace

void add_scene_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("scene", "Generate a scene of any number of triangles");
  const auto state = std::make_shared<SceneCommand>();
  std::map<std::string, GeneratedScene> kinds;
  for (const GeneratedScene kind : kGeneratedScenes) kinds[name_of(kind)] = kind;
  one_of(command.add_option("kind", state->kind, "What it shows"), kinds)->required();
  in_range(command.add_option("--triangles", state->triangles, "About how many"), kLeastGeneratedTriangles,
           kMostGeneratedTriangles)
      ->capture_default_str();
  command.add_option("-o,--output", state->output, "Directory to write")
      ->check(error_of_no_file, "")
      ->type_name("DIRECTORY")
      ->required();
  command.add_flag("--force", state->force, "Replace a scene that is there already");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
