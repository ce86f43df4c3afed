#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "firmware/cn/chip/instruction.hpp"
#include "firmware/cn/chip/transfer.hpp"
#include "firmware/cn/machine.hpp"

namespace testbench {

/// The calls that one firmware made to its machine in timed code, without their data: kernels with their
/// issued instructions, mono instructions, transfers with their places, semaphores, reads and writes of the
/// control unit. Control flow depends on data alone, never on a clock. So every chip with the same number of
/// PEs and the same image of mono memory would see this stream, and its timing can be computed without
/// executing a kernel.
///
/// Streams are compact: a call is a byte and a few numbers of variable length; issued instructions that
/// repeat are stored once; places are stored for enabled PEs only.
class TimingStream {
 public:
  struct PolyBuffer {
    std::string name;
    int bytes = 0;
    bool operator==(const PolyBuffer& other) const { return name == other.name && bytes == other.bytes; }
  };

  int num_pes = 0;
  std::vector<std::string> semaphores;   ///< by number
  std::vector<PolyBuffer> poly_buffers;  ///< in the order of allocation
  std::vector<std::string> kernels;      ///< names, in the order of their first run
  std::vector<cn::IssueCounts> issued;   ///< distinct counts, in the order of their first use
  std::vector<std::uint8_t> calls;

  bool operator==(const TimingStream& other) const;

  /// Makes the same calls to `machine`, in place of its firmware. Transfers move whatever its poly memory
  /// holds. The machine must have num_pes PEs and no allocated semaphore.
  void replay(cn::Machine& machine) const;
};

/// Appends calls to a stream.
class TimingStreamWriter {
 public:
  explicit TimingStreamWriter(TimingStream& stream) : stream_(stream) {}

  /// @param kernel a string literal; kernels are distinguished by its address, as in the chip's statistics
  void kernel(const char* kernel, const cn::IssueTree& issued);
  void transfer(const cn::Transfer& transfer);
  void mono(std::uint64_t instructions);
  void signal(cn::Semaphore semaphore);
  void wait(cn::Semaphore semaphore);
  void read(cn::MonoAddress from, std::uint64_t bytes);
  /// Throws cn::MachineFault unless `size` is 8.
  void write(cn::MonoAddress to, const void* bytes, std::uint64_t size);

 private:
  std::uint64_t number_of(const cn::IssueCounts& counts);
  std::uint64_t number_of(const char* kernel);

  TimingStream& stream_;
  std::vector<const char*> kernels_;
  std::map<decltype(cn::IssueCounts::by_class), std::uint64_t> numbers_;
};

}  // namespace testbench
