#pragma once

#include <string>
#include <vector>

#include "model/faults/fault.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// A fault as text: its kind, then key=value: "poly_sram,cycle=1000,pe=5,address=0x40,bit=3". Numbers are
/// decimal or hexadecimal. Throws InputError for an unknown kind or key, a key that the kind does not have or
/// lacks, and a number that is none.
model::Fault fault_of(const std::string& text);
/// The text that fault_of() reads as this fault.
std::string text_of(const model::Fault& fault);

/// Throws InputError where a fault's place is not on the chip, or the run is one that takes no faults.
void require_faults(const RenderOptions& options);

/// The kinds' names, joined by ", ".
std::string fault_kind_names();
/// Throws InputError for a name that is none.
model::FaultKind fault_kind_of(const std::string& name);

}  // namespace testbench
