#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "testbench/run/render.hpp"

namespace testbench {

/// What one render is called and was asked to do, for its outputs.
struct RenderRequest {
  std::string scene;
  RenderOptions options;
  bool native = false;
  std::string traversal_reason = {};  ///< why the traversal was chosen; empty when the user gave it
  std::size_t triangles = 0;          ///< of the scene with lights that were added; 0: not said
  std::string importance = {};        ///< file of the importance map, if there is one
  bool in_own_process = false;        ///< of one of several renders: SystemC elaborates once a process
};

/// The statistics file. Everything but the section `simulator` is the same for the same inputs, byte for
/// byte.
nlohmann::ordered_json render_statistics(const RenderRequest& request, const RenderResult& result);

/// The same as a small table for people.
std::string render_table(const RenderRequest& request, const RenderResult& result);

/// What made the image, for its header.
std::map<std::string, std::string> render_provenance(const RenderRequest& request,
                                                     const RenderResult& result);

}  // namespace testbench
