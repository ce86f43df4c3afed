// y = a x + y in single precision: 16 elements a PE and block.

#include "firmware/plug_in/firmware.hpp"

constexpr int kElements = 16;

struct Arguments {
  cn::PolySpan x, y;
  float a;
};

void scale_and_add(const Arguments& arguments) {
  for (int i = 0; i < kElements; ++i) {
    const cn::PolyField<float> x{arguments.x.offset_bytes + i * 4}, y{arguments.y.offset_bytes + i * 4};
    y.write(x.read() * arguments.a + y.read());
  }
}

struct Saxpy : plug_in::Firmware {
  plug_in::Option<int> blocks{*this, "blocks", 64, {1, 4096}, "blocks of 16 elements a PE"};
  plug_in::Option<double> a{*this, "a", 2, {-1000, 1000}, "factor of x"};
  plug_in::MonoBuffer<float> x{*this, "x", plug_in::Use::upload};
  plug_in::MonoBuffer<float> y{*this, "y", plug_in::Use::upload_and_download};
  Saxpy() : Firmware("saxpy", "y = a x + y") {}
  void prepare(int num_pes) override {
    for (auto* buffer : {&x, &y}) buffer->resize(std::size_t(blocks * num_pes * kElements));
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = float(i), y[i] = 1;
  }
  void run(cn::Machine& machine) override {
    const cn::LaneMask all = cn::LaneMask::first(machine.num_pes());
    const auto allocate = [&](const char* name) {
      return machine.poly_memory().allocate(name, kElements * 4);
    };
    const Arguments arguments{allocate("x"), allocate("y"), float(a)};
    const cn::Semaphore copied = machine.allocate_semaphore("copied");
    for (int block = 0; block < blocks; ++block) {
      const auto first = std::size_t(block * machine.num_pes() * kElements);
      machine.async_copy_m2p(copied, arguments.x, x.places(first, kElements), all);
      machine.async_copy_m2p(copied, arguments.y, y.places(first, kElements), all);
      for (int copy = 0; copy < 2; ++copy) machine.sem_wait(copied);
      machine.run(cn::kernel<Arguments, scale_and_add>("scale_and_add"), arguments, all);
      machine.async_copy_p2m(copied, y.places(first, kElements), arguments.y, all);
      machine.sem_wait(copied);
    }
  }
  void check() const override {
    for (std::size_t i = 0; i < y.size(); ++i)
      if (y[i] != float(a) * x[i] + 1) throw plug_in::CheckFailed("y[" + std::to_string(i) + "] is wrong");
  }
  plug_in::Work work() const override { return {double(x.size()), "elements"}; }
};

std::unique_ptr<plug_in::Firmware> plug_in::make_firmware() {
  return std::make_unique<Saxpy>();
}
