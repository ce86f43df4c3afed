#include "firmware/examples/firmwares.hpp"
#include "firmware/examples/pio_sweep.hpp"
#include "firmware/plug_in/random.hpp"

namespace examples {
namespace {

constexpr std::uint64_t kPacketBytes = 64;

class PioSweepFirmware : public plug_in::Firmware {
 public:
  PioSweepFirmware() : Firmware("PIO sweep", "the same transfer again and again, each waited for") {}

  void prepare(int num_pes) override {
    if (pes_ > num_pes)
      throw plug_in::OptionError("pes: found " + std::to_string(pes_) + ", allowed are at most the chip's " +
                                 std::to_string(num_pes));
    for (const auto* const option : {&bytes_, &offset_})
      if (*option % 8 != 0)
        throw plug_in::OptionError(option->name() + ": found " + std::to_string(*option) +
                                   ", allowed is a multiple of 8");
    taking_part_ = pes_ > 0 ? int(pes_) : num_pes;
    for (plug_in::MonoBuffer<std::uint8_t>* const buffer : {&source_, &copy_})
      buffer->resize(std::size_t(offset_) + std::size_t(taking_part_) * std::size_t(stride_bytes()));
    for (std::size_t i = 0; i < source_.size(); ++i) source_[i] = std::uint8_t(256 * plug_in::random_of(i));
  }
  /// Transfers of the other direction take no time: they are there for the check.
  void run(cn::Machine& machine) override {
    PioSweep sweep(machine, bytes_);
    const auto load = [&](int repeats) { sweep.load(pattern(source_), repeats); };
    const auto save = [&](int repeats) { sweep.save(pattern(copy_), repeats); };
    if (saves_ == 0) {
      load(repeats_);
      const cn::Untimed untimed(machine);
      save(1);
    } else {
      {
        const cn::Untimed untimed(machine);
        load(1);
      }
      save(repeats_);
    }
  }
  void check() const override {
    for (int pe = 0; pe < taking_part_; ++pe)
      for (int byte = 0; byte < bytes_; ++byte) {
        const std::size_t at =
            std::size_t(offset_) + std::size_t(pe) * std::size_t(stride_bytes()) + std::size_t(byte);
        if (copy_[at] != source_[at])
          throw plug_in::CheckFailed("byte " + std::to_string(byte) + " of PE " + std::to_string(pe) +
                                     " came back changed");
      }
  }
  plug_in::Work work() const override { return {double(taking_part_) * bytes_ * repeats_, "bytes"}; }

 private:
  /// Pieces lie apart, each at the same offset within a packet.
  std::uint64_t stride_bytes() const { return (std::uint64_t(bytes_) / kPacketBytes + 2) * kPacketBytes; }
  PioSweep::Pattern pattern(const plug_in::MonoBuffer<std::uint8_t>& buffer) const {
    return {taking_part_, bytes_, buffer.mono().address + std::uint64_t(offset_), stride_bytes()};
  }

  int taking_part_ = 0;
  plug_in::Option<int> pes_{*this, "pes", 0, {0, 4096}, "PEs that take part, the first ones; 0: all"};
  plug_in::Option<int> bytes_{*this, "bytes", 80, {8, 4096}, "a PE and transfer, a multiple of 8"};
  plug_in::Option<int> offset_{*this, "offset", 0, {0, 56}, "bytes of each piece from the start of a packet"};
  plug_in::Option<int> repeats_{*this, "repeats", 16, {1, 100000}, "transfers"};
  plug_in::Option<int> saves_{*this, "saves", 0, {0, 1}, "0: transfers load, 1: they save"};
  plug_in::MonoBuffer<std::uint8_t> source_{*this, "source", plug_in::Use::upload};
  plug_in::MonoBuffer<std::uint8_t> copy_{*this, "copy", plug_in::Use::download};
};

}  // namespace

std::unique_ptr<plug_in::Firmware> make_pio_sweep() {
  return std::make_unique<PioSweepFirmware>();
}

}  // namespace examples
