// y = a x + y in single precision: 16 elements a PE and block.

#include "firmware/plug_in/firmware.hpp"

namespace {

constexpr int kElements = 16;

struct Arguments {
  cn::PolySpan x;
  cn::PolySpan y;
  float a;
};

void scale_and_add(const Arguments& arguments) {
  for (int i = 0; i < kElements; ++i) {
    const cn::PolyField<float> x{arguments.x.offset_bytes + i * 4}, y{arguments.y.offset_bytes + i * 4};
    y.write(x.read() * arguments.a + y.read());
  }
}

class Saxpy : public plug_in::Firmware {
 public:
  Saxpy() : Firmware("saxpy", "y = a x + y") {}

  void prepare(int num_pes) override {
    for (auto* buffer : {&x_, &y_}) buffer->resize(std::size_t(blocks_) * std::size_t(num_pes) * kElements);
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i] = float(i), y_[i] = 1;
  }
  void run(cn::Machine& machine) override {
    const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
    const cn::PolySpan x = machine.poly_memory().allocate("x", kElements * sizeof(float));
    const cn::PolySpan y = machine.poly_memory().allocate("y", kElements * sizeof(float));
    const cn::Semaphore copied = machine.allocate_semaphore("copied");
    for (int block = 0; block < blocks_; ++block) {
      const std::uint64_t first = std::uint64_t(block) * std::uint64_t(machine.num_pes()) * kElements;
      const auto of_pe = [&](auto array) {
        return cn::MonoPlaces::array((array + first).address, x.size_bytes);
      };
      machine.async_copy_m2p(copied, x, of_pe(x_.mono()), all);
      machine.async_copy_m2p(copied, y, of_pe(y_.mono()), all);
      for (int copy = 0; copy < 2; ++copy) machine.sem_wait(copied);
      machine.run(cn::kernel<Arguments, scale_and_add>("scale_and_add"), {x, y, float(a_)}, all);
      machine.async_copy_p2m(copied, of_pe(y_.mono()), y, all);
      machine.sem_wait(copied);
    }
  }
  void check() const override {
    for (std::size_t i = 0; i < y_.size(); ++i)
      if (y_[i] != float(a_) * float(i) + 1)
        throw plug_in::CheckFailed("saxpy: y[" + std::to_string(i) + "] is wrong");
  }
  plug_in::Work work() const override { return {double(x_.size()), "elements"}; }

 private:
  plug_in::Option<int> blocks_{*this, "blocks", 64, {1, 4096}, "blocks of 16 elements a PE"};
  plug_in::Option<double> a_{*this, "a", 2, {-1000, 1000}, "factor of x"};
  plug_in::MonoBuffer<float> x_{*this, "x", plug_in::Use::upload};
  plug_in::MonoBuffer<float> y_{*this, "y", plug_in::Use::upload_and_download};
};

}  // namespace

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  return std::make_unique<Saxpy>();
}
