#include "testbench/passes/pass_message.hpp"

#include <cstring>
#include <type_traits>

namespace testbench {

void take_work(const PassWork& work, RenderOptions& options) {
  options.camera_samples = work.list;
  options.work = work.list.empty() ? work.work : path_tracer::Work{};
}

std::string to_message(const PassWork& work) {
  static_assert(std::is_trivially_copyable_v<path_tracer::Work> &&
                std::is_trivially_copyable_v<path_tracer::CameraSampleRecord>);
  const std::size_t list_bytes = work.list.size() * sizeof(path_tracer::CameraSampleRecord);
  std::string message(sizeof(work.work) + list_bytes, '\0');
  std::memcpy(message.data(), &work.work, sizeof(work.work));
  if (list_bytes > 0) std::memcpy(message.data() + sizeof(work.work), work.list.data(), list_bytes);
  return message;
}

PassWork work_of(const std::string& message) {
  PassWork work;
  std::memcpy(&work.work, message.data(), sizeof(work.work));
  const std::size_t list_bytes = message.size() - sizeof(work.work);
  work.list.resize(list_bytes / sizeof(path_tracer::CameraSampleRecord));
  if (list_bytes > 0) std::memcpy(work.list.data(), message.data() + sizeof(work.work), list_bytes);
  return work;
}

}  // namespace testbench
