#pragma once

#include <functional>
#include <memory>

#include "firmware/path_tracer/pipeline/ray_search.hpp"
#include "firmware/path_tracer/program/work.hpp"

namespace path_tracer {

/// A main program of the firmware: traces the paths of its work, and hands their light to the host.
class Tracer {
 public:
  Tracer() = default;
  virtual ~Tracer() = default;
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Called between steps with the camera paths issued so far; returns false to stop early.
  using Progress = std::function<bool(std::uint64_t paths_issued)>;

  virtual void run(const Progress& progress) = 0;
  virtual const RunCounts& counts() const = 0;
};

/// The program that the configuration asks for (ProgramConfig::paths).
/// @param machine has the scene image of `layout` in mono memory
/// @throws ProgramError, cn::PolyMemoryOverflow
std::unique_ptr<Tracer> make_tracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                                    const Layout& layout, const Work& work);

// What all main programs begin with.

/// The configuration for the layout's scene. Throws ProgramError.
ProgramConfig built_for(const Layout& layout, ProgramConfig config);
/// Takes the host's semaphores and the stack's SRAM.
cn::Machine& with_semaphores_and_stack(cn::Machine& machine);
/// Loads and saves of one pipeline.
struct Rings {
  TransferRing loads;
  TransferRing saves;
};
/// @param load_bytes, save_bytes of the stages, besides what the ray search takes
Rings make_rings(cn::Machine& machine, const ProgramConfig& config, const Layers& layers, int load_bytes,
                 int save_bytes);
std::unique_ptr<RaySearch> make_search(const StageContext& context);

}  // namespace path_tracer
