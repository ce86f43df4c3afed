// A firmware with one fault of the kind that is asked for. Without a fault it doubles the numbers of a
// buffer.

#include <cstdio>
#include <numeric>

#include "firmware/plug_in/firmware.hpp"

namespace {

enum Fault {
  kNone,
  kWrongResult,
  kRace,
  kDeadlock,
  kTooMuchSram,
  kBadOptions,
  kTooMuchMono,
  kEndless,
  kThrows,
  kThrowsANumber,
  kLeavesSram,
  kReadsNull,
  kPrints,
};

struct Arguments {
  cn::PolyField<double> number;
  int fault = kNone;
};

void misbehave(int fault) {
  if (fault == kEndless)
    for (volatile int i = 0;; i = i + 1) {
    }
  if (fault == kThrows) throw std::runtime_error("a kernel has thrown");
  if (fault == kThrowsANumber) throw 42;
  if (fault == kPrints) std::puts("printed by a kernel");
  volatile int* const null = nullptr;
  if (fault == kReadsNull) *null = 1;
}

void twice(const Arguments& arguments) {
  misbehave(arguments.fault);
  if (arguments.fault == kLeavesSram) cn::PolyField<double>{6144}.write(cn::poly<double>(1.0));
  arguments.number.write(arguments.number.read() * 2.0);
}

class Faults : public plug_in::Firmware {
 public:
  Faults() : Firmware("faults", "doubles numbers") {}

  void prepare(int num_pes) override {
    if (fault_ == kBadOptions) throw plug_in::OptionError("fault: found 5, allowed is anything else");
    numbers_.resize(fault_ == kTooMuchMono ? std::size_t{1} << 20 : std::size_t(num_pes));
    std::iota(numbers_.begin(), numbers_.end(), 0.0);
  }

  void run(cn::Machine& machine) override {
    const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
    const cn::PolySpan number = machine.poly_memory().allocate("number", sizeof(double));
    if (fault_ == kTooMuchSram) machine.poly_memory().allocate("too much", 1 << 16);
    const cn::Semaphore copied = machine.allocate_semaphore("copied");
    const cn::MonoPlaces places = cn::MonoPlaces::array(numbers_.mono().address, sizeof(double));
    machine.async_copy_m2p(copied, number, places, all);
    if (fault_ != kRace) machine.sem_wait(copied);
    machine.run(cn::kernel<Arguments, twice>("twice"), {{number.offset_bytes}, fault_}, all);
    if (fault_ == kRace) machine.sem_wait(copied);
    machine.async_copy_p2m(copied, places, number, all);
    machine.sem_wait(copied);
    if (fault_ == kDeadlock) machine.sem_wait(copied);
  }

  void check() const override {
    sum_.set(0);
    for (const double number : numbers_) sum_.set(sum_.value() + number);
    for (std::size_t i = 0; i < numbers_.size(); ++i)
      if (numbers_[i] != (fault_ == kWrongResult ? 3.0 : 2.0) * double(i))
        throw plug_in::CheckFailed("number " + std::to_string(i) + " is wrong");
  }

 private:
  plug_in::Option<int> fault_{*this, "fault", kNone, {kNone, kPrints}, "which fault"};
  plug_in::Counter sum_{*this, "sum", "-", "of the numbers, doubled"};
  plug_in::MonoBuffer<double> numbers_{*this, "numbers", plug_in::Use::upload_and_download};
};

}  // namespace

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  return std::make_unique<Faults>();
}
