#pragma once

namespace cn {

/// The stage and block that kernels and requests belong to, as the firmware says for observers of a run. A
/// label costs no cycle and changes nothing. `stage` is a string literal, or null for what belongs to no
/// stage.
struct Label {
  const char* stage = nullptr;
  int block = -1;
};

}  // namespace cn
