#include "firmware/examples/firmwares.hpp"
#include "firmware/examples/stream.hpp"

namespace examples {
namespace {

class StreamFirmware : public plug_in::Firmware {
 public:
  explicit StreamFirmware(const Kernels& kernels)
      : Firmware("stream", "y = factor y + x, again and again, for long arrays"), kernels_(kernels) {}

  void prepare(int num_pes) override {
    const std::size_t size = std::size_t(num_pes) * std::size_t(blocks_) * std::size_t(elements_);
    if (elements_ % 4 != 0)
      throw plug_in::OptionError("elements: found " + std::to_string(elements_) +
                                 ", allowed is a multiple of 4");
    for (plug_in::MonoBuffer<double>* const buffer : {&x_, &y_}) buffer->resize(size);
    for (std::size_t i = 0; i < size; ++i) x_[i] = x_of(i), y_[i] = y_of(i);
  }
  void run(cn::Machine& machine) override {
    Stream stream(machine, kernels_, {x_.mono(), y_.mono(), factor_, steps_, blocks_, elements_});
    threads_ != 0 ? stream.run_with_threads() : stream.run_alone();
  }
  void check() const override {
    for (std::size_t i = 0; i < y_.size(); ++i) {
      double y = y_of(i);
      for (int step = 0; step < steps_; ++step) y = y * factor_ + x_of(i);
      if (y_[i] != y)
        throw plug_in::CheckFailed("y[" + std::to_string(i) + "] is " + std::to_string(y_[i]) +
                                   ", a plain loop gives " + std::to_string(y));
    }
  }
  plug_in::Work work() const override {
    return {2.0 * steps_ * double(y_.size()), "floating-point operations"};
  }

 private:
  static double x_of(std::size_t i) { return double(i * 7 % 1000); }
  static double y_of(std::size_t i) { return x_of(i) + 0.25; }

  const Kernels& kernels_;
  plug_in::Option<double> factor_{*this, "factor", 0.75, {-1, 1}, "of y"};
  plug_in::Option<int> steps_{*this, "steps", 300, {1, 100000}, "times that a block is computed"};
  plug_in::Option<int> blocks_{*this, "blocks", 9, {1, 1000}, "blocks of the arrays"};
  plug_in::Option<int> elements_{
      *this, "elements", 80, {4, 120}, "elements of a PE in a block, a multiple of 4"};
  plug_in::Option<int> threads_{*this, "threads", 1, {0, 1}, "1: a thread for loads and one for saves"};
  plug_in::MonoBuffer<double> x_{*this, "x", plug_in::Use::upload};
  plug_in::MonoBuffer<double> y_{*this, "y", plug_in::Use::upload_and_download};
};

}  // namespace

std::unique_ptr<plug_in::Firmware> make_stream(const Kernels& kernels) {
  return std::make_unique<StreamFirmware>(kernels);
}

}  // namespace examples
