#include <dlfcn.h>
#include <pthread.h>

#include <cstddef>
#include <cstdint>

// Linked into programs that are built with AddressSanitizer.
//
// Debian's SystemC tells AddressSanitizer when it switches coroutines, but not when a process ends and the
// main thread goes on: from then on the sanitizer takes the ended process's stack for the current one. Where
// an exception then passes through the main thread, it does not clear the marks of the frames that were left,
// and the next call reports a use after scope of what nobody has used
// (https://github.com/google/sanitizers/issues/189). So it is told the main thread's stack once more before
// each exception that is thrown there.

extern "C" void __sanitizer_start_switch_fiber(void** fake_stack, const void* bottom, std::size_t bytes);
extern "C" void __sanitizer_finish_switch_fiber(void* fake_stack, const void** bottom, std::size_t* bytes);

namespace {

struct Stack {
  void* bottom = nullptr;
  std::size_t bytes = 0;

  bool holds(const void* place) const {
    return reinterpret_cast<std::uintptr_t>(place) - reinterpret_cast<std::uintptr_t>(bottom) < bytes;
  }
};

/// Called on the main thread's own stack, before there are coroutines.
Stack stack_of_thread() {
  Stack stack;
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return stack;
  pthread_attr_getstack(&attributes, &stack.bottom, &stack.bytes);
  pthread_attr_destroy(&attributes);
  return stack;
}

const Stack main_stack = stack_of_thread();

}  // namespace

/// What compiled code calls before it throws: clears the marks of the stack above.
extern "C" __attribute__((no_sanitize("address"))) void __asan_handle_no_return() {
  const char here = 0;
  if (main_stack.holds(&here)) {
    void* fake_stack = nullptr;
    __sanitizer_start_switch_fiber(&fake_stack, main_stack.bottom, main_stack.bytes);
    __sanitizer_finish_switch_fiber(fake_stack, nullptr, nullptr);
  }
  static const auto of_sanitizer = reinterpret_cast<void (*)()>(dlsym(RTLD_NEXT, "__asan_handle_no_return"));
  of_sanitizer();
}
