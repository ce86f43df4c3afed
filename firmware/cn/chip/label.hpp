#pragma once

namespace cn {

/// What kernels and requests belong to, as the firmware says for those who observe a run: one block of one of
/// its bins. It costs no cycle and changes nothing. `bin` is a string literal, null for what belongs to none.
struct Label {
  const char* bin = nullptr;
  int block = -1;
};

}  // namespace cn
