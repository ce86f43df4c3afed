#include "tests/fuzz/targets.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>

#include "model/config/chip_parameters.hpp"
#include "model/waves/wave_selection.hpp"
#include "testbench/system/error.hpp"

namespace fuzz {

const std::vector<Target>& targets() {
  static const std::vector<Target> all = {{"obj", read_obj},
                                          {"mtl", read_mtl},
                                          {"ply", read_ply},
                                          {"gltf", read_gltf},
                                          {"glb", read_glb},
                                          {"meshopt", read_meshopt},
                                          {"draco", read_draco},
                                          {"scene", read_scene},
                                          {"chip", read_chip},
                                          {"sweep", read_sweep},
                                          {"golden_grid", read_golden_grid},
                                          {"command_line", read_command_line},
                                          {"golden_table", read_golden_table},
                                          {"statistics", read_statistics},
                                          {"points", read_points},
                                          {"report", read_report},
                                          {"exr", read_exr},
                                          {"message", read_message}};
  return all;
}

const Target* find_target(std::string_view name) {
  for (const Target& target : targets())
    if (target.name == name) return &target;
  return nullptr;
}

std::string read_input(const Target& target, std::string_view input) {
  try {
    target.read(input);
    return "";
  } catch (const testbench::InputError& error) {
    return error.what();
  } catch (const testbench::RunError& error) {
    return error.what();
  } catch (const model::ConfigError& error) {
    return error.what();
  } catch (const model::WaveError& error) {
    return error.what();
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

void fail(const char* what) {
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

}  // namespace fuzz
