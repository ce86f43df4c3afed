#include "testbench/machine/timing_stream.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "testbench/machine/stream_bytes.hpp"

namespace testbench {
namespace {

enum class Call : std::uint8_t {
  kernel,
  load_array,  ///< places computed from the PE number
  save_array,
  load_each,  ///< one place per PE
  save_each,
  mono,
  signal,
  wait,
  read,
  write,
};

constexpr std::uint64_t kWriteBytes = sizeof(std::uint64_t);

std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

template <class T>
std::uint64_t bits_of(T value) {
  return static_cast<std::uint64_t>(value);
}

/// Arguments of the replayed kernel: where its issued instructions are recorded.
struct KernelArguments {
  const TimingStream* stream;
  ByteReader* calls;
};

/// Stands in for a kernel: issues the recorded instructions without computing. The recorded nodes become
/// iterations of one region, in the order of their visits, so that sums over them round as in the recorded
/// run.
void issue_again(const KernelArguments& arguments, cn::PolyMemory&, const cn::LaneMask&,
                 cn::IssueTree& issued) {
  const std::uint64_t nodes = arguments.calls->number();
  issued.clear();
  for (std::uint64_t i = 0; i < nodes; ++i) {
    cn::IssueTree::Node& node = i == 0 ? issued.root() : issued.node(issued.root(), 0, i - 1);
    node.counts = arguments.stream->issued[arguments.calls->number()];
    node.enabled_lanes = arguments.calls->number();
    node.reached = true;
  }
}

/// Makes the calls of one stream to one machine.
class Replay {
 public:
  Replay(const TimingStream& stream, cn::Machine& machine)
      : stream_(stream), machine_(machine), calls_(as_text(stream.calls)) {
    if (machine.num_pes() != stream.num_pes)
      throw RunError("a stream of " + std::to_string(stream.num_pes) + " PEs cannot be replayed on " +
                     std::to_string(machine.num_pes()));
  }

  void run() {
    for (const std::string& name : stream_.semaphores) machine_.allocate_semaphore(name);
    for (const TimingStream::PolyBuffer& buffer : stream_.poly_buffers)
      machine_.poly_memory().allocate(buffer.name, buffer.bytes);
    while (!calls_.at_end()) make(Call{calls_.byte()});
  }

 private:
  void make(Call call) {
    switch (call) {
      case Call::kernel:
        return kernel();
      case Call::load_array:
      case Call::save_array:
      case Call::load_each:
      case Call::save_each:
        return transfer(call);
      case Call::mono:
        return machine_.issue_mono(calls_.number());
      case Call::signal:
        return machine_.sem_signal(semaphore());
      case Call::wait:
        return machine_.sem_wait(semaphore());
      case Call::read:
        return read();
      case Call::write:
        return write();
    }
    throw RunError("a recorded stream has an unknown call");
  }

  cn::Semaphore semaphore() { return {static_cast<int>(calls_.number())}; }

  void kernel() {
    const cn::Kernel<KernelArguments> kernel{stream_.kernels[calls_.number()].c_str(), &issue_again};
    machine_.run(kernel, {&stream_, &calls_}, cn::LaneMask());
  }

  void transfer(Call call) {
    const cn::Semaphore done = semaphore();
    const auto offset_bytes = static_cast<int>(calls_.number());
    const auto size_bytes = static_cast<int>(calls_.number());
    const cn::LaneMask enabled = lanes();
    const bool each = call == Call::load_each || call == Call::save_each;
    const cn::MonoPlaces places = each ? each_place(enabled) : array_places();
    if (call == Call::load_array || call == Call::load_each) {
      machine_.async_copy_m2p(done, {offset_bytes, size_bytes}, places, enabled);
    } else {
      machine_.async_copy_p2m(done, places, {offset_bytes, size_bytes}, enabled);
    }
  }

  cn::LaneMask lanes() {
    cn::LaneMask mask;
    for (int strip = 0; strip < stream_.num_pes / cn::kStripLanes; ++strip)
      mask.set_strip_bits(strip, calls_.byte());
    return mask;
  }

  cn::MonoPlaces array_places() {
    const cn::MonoAddress first = calls_.number();
    return cn::MonoPlaces::array(first, calls_.number());
  }

  cn::MonoPlaces each_place(const cn::LaneMask& enabled) {
    for (int strip = 0; strip < stream_.num_pes / cn::kStripLanes; ++strip)
      for (unsigned bits = enabled.strip_bits(strip); bits != 0; bits &= bits - 1)
        places_[std::size_t(strip * cn::kStripLanes + __builtin_ctz(bits))] = calls_.number();
    return cn::MonoPlaces::each(places_.data());
  }

  void read() {
    const cn::MonoAddress from = calls_.number();
    machine_.read_mono(cn::MonoPointer<char>{from}, calls_.number());
  }

  void write() {
    const cn::MonoAddress to = calls_.number();
    std::uint64_t value = 0;
    std::memcpy(&value, calls_.text(kWriteBytes).data(), kWriteBytes);
    machine_.write_mono(cn::MonoPointer<std::uint64_t>{to}, value);
  }

  const TimingStream& stream_;
  cn::Machine& machine_;
  ByteReader calls_;
  std::array<cn::MonoAddress, cn::kMaxPes> places_{};
};

}  // namespace

void TimingStreamWriter::kernel(const char* kernel, const cn::IssueTree& issued) {
  stream_.calls.push_back(std::uint8_t(Call::kernel));
  append_number(stream_.calls, number_of(kernel));
  std::uint64_t nodes = 0;
  issued.for_each_node([&](const cn::IssueTree::Node&) { ++nodes; });
  append_number(stream_.calls, nodes);
  issued.for_each_node([&](const cn::IssueTree::Node& node) {
    append_number(stream_.calls, number_of(node.counts));
    append_number(stream_.calls, node.enabled_lanes);
  });
}

void TimingStreamWriter::transfer(const cn::Transfer& transfer) {
  const bool load = transfer.direction == cn::Direction::mono_to_poly;
  const bool each = transfer.mono.by_pe != nullptr;
  const Call call = each   ? load ? Call::load_each : Call::save_each
                    : load ? Call::load_array
                           : Call::save_array;
  std::vector<std::uint8_t>& calls = stream_.calls;
  calls.push_back(std::uint8_t(call));
  append_number(calls, bits_of(transfer.done.index));
  append_number(calls, bits_of(transfer.poly.offset_bytes));
  append_number(calls, bits_of(transfer.poly.size_bytes));
  for (int strip = 0; strip < stream_.num_pes / cn::kStripLanes; ++strip)
    calls.push_back(transfer.enabled.strip_bits(strip));
  if (!each) {
    append_number(calls, transfer.mono.first);
    append_number(calls, transfer.mono.stride_bytes);
    return;
  }
  for (int pe = 0; pe < stream_.num_pes; ++pe)
    if (transfer.enabled[pe]) append_number(calls, transfer.mono[pe]);
}

void TimingStreamWriter::mono(std::uint64_t instructions) {
  stream_.calls.push_back(std::uint8_t(Call::mono));
  append_number(stream_.calls, instructions);
}

void TimingStreamWriter::signal(cn::Semaphore semaphore) {
  stream_.calls.push_back(std::uint8_t(Call::signal));
  append_number(stream_.calls, bits_of(semaphore.index));
}

void TimingStreamWriter::wait(cn::Semaphore semaphore) {
  stream_.calls.push_back(std::uint8_t(Call::wait));
  append_number(stream_.calls, bits_of(semaphore.index));
}

void TimingStreamWriter::read(cn::MonoAddress from, std::uint64_t bytes) {
  stream_.calls.push_back(std::uint8_t(Call::read));
  append_number(stream_.calls, from);
  append_number(stream_.calls, bytes);
}

void TimingStreamWriter::write(cn::MonoAddress to, const void* bytes, std::uint64_t size) {
  if (size != kWriteBytes)
    throw cn::MachineFault("a mono write of " + std::to_string(size) + " bytes cannot be recorded, only " +
                           std::to_string(kWriteBytes));
  stream_.calls.push_back(std::uint8_t(Call::write));
  append_number(stream_.calls, to);
  const auto* const first = static_cast<const std::uint8_t*>(bytes);
  stream_.calls.insert(stream_.calls.end(), first, first + size);
}

std::uint64_t TimingStreamWriter::number_of(const cn::IssueCounts& counts) {
  const auto [entry, is_new] = numbers_.emplace(counts.by_class, stream_.issued.size());
  if (is_new) stream_.issued.push_back(counts);
  return entry->second;
}

std::uint64_t TimingStreamWriter::number_of(const char* kernel) {
  const auto found = std::find(kernels_.begin(), kernels_.end(), kernel);
  const auto number = std::uint64_t(found - kernels_.begin());
  if (found == kernels_.end()) {
    kernels_.push_back(kernel);
    stream_.kernels.emplace_back(kernel);
  }
  return number;
}

bool TimingStream::operator==(const TimingStream& other) const {
  return num_pes == other.num_pes && semaphores == other.semaphores && poly_buffers == other.poly_buffers &&
         kernels == other.kernels && issued == other.issued && calls == other.calls;
}

void TimingStream::replay(cn::Machine& machine) const {
  Replay(*this, machine).run();
}

}  // namespace testbench
