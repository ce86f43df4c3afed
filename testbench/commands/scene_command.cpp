#include <cstdio>
#include <map>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/scene/generated_scene.hpp"
#include "testbench/scene/save_scene.hpp"

namespace testbench {
namespace {

struct SceneCommand {
  GeneratedScene kind = GeneratedScene::blob;
  int triangles = 10000;
  std::string output;

  void run() const {
    const Scene scene = generate_scene(kind, triangles);
    save_scene(scene, output);
    std::printf("%s: %zu triangles\n", output.c_str(), scene.triangles.size());
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
  command.add_option("-o,--output", state->output, "Directory to write")->type_name("DIRECTORY")->required();
  command.callback([state] { state->run(); });
}

}  // namespace testbench
