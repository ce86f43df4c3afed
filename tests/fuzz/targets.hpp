#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace fuzz {

/// What reads one kind of input. An input is read in the current directory, which holds nothing else.
struct Target {
  std::string_view name;  ///< of its folders in corpus/ and regressions/, and of dictionaries/NAME.dict
  void (*read)(std::string_view input);
};

/// Every target.
const std::vector<Target>& targets();

/// nullptr for an unknown name.
const Target* find_target(std::string_view name);

/// Has the target read an input. Returns what the program would tell its user in one line, which is as good
/// as success, or "". Any other exception passes.
std::string read_input(const Target& target, std::string_view input);

/// Ends the process: a reader's result contradicts itself. libFuzzer keeps the input.
[[noreturn]] void fail(const char* what);

// Meshes, each opened as a scene. Of several files, which a line "====" parts, the first names the others.
void read_obj(std::string_view input);   ///< mesh.obj, materials.mtl
void read_mtl(std::string_view input);   ///< the text of a file
void read_ply(std::string_view input);   ///< mesh.ply
void read_gltf(std::string_view input);  ///< mesh.gltf, buffer.bin
void read_glb(std::string_view input);   ///< mesh.glb
/// Six bytes and a packed buffer view; see gltf_compression_target.cpp.
void read_meshopt(std::string_view input);
void read_draco(std::string_view input);  ///< a packed mesh
void read_scene(std::string_view input);  ///< scene.toml, mesh.obj

// Settings.
void read_chip(std::string_view input);          ///< chip.toml
void read_sweep(std::string_view input);         ///< sweep.toml, chip.toml
void read_golden_grid(std::string_view input);   ///< grid.toml, chip.toml
void read_command_line(std::string_view input);  ///< one word a line

// Results.
void read_golden_table(std::string_view input);  ///< a golden table
void read_statistics(std::string_view input);    ///< two statistics files
void read_points(std::string_view input);        ///< points.jsonl
void read_report(std::string_view input);        ///< sweep.json or a statistics file
void read_exr(std::string_view input);           ///< image.exr

void read_message(std::string_view input);  ///< what a message quotes

}  // namespace fuzz
