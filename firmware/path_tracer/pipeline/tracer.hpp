#pragma once

#include <functional>

#include "firmware/path_tracer/program/layout.hpp"
#include "firmware/path_tracer/program/run_counts.hpp"
#include "firmware/path_tracer/stages/transfer_ring.hpp"

namespace path_tracer {

/// A main program of the firmware: traces the paths of its work, and hands their light to the host.
class Tracer {
 public:
  Tracer() = default;
  virtual ~Tracer() = default;
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Called between steps with the camera paths issued so far; returns false to let no further path
  /// begin: the run ends when those under way have.
  using Progress = std::function<bool(std::uint64_t paths_issued)>;

  virtual void run(const Progress& progress) = 0;
  virtual const RunCounts& counts() const = 0;
};

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

}  // namespace path_tracer
