#include "model/pio/pio_queue.hpp"

#include <algorithm>

namespace model {

PioQueue::PioQueue(PioArbitration arbitration, int depth)
    : arbitration_(arbitration), depth_(std::size_t(depth)) {
  for (Engine& engine : engine_) engine.queue.reserve(depth_);
}

bool PioQueue::full(cn::Direction direction) const {
  return engine_[std::size_t(engine_of(direction))].queue.size() >= depth_;
}

void PioQueue::push(const Entry& entry) {
  engine_[std::size_t(engine_of(entry.direction))].queue.push_back(entry);
}

std::optional<PioQueue::Start> PioQueue::next() const {
  std::optional<Start> earliest;
  for (const Engine& engine : engine_) {
    if (engine.queue.empty()) continue;
    const Start start = next_of(engine);
    if (!earliest || start.cycle < earliest->cycle ||
        (start.cycle == earliest->cycle && start.entry.id < earliest->entry.id))
      earliest = start;
  }
  return earliest;
}

PioQueue::Start PioQueue::next_of(const Engine& engine) const {
  const Entry& oldest = engine.queue.front();
  const Cycles cycle = std::max(engine.free, oldest.enqueued);
  if (arbitration_ == PioArbitration::reads_overtake_writes) {
    const auto read = std::find_if(engine.queue.begin(), engine.queue.end(), [&](const Entry& entry) {
      return entry.direction == cn::Direction::mono_to_poly && entry.enqueued < cycle;
    });
    if (read != engine.queue.end()) return {*read, cycle};
  }
  return {oldest, cycle};
}

void PioQueue::begin(const Start& start, Cycles finish) {
  Engine& engine = engine_[std::size_t(engine_of(start.entry.direction))];
  engine.queue.erase(std::find_if(engine.queue.begin(), engine.queue.end(),
                                  [&](const Entry& entry) { return entry.id == start.entry.id; }));
  engine.free = finish;
}

}  // namespace model
